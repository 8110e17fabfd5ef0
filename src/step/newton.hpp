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
/// see whether it may be the last (newton_end.hpp), bound the step and search along it
/// (newton_search.hpp), judge what came of it (here).

#include "noli/simulator.hpp"

#include "core/timer.hpp"
#include "step/boundary_pace.hpp"
#include "step/boundary_path.hpp"
#include "step/newton_direction.hpp"
#include "step/newton_end.hpp"
#include "step/newton_search.hpp"
#include "step/newton_state.hpp"
#include "step/projection.hpp"
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
          search_(exec, model, settings, state_),
          end_(exec, model, settings, state_, direction_) {
        exec.upload(model.obstacle, obstacle_);
    }
    /// Its parts point to each other.
    Newton(const Newton&) = delete;
    Newton& operator=(const Newton&) = delete;

    /// Vertices that are prescribed on single axes (single_axes.hpp); before begin_step.
    void set_axes(View<const std::uint8_t> axes) { state_.axes = axes; }

    /// Looks for the pairs at x, where a step starts. begin_step is next.
    void find_first_pairs(View<const Vec3d> x, StepReport& report) {
        const PhaseTimer timer(report.t_pairs);
        Collision<Exec>& collision = state_.collision;
        collision.begin_step(exec_, model_, model_.obstacle);
        collision.find_candidates_along(exec_, x, {}, 0.0, settings_.dhat);
        collision.find_pairs_at(exec_, x, settings_.dhat, state_.pairs);
    }

    /// Prepares a step that starts at x: prediction, kappa and lagged friction.
    void begin_step(const StepScales& scales,
                    View<const std::uint8_t> fixed,
                    View<const Vec3d> x,
                    View<const Vec3d> x_tilde,
                    View<const double> weight) {
        state_.fixed = fixed;
        yielded_ = false;
        direction_.begin_step();
        state_.objective.begin_step(exec_, scales, x, x_tilde, weight, fixed);
        state_.law.begin_step();
        if (state_.law.adapts())
            state_.law.set_kappa(balanced_stiffness(exec_,
                                                    state_.objective,
                                                    x,
                                                    state_.fixed,
                                                    state_.pairs,
                                                    state_.law.current(),
                                                    state_.law.range(),
                                                    state_.p.view(),
                                                    state_.x_trial.view(),
                                                    state_.axes));
        lag_friction_at(x);
    }

    /// The bodies of the present pairs; true if an elastic one was not among them before.
    bool add_touching(Touching<Exec>& touching) {
        const View<const int> body = state_.objective.device().body.view();
        return state_.collision.add_touching(exec_, state_.pairs, body, touching);
    }

    /// Active pairs at x, for contact forces at a state that no step ended in.
    void find_pairs_at(View<const Vec3d> x) {
        state_.collision.find_candidates_along(exec_, x, {}, 0.0, settings_.dhat);
        state_.collision.find_pairs_at(exec_, x, settings_.dhat, state_.pairs);
    }

    void lag_friction_at(View<const Vec3d> x) {
        if (settings_.has_friction)
            state_.objective.lag_friction_at(exec_, state_.pairs, x, law());
    }

    /// The same at the end of a minimisation; returns how much the friction forces of
    /// bodies have changed, relative (friction_change).
    double lag_friction_again_at(View<const Vec3d> x) {
        state_.objective.sum_friction(exec_, friction_before_);
        lag_friction_at(x);
        state_.objective.sum_friction(exec_, friction_after_);
        return friction_change(exec_,
                               View<const double>(friction_before_.view()),
                               View<const double>(friction_after_.view()));
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
        end_.begin();
        projection_.begin(settings_.solver.projection == HessianProjection::Always);
        for (int k = 0; k < settings_.solver.max_newton; ++k) {
            if (is_set(settings_.stop)) return cancelled(report.newton, report);
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

    /// Goes along the displacement `guess` (m) before the first iteration, if nothing
    /// collides or inverts on the way and the energy does not rise. Where prescribed
    /// vertices move it may: they do work.
    void go_ahead(View<const Vec3d> guess,
                  bool boundary_moves,
                  View<Vec3d> x,
                  StepReport& report) {
        const View<Vec3d> p = state_.p.view();
        exec_.copy(guess, p);
        const View<const Vec3d> from = x;
        const View<const Vec3d> along = p;
        const double before = energy_at(from);
        IterationRecord record;
        const InversionLater inversion =
            state_.objective.inversion_bound_along(exec_, from, along, kKeepVolume);
        state_.collision.look_along(exec_, from, along);
        search_.bound_step(from, inversion, record, report);
        const View<Vec3d> trial = state_.x_trial.view();
        if (record.step_bound == 1.0) {
            detail::trial_point(exec_, from, along, 1.0, trial);
            state_.collision.find_pairs_at(exec_, trial, settings_.dhat, state_.pairs);
            const double after = energy_at(trial);
            if (after <= before || (boundary_moves && after < HUGE_VAL)) {
                exec_.copy(View<const Vec3d>(trial), x);
                return;
            }
        }
        state_.collision.find_pairs_at(exec_, from, settings_.dhat, state_.pairs);
    }

    /// Minus the gradient over h^2 at x, where the last minimisation ended, N; 0 before
    /// the first step and where vertices are prescribed.
    void residual_at(View<const Vec3d> x, View<Vec3d> out) {
        detail::set_zero(exec_, out);
        const double h_sq = state_.objective.scales().h_sq;
        if (!(h_sq > 0.0)) return;
        state_.objective.assemble(exec_, x, state_.pairs, law());
        detail::free_residual(
            exec_, state_.fixed, -1.0 / h_sq, state_.objective.gradient(), out);
    }

    Objective<Exec>& objective() { return state_.objective; }
    const Objective<Exec>& objective() const { return state_.objective; }
    Collision<Exec>& collision() { return state_.collision; }
    [[nodiscard]] const PairSet<Exec>& pairs() const { return state_.pairs; }
    [[nodiscard]] const ContactLaw& law() const { return state_.law.current(); }
    /// True if prescribed vertices had to yield in this step.
    [[nodiscard]] bool yielded() const { return yielded_; }
    void set_kappa(double kappa) { state_.law.set_kappa(kappa); }

  private:
    double energy_at(View<const Vec3d> x) {
        return state_.objective.energy(exec_, x, state_.pairs, law());
    }

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
        const bool exact = projection_.exact();
        state_.assemble(exec_, x, !exact, report);
        record.energy = state_.energy;
        record.energy_after = state_.energy;
        record.kappa = law().barrier.kappa;
        const bool arrived = direction_.arrives(path, x);
        record.boundary_moved = !arrived && pace_.moves();
        if (!record.boundary_moved) direction_.hold_prescribed();
        const double small = arrived ? tolerance * settings_.dt : 0.0;
        DirectionResult solved = direction_.solve(x, small, pace_, exact, record, report);
        if (!solved.ok && exact) {
            projection_.broke_down();
            state_.assemble(exec_, x, /*project=*/true, report);
            solved = direction_.solve(x, small, pace_, false, record, report);
        }
        if (solved.cancelled) return {true, cancelled(report.newton - 1, report)};
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
        const bool converged =
            may_end && end_.reached(x, figures, tolerance, record, report);
        report.direction_ratio = record.direction / (tolerance * settings_.dt);
        search_.bound_step(x, figures.inversion, record, report);
        const bool moved = go_along(x, figures, tolerance, converged, record, report);
        projection_.took(record.step, record.boundary_moved);
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

    /// Searches along the direction. Where one that turns pieces does not lower the
    /// energy at once, shorter turns are tried, and then the straight direction; that at
    /// once where a contact stops the turn. False if no step was found.
    bool go_along(View<Vec3d> x,
                  const DirectionFigures& figures,
                  double tolerance,
                  bool converged,
                  IterationRecord& record,
                  StepReport& report) {
        double slope = exec_.value(figures.slope);
        if (direction_.is_turned()) {
            const bool is_stopped = record.step_bound < kStoppedTurn || !(slope < 0.0);
            if (!is_stopped && search_.search(x, false, slope, 1, record, report))
                return true;
            if (!is_stopped && direction_.turns_far())
                for (const double share : {0.25, 0.0625}) {
                    direction_.shorten(x, share);
                    slope = bound_again(x, tolerance, record, report);
                    if (!search_.search(x, false, slope, 1, record, report)) continue;
                    record.step *= share;
                    return true;
                }
            direction_.straighten();
            slope = bound_again(x, tolerance, record, report);
        }
        return search_.search(x, converged, slope, kMaxHalvings, record, report);
    }

    /// Bounds the step along another direction; returns its slope.
    double bound_again(View<const Vec3d> x,
                       double tolerance,
                       IterationRecord& record,
                       StepReport& report) {
        IterationRecord other;
        const DirectionFigures figures = direction_.measure(x, false, tolerance, other);
        record.limiting.clear();
        search_.bound_step(x, figures.inversion, record, report);
        return exec_.value(figures.slope);
    }

    static Outcome cancelled(int done, StepReport& report) {
        report.message =
            "given up on request after " + std::to_string(done) + " Newton iterations";
        return Outcome::Cancelled;
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
    NewtonEnd<Exec> end_;
    StallDetector stall_;
    BoundaryPace pace_;
    ProjectionOnDemand projection_;
    typename Exec::template Buffer<double> friction_before_,
        friction_after_;  ///< per body
    typename Exec::template Buffer<std::uint8_t> obstacle_;
    bool yielded_ = false;
};

}  // namespace noli
