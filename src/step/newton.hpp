// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The Newton loop of one time step. Source: MATH 8, with these differences:
///   * the stopping test looks at the direction just found, not at the one before, and
///     that direction is still applied;
///   * prescribed vertices take part in the direction (see direction.hpp), so in
///     iterations in which they still move the energy may rise; in all others it must
///     not;
///   * contact candidates are found once per iteration, for the whole swept motion, and
///     serve the step bound and all line-search trials.
///
/// An iteration: assemble (newton_state.hpp), find the direction (newton_direction.hpp),
/// bound the step and search along it (newton_search.hpp), judge what came of it (here).

#include "noli/simulator.hpp"

#include "core/timer.hpp"
#include "step/boundary_pace.hpp"
#include "step/boundary_path.hpp"
#include "step/newton_direction.hpp"
#include "step/newton_search.hpp"
#include "step/newton_state.hpp"
#include "step/stiffness.hpp"
#include "step/trouble.hpp"

namespace noli {

template <class Exec>
class Newton {
  public:
    Newton(Exec& exec,
           const Model& model,
           const BlockPattern& pattern,
           const StepSettings& settings)
        : exec_(exec),
          model_(model),
          settings_(settings),
          state_(exec, model, pattern, settings),
          direction_(exec, model, settings, state_),
          search_(exec, model, settings, state_) {
        exec.upload(model.obstacle, obstacle_);
    }
    /// Its parts point to each other.
    Newton(const Newton&) = delete;
    Newton& operator=(const Newton&) = delete;

    /// Prepares a step that starts at x: contact surface, pairs, kappa and lagged
    /// friction.
    void begin_step(const StepScales& scales,
                    View<const std::uint8_t> fixed,
                    View<const Vec3d> x,
                    View<const Vec3d> x_tilde,
                    StepReport& report) {
        state_.fixed = fixed;
        yielded_ = false;
        direction_.begin_step();
        state_.objective.begin_step(exec_, scales, x, x_tilde, fixed);
        state_.law.begin_step();
        {
            const PhaseTimer timer(report.t_pairs);
            Collision<Exec>& collision = state_.collision;
            collision.begin_step(exec_, model_, model_.obstacle);
            collision.find_candidates_along(exec_, x, {}, 0.0, settings_.dhat);
            collision.find_pairs_at(exec_, x, settings_.dhat, state_.pairs);
        }
        if (state_.law.adapts())
            state_.law.set_kappa(balanced_stiffness(exec_,
                                                    state_.objective,
                                                    x,
                                                    state_.fixed,
                                                    state_.pairs,
                                                    state_.law.current(),
                                                    state_.law.range(),
                                                    state_.p.view(),
                                                    state_.x_trial.view()));
        lag_friction_at(x);
    }

    void lag_friction_at(View<const Vec3d> x) {
        if (settings_.has_friction)
            state_.objective.lag_friction_at(exec_, state_.pairs, x, law());
    }

    /// Minimises the incremental potential from x, with prescribed vertices going along
    /// `path`. Fills the report; leaves in x the last iterate, always free of
    /// intersections.
    Outcome minimize(BoundaryPath& path,
                     double tolerance,
                     View<Vec3d> x,
                     StepReport& report) {
        stall_ = {};
        pace_ = {};
        state_.energy_known = false;
        for (int k = 0; k < settings_.solver.max_newton; ++k) {
            IterationRecord record;
            record.iteration = report.newton;
            const Progress progress = iterate(path, tolerance, x, record, report);
            if (settings_.record_iterations) report.iterations.push_back(record);
            if (progress.ended) return progress.outcome;
        }
        report.message = "no convergence in "
                       + std::to_string(settings_.solver.max_newton)
                       + " iterations (solver.max_newton); " + stall_.describe();
        return Outcome::MaxIterations;
    }

    Objective<Exec>& objective() { return state_.objective; }
    Collision<Exec>& collision() { return state_.collision; }
    [[nodiscard]] const PairSet<Exec>& pairs() const { return state_.pairs; }
    [[nodiscard]] const ContactLaw& law() const { return state_.law.current(); }
    /// True if prescribed vertices had to yield in this step.
    [[nodiscard]] bool yielded() const { return yielded_; }
    void set_kappa(double kappa) { state_.law.set_kappa(kappa); }

  private:
    struct Progress {
        bool ended = false;
        Outcome outcome = Outcome::Converged;
    };

    Progress iterate(BoundaryPath& path,
                     double tolerance,
                     View<Vec3d> x,
                     IterationRecord& record,
                     StepReport& report) {
        direction_.look_ahead(path, x);
        state_.assemble(exec_, x, report);
        record.energy = state_.energy;
        record.energy_after = state_.energy;
        record.kappa = law().barrier.kappa;
        const bool arrived = direction_.arrives(path, x);
        record.boundary_moved = !arrived && pace_.moves();
        if (!record.boundary_moved) direction_.hold_prescribed();
        const double small = arrived ? tolerance * settings_.dt : 0.0;
        const DirectionResult solved = direction_.solve(x, small, pace_, record, report);
        if (!solved.ok) {
            report.message = solved.trouble;
            return {true, Outcome::LinearSolverFailed};
        }
        const bool may_end =
            arrived && (solved.fine || settings_.solver.gradient_tolerance > 0.0);
        const DirectionFigures figures = [&] {
            const PhaseTimer timer(report.t_ccd);
            return direction_.measure(x, may_end, tolerance, record);
        }();
        if (!(record.direction < HUGE_VAL) || !(state_.energy < HUGE_VAL)) {
            report.message =
                describe_not_finite(record.direction, state_.energy, report.newton);
            return {true, Outcome::NumericalTrouble};
        }
        const bool converged = may_end && small_enough(record, tolerance)
                            && exec_.value(figures.unrest) <= kFrictionUnrest;
        search_.bound_step(x, figures.inversion, record, report);
        const bool moved =
            search_.search(x, converged, exec_.value(figures.slope), record, report);
        if (converged) return {true, Outcome::Converged};
        if (!moved && pace_.retry_more_exactly()) return {};
        if (!moved) {
            report.message = describe_failed_search(record);
            return {true, Outcome::Stalled};
        }
        const Progress progress = judge_progress(record, report);
        if (!progress.ended && pace_.blocked() && !yielded_) yield_boundary(path.end());
        return progress;
    }

    /// The stopping test on the direction, or on the gradient if the settings say so.
    /// Source: MATH 8 (direction); supplement 9 (gradient).
    [[nodiscard]] bool small_enough(const IterationRecord& record,
                                    double tolerance) const {
        const double bound = settings_.solver.gradient_tolerance;
        if (bound <= 0.0) return record.direction < tolerance * settings_.dt;
        return record.gradient
            <= bound * settings_.diagonal * settings_.dt * settings_.dt;
    }

    /// Prescribed vertices of elastic bodies that something blocks are held by springs
    /// from here on (docs/decisions/001-boundary-by-elimination.md); those of obstacles
    /// are not.
    void yield_boundary(View<const Vec3d> target) {
        const View<const std::uint8_t> obstacle = obstacle_.view();
        state_.objective.yield(exec_, state_.fixed, obstacle, target);
        state_.fixed = obstacle;
        yielded_ = true;
        state_.energy_known = false;
        stall_ = {};
        pace_ = {};
    }

    /// Counts short steps; moves to a stronger contact Hessian, or gives up with the
    /// cause.
    Progress judge_progress(const IterationRecord& record, StepReport& report) {
        stall_.add(record);
        pace_.add(record);
        if (stall_.short_steps == kShortStepsBeforeSwitch && state_.law.strengthen()) {
            stall_.short_steps = 0;
            report.message =
                "contact Hessian strengthened after short steps at " + record.limiting;
        }
        if (stall_.short_steps < kShortStepsBeforeStall) return {};
        report.message = stall_.describe();
        return {true,
                record.boundary_moved ? Outcome::BoundaryBlocked : Outcome::Stalled};
    }

    Exec& exec_;
    const Model& model_;
    const StepSettings& settings_;
    NewtonState<Exec> state_;
    NewtonDirection<Exec> direction_;
    NewtonSearch<Exec> search_;
    StallDetector stall_;
    BoundaryPace pace_;
    typename Exec::template Buffer<std::uint8_t> obstacle_;
    bool yielded_ = false;
};

}  // namespace noli
