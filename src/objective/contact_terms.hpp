// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Barrier and friction of the active pairs: their energies, and the low-rank terms that
/// stand for them in the operator: one after the other those of PP, PE, PT, EE, mollified
/// pairs, walls and, if asked for, friction.

#include "contact/pairs.hpp"
#include "core/timer.hpp"
#include "linear/low_rank.hpp"
#include "model/model.hpp"
#include "objective/device_model.hpp"
#include "objective/friction_forces.hpp"
#include "objective/pair_terms.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace noli {

/// Where filling the terms spends its time, s.
struct ContactSeconds {
    double barrier = 0.0, friction = 0.0;
};

namespace detail {

template <class Exec>
void close_term_ranges(Exec& exec, View<int> first_mode, int num_modes) {
    exec.for_each("objective/close_term_ranges", 1, [=] NOLI_HD(int) {
        first_mode[first_mode.size - 1] = num_modes;
    });
}

/// Modes per pair of each list.
struct PairRanks {
    int pp, pe, four_points, mollified;
    int wall;
    static constexpr int kFriction = 2;

    PairRanks(const ContactLaw& law, int wall_rank)
        : pp(max_rank(PairKind::PointPoint, law.hessian)),
          pe(max_rank(PairKind::PointEdge, law.hessian)),
          four_points(max_rank(PairKind::EdgeEdge, law.hessian)),
          mollified(max_rank(law.mollified)),
          wall(wall_rank) {}

    /// Modes of all pairs, without friction.
    template <class Exec>
    [[nodiscard]] int num_modes(const PairSet<Exec>& pairs) const {
        return pp * pairs.pp.size() + pe * pairs.pe.size()
             + four_points * (pairs.pt.size() + pairs.ee.size())
             + mollified * pairs.mollified.size() + wall * pairs.walls.size();
    }
};

}  // namespace detail

template <class Exec>
class ContactTerms {
  public:
    template <class T>
    using Buffer = typename Exec::template Buffer<T>;

    void upload(Exec& exec, const Model& model) {
        const std::vector<Wall> walls = walls_of(model);
        exec.upload(walls, walls_);
        wall_rank_ = 1;
        for (const Wall& wall : walls)
            wall_rank_ = std::max(wall_rank_, 1 + num_curved_directions(wall.shape));
    }

    /// Starts a step, without friction yet. `eps` = epsv dt, m.
    void begin_step(View<const Vec3d> x_start, double eps) {
        x_start_ = x_start;
        eps_ = eps;
        friction_.resize(0);
        friction_counts_ = {};
    }

    /// Freezes friction at x for the given active pairs.
    void lag_friction_at(Exec& exec,
                         const DeviceModel<Exec>& model,
                         const PairSet<Exec>& pairs,
                         View<const Vec3d> x,
                         BarrierParams params) {
        lag_friction(exec, model, pairs, walls_.view(), x, params, friction_);
        settle_duals(exec, friction_.view(), x, x_start_, eps_);
        friction_counts_ = counts_by_points(pairs);
    }

    /// After a Newton step to x: Hessians of friction as `how` has them.
    void advance_friction(Exec& exec, View<const Vec3d> x, FrictionHessian how) {
        if (how == FrictionHessian::PrimalDual)
            advance_duals(exec, friction_.view(), x, x_start_, eps_);
        else
            settle_duals(exec, friction_.view(), x, x_start_, eps_);
    }

    /// See FrictionOfBodies::sum.
    void sum_friction(Exec& exec, View<const int> body, View<double> out) {
        friction_of_bodies_.sum(exec, friction_.view(), body, out);
    }

    /// Sums of kappa b over the lists of pairs, J.
    std::array<Later, 6> barrier_energy_later(Exec& exec,
                                              View<const Vec3d> x,
                                              const PairSet<Exec>& pairs,
                                              BarrierParams params) {
        const Doubles how = pairs.doubles;
        return {
            pair_energy_sum<2>(
                exec, PairKind::PointPoint, pairs.pp.view(), x, params, how),
            pair_energy_sum<3>(
                exec, PairKind::PointEdge, pairs.pe.view(), x, params, how),
            pair_energy_sum<4>(
                exec, PairKind::PointTriangle, pairs.pt.view(), x, params, how),
            pair_energy_sum<4>(exec, PairKind::EdgeEdge, pairs.ee.view(), x, params, how),
            mollified_energy_sum(exec, pairs.mollified.view(), x, params, how),
            wall_energy_sum(exec, pairs.walls.view(), walls_.view(), x, params)};
    }

    Later friction_energy_later(Exec& exec, View<const Vec3d> x) {
        return friction_energy_sum(exec, friction_.view(), x, x_start_, eps_);
    }

    /// See largest_friction_unrest.
    Later friction_unrest(Exec& exec,
                          View<const Vec3d> x,
                          View<const Vec3d> p,
                          double weak) {
        return largest_friction_unrest(
            exec, friction_.view(), x, x_start_, p, eps_, weak);
    }

    /// Vertices of the term whose friction_unrest is `most`; unused ones -1.
    Int4 vertices_with_unrest(
        Exec& exec, View<const Vec3d> x, View<const Vec3d> p, double weak, double most) {
        const View<const FrictionTerm> terms = friction_.view();
        const int i = first_with_unrest(exec, terms, x, x_start_, p, eps_, weak, most);
        return i < 0 ? Int4{{-1, -1, -1, -1}} : exec.read(terms, i).v;
    }

    /// Gradients and modes at x, of the barrier and, if asked for, of friction.
    void fill_terms(Exec& exec,
                    View<const Vec3d> x,
                    const PairSet<Exec>& pairs,
                    const ContactLaw& law,
                    bool with_friction) {
        const detail::PairRanks ranks(law, wall_rank_);
        const int num_friction = with_friction ? friction_.size() : 0;
        const int num_terms = pairs.size() + num_friction;
        const int num_modes =
            ranks.num_modes(pairs) + detail::PairRanks::kFriction * num_friction;
        terms_.resize(num_terms, num_modes);
        terms_.runs.clear();
        add_runs(counts_by_points(pairs), terms_.runs);
        if (with_friction) add_runs(friction_counts_, terms_.runs);
        gradients_.resize(4 * num_terms);
        TermRange at{terms_.vertices.view(),
                     terms_.first_mode.view(),
                     terms_.modes.view(),
                     gradients_.view()};
        fill_barrier(exec, x, pairs, law, ranks, at);
        at.next(pairs.walls.size(), detail::PairRanks::kFriction);
        if (num_friction > 0) {
            const PhaseTimer timer(seconds_.friction);
            fill_friction_terms(exec, friction_.view(), x, x_start_, eps_, at);
        }
        detail::close_term_ranges(exec, terms_.first_mode.view(), num_modes);
        terms_.build_incidence(exec, x.size);
    }

    /// out += gradients of the terms
    void add_gradients(Exec& exec, View<Vec3d> out) {
        terms_.gather_add(exec, gradients_.view(), out);
    }

    LowRankTerms<Exec>& terms() { return terms_; }
    [[nodiscard]] int num_friction_terms() const { return friction_.size(); }
    [[nodiscard]] View<const FrictionTerm> friction_terms() const {
        return friction_.view();
    }
    /// Seconds of all fillings since the last call.
    ContactSeconds take_seconds() { return std::exchange(seconds_, {}); }

  private:
    /// Leaves `at` at the terms of the walls.
    void fill_barrier(Exec& exec,
                      View<const Vec3d> x,
                      const PairSet<Exec>& pairs,
                      const ContactLaw& law,
                      const detail::PairRanks& ranks,
                      TermRange& at) {
        const PhaseTimer timer(seconds_.barrier);
        const Doubles how = pairs.doubles;
        at.next(0, ranks.pp);
        fill_pair_terms<2>(exec, PairKind::PointPoint, pairs.pp.view(), x, law, at, how);
        at.next(pairs.pp.size(), ranks.pe);
        fill_pair_terms<3>(exec, PairKind::PointEdge, pairs.pe.view(), x, law, at, how);
        at.next(pairs.pe.size(), ranks.four_points);
        fill_pair_terms<4>(
            exec, PairKind::PointTriangle, pairs.pt.view(), x, law, at, how);
        at.next(pairs.pt.size(), ranks.four_points);
        fill_pair_terms<4>(exec, PairKind::EdgeEdge, pairs.ee.view(), x, law, at, how);
        at.next(pairs.ee.size(), ranks.mollified);
        fill_mollified_terms(exec, pairs.mollified.view(), x, law, at, how);
        at.next(pairs.mollified.size(), ranks.wall);
        fill_wall_terms(exec, pairs.walls.view(), walls_.view(), x, law, at);
    }

    /// Pairs on two, three, four points and one, in the order of their terms.
    using PointCounts = std::array<int, 4>;
    static PointCounts counts_by_points(const PairSet<Exec>& pairs) {
        return {pairs.pp.size(),
                pairs.pe.size(),
                pairs.pt.size() + pairs.ee.size() + pairs.mollified.size(),
                pairs.walls.size()};
    }
    static void add_runs(const PointCounts& counts, std::vector<TermRun>& runs) {
        constexpr std::array<int, 4> kPoints{2, 3, 4, 1};
        for (std::size_t k = 0; k < counts.size(); ++k) {
            const int first = runs.empty() ? 0 : runs.back().first + runs.back().count;
            runs.push_back({first, counts[k], kPoints[k]});
        }
    }

    LowRankTerms<Exec> terms_;
    Buffer<Vec3d> gradients_;  ///< 4 per term
    Buffer<Wall> walls_;
    int wall_rank_ = 1;  ///< modes of every wall pair: more than one if a wall curves
    Buffer<FrictionTerm> friction_;
    FrictionOfBodies<Exec> friction_of_bodies_;
    PointCounts friction_counts_{};
    View<const Vec3d> x_start_{};
    double eps_ = 0.0;
    ContactSeconds seconds_;
};

}  // namespace noli
