// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The direction of a Newton iteration: how exactly it is solved for, and what the loop
/// asks of it before it goes along. direction.hpp has the linear system.

#include "step/boundary_pace.hpp"
#include "step/boundary_path.hpp"
#include "step/direction.hpp"
#include "step/newton_state.hpp"
#include "step/sound_travel.hpp"

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
          solver_(model, settings.solver.linear) {
        by_warps_ = settings.solver.contact_product == ContactProduct::Warp;
        use_coarse_ = wants_coarse_space(model, settings.dt, Exec::kIsDevice)
                   && settings.solver.linear != LinearSolver::BlockJacobi;
    }

    void begin_step() { solver_.begin_step(); }

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

    /// `small` is the size of a direction, m, below which Newton may end.
    DirectionResult solve(View<const Vec3d> x,
                          double small,
                          const BoundaryPace& pace,
                          IterationRecord& record,
                          StepReport& report) {
        const PhaseTimer timer(report.t_solve);
        DirectionResult solved = solver_.solve(exec_,
                                               state_.objective,
                                               state_.fixed,
                                               settings_.solver,
                                               pcg_options(x, small, pace, record),
                                               state_.p);
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
            out.gradient =
                detail::max_free_component(exec_, objective.gradient(), state_.fixed);
        out.slope = detail::dot_sum(exec_, objective.gradient(), p);
        const double weak = 0.01 * tolerance * settings_.dt * settings_.mean_mass;
        if (may_end) out.unrest = objective.friction_unrest(exec_, x, p, weak);
        out.inversion = objective.inversion_bound_along(exec_, x, p, kKeepVolume);
        state_.collision.look_along(exec_, x, p);
        record.direction = exec_.value(size);
        record.gradient = exec_.value(out.gradient);
        return out;
    }

  private:
    /// Far from the solution a rough direction serves as well as an exact one; a
    /// direction that may be the last is found to the fine tolerance before it is
    /// believed.
    PcgOptions pcg_options(View<const Vec3d> x,
                           double small,
                           const BoundaryPace& pace,
                           const IterationRecord& record) {
        const double asked = settings_.solver.pcg_tolerance;
        PcgOptions options{.max_iterations = settings_.solver.max_pcg,
                           .preconditioner = preconditioner(),
                           .contacts_by_warps = by_warps_,
                           .inertia = state_.objective.inertia_diagonal()};
        if (use_coarse_) options.positions = x;
        if (asked > 0.0) {
            options.tolerance = pace.tolerance(asked, record.boundary_moved);
            return options;
        }
        options.test = PcgOptions::Test::Energy;
        options.tolerance = pace.tolerance(kRoughDirection, record.boundary_moved);
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
    bool use_coarse_ = false;  ///< rigid modes in the linear solver
    bool by_warps_ = false;    ///< contacts multiplied as in the supplement
};

}  // namespace noli
