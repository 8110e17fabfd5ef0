// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Every loop of a Newton iteration, run once on one executor from given positions, and
/// all that came out of it: what is compared between executors.

#include "linear/dense_terms.hpp"
#include "linear/device_pcg.hpp"
#include "objective/objective.hpp"
#include "step/boundary_upload.hpp"
#include "step/collision.hpp"
#include "step/direction.hpp"
#include "step/integrator.hpp"

#include <string>
#include <type_traits>
#include <vector>

namespace noli::test {

/// What a group of loops left behind, as plain numbers.
struct LoopResult {
    std::string name;
    std::vector<double> values;
    bool is_exact = false;  ///< indices and counts: no rounding anywhere
    bool repeats = true;    ///< the same bits whenever it runs on one device
};

/// Where the loops start.
struct LoopInput {
    const Model& model;
    const BlockPattern& pattern;
    double h_sq, dhat, kappa, friction_eps;
    std::vector<Vec3d> x_start, x, x_tilde, p;
    std::vector<std::uint8_t> fixed;
};

/// Appends the numbers of one item.
inline void flatten(double v, std::vector<double>& out) {
    out.push_back(v);
}
inline void flatten(const Vec3d& v, std::vector<double>& out) {
    out.insert(out.end(), {v.x, v.y, v.z});
}
inline void flatten(const Mat3d& m, std::vector<double>& out) {
    out.insert(out.end(), m.a, m.a + 9);
}
inline void flatten(const Mode& m, std::vector<double>& out) {
    for (const Vec3d& q : m.q)
        flatten(q, out);
}
template <class Ids>
requires requires(const Ids& ids) {
    ids.v[0];
}
void flatten(const Ids& ids, std::vector<double>& out) {
    for (const int v : ids.v)
        out.push_back(v);
}
inline void flatten(const MollifiedPair& pair, std::vector<double>& out) {
    flatten(pair.v, out);
    out.push_back(static_cast<double>(pair.kind));
    for (const auto local : pair.local)
        out.push_back(local);
}

template <class Exec>
class LoopRun {
  public:
    template <class T>
    using Buffer = typename Exec::template Buffer<T>;

    LoopRun(Exec& exec, const LoopInput& in)
        : exec_(exec), in_(in), objective_(exec, in.model, in.pattern) {
        exec.upload(in.x_start, x_start_);
        exec.upload(in.x, x_);
        exec.upload(in.x_tilde, x_tilde_);
        exec.upload(std::vector<double>(in.x_tilde.size(), 2.25), weight_);
        exec.upload(in.p, p_);
        exec.upload(in.fixed, fixed_);
        law_ = {.barrier = {.dhat = in.dhat,
                            .kappa = in.kappa,
                            .exponent = 2,
                            .curvature_cap = 0.0},
                .hessian = ContactHessian::GaussNewtonPlus,
                .mollified = MollifiedHessian::Exact};
    }

    std::vector<LoopResult> run() {
        contact();
        for (const ContactHessian hessian : {ContactHessian::GaussNewton,
                                             ContactHessian::GaussNewtonPlus,
                                             ContactHessian::Exact,
                                             ContactHessian::Numeric}) {
            law_.hessian = hessian;
            assembly("hessian " + std::to_string(static_cast<int>(hessian)));
        }
        law_.hessian = ContactHessian::GaussNewtonPlus;
        assembly("last");
        products();
        bounds();
        linear_solves();
        single_axes();
        return std::move(out_);
    }

  private:
    template <class T>
    void keep(const std::string& name, View<const T> from, bool is_exact = false) {
        std::vector<T> host;
        exec_.download(from, host);
        LoopResult result{name, {}, is_exact};
        for (const T& item : host)
            flatten(item, result.values);
        out_.push_back(std::move(result));
    }
    void keep(const std::string& name,
              std::vector<double> values,
              bool is_exact = false) {
        out_.push_back({name, std::move(values), is_exact});
    }
    [[nodiscard]] View<const Vec3d> x() const { return x_.view(); }
    [[nodiscard]] View<const Vec3d> p() const { return p_.view(); }

    void contact() {
        collision_.begin_step(exec_, in_.model, in_.model.obstacle);
        collision_.find_candidates_along(exec_, x(), {}, 0.0, in_.dhat);
        collision_.find_pairs_at(exec_, x(), in_.dhat, pairs_);
        keep("pairs PP", View<const Int2>(pairs_.pp.view()), true);
        keep("pairs PE", View<const Int3>(pairs_.pe.view()), true);
        keep("pairs PT", View<const Int4>(pairs_.pt.view()), true);
        keep("pairs EE", View<const Int4>(pairs_.ee.view()), true);
        keep("pairs mollified", View<const MollifiedPair>(pairs_.mollified.view()), true);
        keep("pairs wall", View<const Int2>(pairs_.walls.view()), true);
        keep("smallest gap", {exec_.value(collision_.gap_at(exec_, pairs_, x()))});
        objective_.begin_step(exec_,
                              {.h_sq = in_.h_sq,
                               .mass_damping = 0.1 * in_.h_sq,
                               .stiffness_damping = 0.01,
                               .friction_eps = in_.friction_eps},
                              x_start_.view(),
                              x_tilde_.view(),
                              weight_.view(),
                              fixed_.view());
        objective_.lag_friction_at(exec_, pairs_, x_start_.view(), law_);
    }

    void assembly(const std::string& name) {
        objective_.assemble(exec_, x(), pairs_, law_);
        keep(name + " gradient", objective_.gradient());
        keep(name + " blocks", objective_.matrix().values());
        // Of a mode, the sign and its order among others of its term are a matter of
        // rounding: what counts is what the modes add up to.
        Buffer<Mat3d> diagonal;
        Buffer<Vec3d> product;
        diagonal.resize(x_.size());
        product.resize(x_.size());
        objective_.matrix().diagonal_blocks(exec_, diagonal.view());
        objective_.terms().add_diagonal(exec_, diagonal.view());
        keep(name + " diagonal", View<const Mat3d>(diagonal.view()));
        detail::set_zero(exec_, product.view());
        objective_.terms().multiply_add(exec_, p(), product.view());
        keep(name + " contact product", View<const Vec3d>(product.view()));
        keep(name + " energy", {objective_.energy(exec_, x(), pairs_, law_)});
    }

    void products() {
        Buffer<Vec3d> y;
        y.resize(x_.size());
        objective_.matrix().multiply(exec_, p(), y.view());
        keep("block product", View<const Vec3d>(y.view()));
        keep("quadratic forms",
             {objective_.matrix().quadratic_form(exec_, p()),
              objective_.terms().quadratic_form(exec_, p())});
        DenseTerms<Exec> dense;
        dense.build(exec_, objective_.terms());
        detail::set_zero(exec_, y.view());
        dense.multiply_add(exec_, p(), y.view());
        keep("contact product by warps", View<const Vec3d>(y.view()));
        out_.back().repeats = false;
        objective_.contact_forces(exec_, x(), pairs_, law_, y.view());
        keep("contact forces", View<const Vec3d>(y.view()));
        objective_.elastic_gradient_at(exec_, x(), y.view());
        keep("elastic gradient", View<const Vec3d>(y.view()));
        keep("friction unrest",
             {exec_.value(objective_.friction_unrest(exec_, x(), p(), 0.0))});
    }

    void bounds() {
        const InversionBound inversion =
            objective_.inversion_bound_along(exec_, x(), p(), 0.2).value(exec_);
        keep("inversion bound", {inversion.alpha});
        collision_.find_candidates_along(exec_, x(), p(), 1.0, in_.dhat);
        const StepBound bound = collision_.bound(exec_, x(), p(), 1.0, 0.0);
        keep("step bound", {bound.alpha});
        PairSet<Exec> pairs;
        collision_.find_pairs_at(exec_, x(), in_.dhat, pairs);
        keep("pairs among swept candidates", {double(pairs.size())}, true);
    }

    void linear_solves() {
        Buffer<Vec3d> rhs, solution;
        rhs.resize(x_.size());
        solution.resize(x_.size());
        detail::set_zero(exec_, solution.view());
        detail::right_hand_side(exec_,
                                View<const std::uint8_t>(fixed_.view()),
                                objective_.gradient(),
                                View<const Vec3d>(solution.view()),
                                rhs.view());
        const std::vector<int> order = morton_order(in_.model.x0);
        for (const bool coarse : {false, true})
            for (const PreconditionerKind kind :
                 {PreconditionerKind::BlockJacobi, PreconditionerKind::Schwarz}) {
                DevicePcg<Exec> pcg;
                pcg.set_order(order);
                pcg.set_aggregates(cut_aggregates(in_.model.tets, order, 8), 16);
                PcgOptions options;
                options.preconditioner = kind;
                options.tolerance = 1e-20;
                if (coarse) options.positions = x();
                const PcgResult solved = pcg.solve(exec_,
                                                   objective_.matrix(),
                                                   objective_.terms(),
                                                   View<const Vec3d>(rhs.view()),
                                                   fixed_.view(),
                                                   options,
                                                   solution.view());
                keep("solved",
                     {double(solved.outcome == PcgResult::Outcome::Converged)},
                     true);
                keep("solution", View<const Vec3d>(solution.view()));
            }
    }

    /// Last: it changes the operator.
    void single_axes() {
        std::vector<std::uint8_t> masks(in_.x.size());
        for (std::size_t v = 0; v < masks.size(); ++v)
            masks[v] = in_.fixed[v] != 0 ? 0 : static_cast<std::uint8_t>(v % 7);
        Buffer<std::uint8_t> axes;
        exec_.upload(masks, axes);
        const View<const std::uint8_t> held = axes.view();
        Buffer<Vec3d> a, b;
        exec_.upload(in_.x, a);
        exec_.upload(in_.p, b);
        detail::remaining_on_axes(exec_, held, x(), p(), a.view());
        keep("remaining on axes", View<const Vec3d>(a.view()));
        detail::copy_axes(exec_, held, x(), a.view());
        detail::advance_axes(exec_, 0.1, held, p(), x(), a.view(), b.view());
        keep("velocity on axes", View<const Vec3d>(a.view()));
        keep("acceleration on axes", View<const Vec3d>(b.view()));
        detail::zero_axes(exec_, held, a.view());
        keep("free part", View<const Vec3d>(a.view()));
        keep("largest free component",
             {exec_.value(detail::max_free_component(
                 exec_, x(), View<const std::uint8_t>(fixed_.view()), held))});
        detail::decouple_axes(exec_, held, objective_.matrix(), objective_.terms());
        keep("decoupled blocks", objective_.matrix().values());
        detail::set_zero(exec_, a.view());
        objective_.terms().multiply_add(exec_, p(), a.view());
        keep("projected contact product", View<const Vec3d>(a.view()));
    }

    Exec& exec_;
    const LoopInput& in_;
    Objective<Exec> objective_;
    Collision<Exec> collision_;
    PairSet<Exec> pairs_;
    ContactLaw law_{};
    Buffer<Vec3d> x_start_, x_, x_tilde_, p_;
    Buffer<std::uint8_t> fixed_;
    Buffer<double> weight_;
    std::vector<LoopResult> out_;
};

template <class Exec>
std::vector<LoopResult> run_loops(const LoopInput& in) {
    Exec exec;
    return LoopRun<Exec>(exec, in).run();
}

}  // namespace noli::test
