// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The direction of a Newton iteration: how exactly it is solved for, and what the loop
/// asks of it before it goes along. direction.hpp has the linear system.

#include "step/boundary_pace.hpp"
#include "step/boundary_path.hpp"
#include "step/direction.hpp"
#include "step/newton_state.hpp"
#include "step/retraction.hpp"
#include "step/sound_travel.hpp"
#include "step/touching.hpp"

#include <algorithm>

namespace noli {

/// Of a direction, on their way to the host.
struct DirectionFigures {
    Later gradient, slope, unrest;
    InversionLater inversion;
};

template <class Exec>
class NewtonDirection {
  public:
    NewtonDirection(Exec& exec,
                    const Model& model,
                    const StepSettings& settings,
                    NewtonState<Exec>& state)
        : exec_(exec),
          settings_(settings),
          state_(state),
          solver_(model, settings.dt, settings.solver.linear),
          retraction_(exec, model) {
        straight_.resize(model.num_vertices);
        touched_.resize(model.num_bodies());
        by_warps_ = settings.solver.contact_product == ContactProduct::Warp;
        use_coarse_ = settings.solver.linear != LinearSolver::BlockJacobi;
    }

    void begin_step() { solver_.begin_step(state_.axes); }

    /// Starts to look how far the prescribed vertices are from the end of the leg that
    /// they are on; before arrives.
    void look_ahead(const BoundaryPath& path, View<const Vec3d> x) {
        solver_.look_ahead(exec_, state_.fixed, path, x);
    }

    /// True if the prescribed vertices are at the end of their path; enters the next leg
    /// where they are at the end of one.
    bool arrives(BoundaryPath& path, View<const Vec3d> x) {
        return solver_.find_remaining(exec_, state_.fixed, path, x) == 0.0;
    }

    /// Keeps the prescribed vertices where they are in the next direction.
    void hold_prescribed() { solver_.hold_prescribed(); }

    /// `small` is the size of a direction, m, below which Newton may end; `may_break`
    /// where the Hessian need not be positive definite.
    DirectionResult solve(View<const Vec3d> x,
                          double small,
                          const BoundaryPace& pace,
                          bool may_break,
                          IterationRecord& record,
                          StepReport& report) {
        const PhaseTimer timer(report.t_solve);
        DirectionResult solved =
            solver_.solve(exec_,
                          state_.objective,
                          state_.fixed,
                          settings_.solver,
                          pcg_options(x, small, pace, may_break, record),
                          state_.p);
        is_turned_ = false;
        if (solved.ok && state_.axes.size == 0) {
            exec_.copy(View<const Vec3d>(state_.p.view()), straight_.view());
            find_touched();
            turn_ = retraction_.correct(exec_, turning(), x, 1.0, state_.p.view());
            is_turned_ = true;
        }
        ++report.newton;
        report.pcg += solved.iterations;
        record.pcg = solved.iterations;
        return solved;
    }

    /// All that the direction is asked for, started together. `unrest` tells whether it
    /// is decided which pairs stick, where Newton may end: the tolerance may be far
    /// coarser than the slip epsv dt over which friction builds up. Pairs that can move a
    /// mean vertex by no more than a hundredth of the tolerance have no say.
    DirectionFigures measure(View<const Vec3d> x,
                             bool may_end,
                             double tolerance,
                             IterationRecord& record) {
        Objective<Exec>& objective = state_.objective;
        const View<const Vec3d> p = state_.p.view();
        const Later size = detail::max_component(exec_, p);
        DirectionFigures out;
        if (settings_.record_iterations || settings_.solver.gradient_tolerance > 0.0)
            out.gradient = largest_gradient();
        out.slope = detail::dot_sum(exec_, objective.gradient(), p);
        if (may_end)
            out.unrest = objective.friction_unrest(exec_, x, p, weak_force(tolerance));
        out.inversion = objective.inversion_bound_along(exec_, x, p, kKeepVolume);
        state_.collision.look_along(exec_, x, p);
        record.direction = exec_.value(size);
        if (is_turned_) {
            const double correction = exec_.value(turn_);
            is_turned_ = correction > 0.0;
            turns_far_ = correction > kFarTurn * record.direction;
        }
        record.gradient = exec_.value(out.gradient);
        return out;
    }

    /// Whether the direction has been corrected for turning pieces.
    [[nodiscard]] bool is_turned() const { return is_turned_; }
    /// By so much that a shorter turn is another direction.
    [[nodiscard]] bool turns_far() const { return is_turned_ && turns_far_; }
    /// Takes a share of the direction, turned anew. What was measured is to be measured
    /// again.
    void shorten(View<const Vec3d> x, double share) {
        const View<Vec3d> p = state_.p.view();
        detail::set_zero(exec_, p);
        detail::add_scaled(exec_, share, View<const Vec3d>(straight_.view()), p);
        retraction_.correct(exec_, turning(), x, share, p);
    }
    /// Takes that back. What was measured is to be measured again.
    void straighten() {
        exec_.copy(View<const Vec3d>(straight_.view()), state_.p.view());
        is_turned_ = false;
    }

    /// The vertices of the pair whose friction is as far from settled as `unrest`.
    Int4 least_settled(View<const Vec3d> x, double tolerance, double unrest) {
        return state_.objective.vertices_with_unrest(
            exec_, x, View<const Vec3d>(state_.p.view()), weak_force(tolerance), unrest);
    }

    /// A contact force (kg m, N dt^2) that has no say in where Newton may end: it moves a
    /// mean vertex by a hundredth of the tolerance (m/s).
    [[nodiscard]] double weak_force(double tolerance) const {
        return 0.01 * tolerance * settings_.dt * settings_.mean_mass;
    }

  private:
    /// Bodies with an active pair, or with friction of a pair that was active when
    /// friction was frozen.
    void find_touched() {
        const View<const int> body = state_.objective.device().body.view();
        const View<const FrictionTerm> friction = state_.objective.friction_terms();
        detail::clear_marks(exec_, touched_.view());
        const detail::PairSetReader pairs = state_.collision.reader(state_.pairs);
        if (pairs.size() > 0) detail::mark_bodies(exec_, pairs, body, touched_.view());
        if (friction.size > 0)
            detail::mark_friction(exec_, friction, body, touched_.view());
    }

    [[nodiscard]] RetractionInput turning() const {
        return {state_.objective.inertia(),
                state_.fixed,
                state_.objective.device().body.view(),
                View<const std::uint8_t>(touched_.view())};
    }

    [[nodiscard]] Later largest_gradient() {
        const View<const Vec3d> g = state_.objective.gradient();
        if (state_.axes.size == 0)
            return detail::max_free_component(exec_, g, state_.fixed);
        return detail::max_free_component(exec_, g, state_.fixed, state_.axes);
    }

    /// Far from the solution a rough direction serves as well as an exact one; a
    /// direction that may be the last is found to the fine tolerance before it is
    /// believed.
    PcgOptions pcg_options(View<const Vec3d> x,
                           double small,
                           const BoundaryPace& pace,
                           bool may_break,
                           const IterationRecord& record) {
        const double asked = settings_.solver.pcg_tolerance;
        PcgOptions options{.max_iterations = settings_.solver.max_pcg,
                           .preconditioner = preconditioner(),
                           .contacts_by_warps = by_warps_,
                           .inertia = state_.objective.inertia_diagonal(),
                           .stop = settings_.stop};
        options.may_break = may_break;
        if (use_coarse_) options.positions = x;
        if (asked > 0.0) {
            options.tolerance = pace.tolerance(asked, record.boundary_moved);
            return options;
        }
        options.test = PcgOptions::Test::Energy;
        options.tolerance =
            pace.tolerance(pace.full_step() ? kRoughAfterFullStep : kRoughDirection,
                           record.boundary_moved);
        options.fine_tolerance = std::min(kFineDirection, options.tolerance);
        options.refine = [this, small](View<const Vec3d> p) {
            return exec_.value(detail::max_component(exec_, p)) < small;
        };
        return options;
    }

    [[nodiscard]] PreconditionerKind preconditioner() const {
        switch (settings_.solver.linear) {
            case LinearSolver::BlockJacobi:
                return PreconditionerKind::BlockJacobi;
            case LinearSolver::IncompleteCholesky:
                return PreconditionerKind::IncompleteCholesky;
            default:
                return PreconditionerKind::GaussSeidel;
        }
    }

    Exec& exec_;
    const StepSettings& settings_;
    NewtonState<Exec>& state_;
    DirectionSolver<Exec> solver_;
    static constexpr double kFarTurn = 1e-3;  ///< of the direction
    Retraction<Exec> retraction_;
    typename Exec::template Buffer<Vec3d> straight_;  ///< the direction without it
    typename Exec::template Buffer<std::uint8_t> touched_;
    Later turn_;
    bool is_turned_ = false, turns_far_ = false;
    bool use_coarse_ = false;  ///< rigid modes in the linear solver
    bool by_warps_ = false;    ///< contacts multiplied as in the supplement
};

}  // namespace noli
