// SPDX-License-Identifier: Apache-2.0
#pragma once
/// When a minimisation has converged: the direction just found is small, it changes no
/// gap by much, and it is decided which pairs stick (docs/theory/stopping.md).

#include "step/line_search.hpp"
#include "step/newton_direction.hpp"
#include "step/newton_state.hpp"
#include "step/trouble.hpp"

#include <algorithm>

namespace noli {

template <class Exec>
class NewtonEnd {
  public:
    NewtonEnd(Exec& exec,
              const Model& model,
              const StepSettings& settings,
              NewtonState<Exec>& state,
              NewtonDirection<Exec>& direction)
        : exec_(exec),
          model_(model),
          settings_(settings),
          state_(state),
          direction_(direction) {}

    void begin() { undecided_ = 0; }

    /// True if the direction at x, which may be the last, is as good as nothing.
    bool reached(View<const Vec3d> x,
                 const DirectionFigures& figures,
                 double tolerance,
                 const IterationRecord& record,
                 StepReport& report) {
        return small_enough(record, tolerance) && gaps_have_settled(x, tolerance, report)
            && friction_is_decided(x, tolerance, exec_.value(figures.unrest), report);
    }

  private:
    /// The stopping test on the direction, or on the gradient if the settings say so.
    /// Source: docs/theory/stopping_and_line_search.md; supplement 9 (gradient).
    [[nodiscard]] bool small_enough(const IterationRecord& record,
                                    double tolerance) const {
        const double bound = settings_.solver.gradient_tolerance;
        if (bound <= 0.0) return record.direction < tolerance * settings_.dt;
        return record.gradient
            <= bound * settings_.diagonal * settings_.dt * settings_.dt;
    }

    /// True if the direction just found changes no gap by more than gap_tolerance, nor
    /// any normal force by more than that share of the largest: normal forces, and
    /// friction with them, depend on the gaps alone. Forces that are all weak have no
    /// say.
    bool gaps_have_settled(View<const Vec3d> x, double tolerance, StepReport& report) {
        const double bound = settings_.solver.gap_tolerance;
        report.gap_change = 0.0;
        if (bound <= 0.0 || state_.pairs.size() == 0) return true;
        const PhaseTimer timer(report.t_ccd);
        const View<Vec3d> moved = state_.x_trial.view();
        detail::trial_point(exec_, x, View<const Vec3d>(state_.p.view()), 1.0, moved);
        const Later gaps =
            state_.collision.gap_change(exec_, state_.pairs, x, View<const Vec3d>(moved));
        const BarrierParams& barrier = state_.law.current().barrier;
        const ForceChangeLater forces = state_.collision.force_change(exec_, barrier);
        const double weak = direction_.weak_force(tolerance) / barrier.kappa;
        report.gap_change = std::max(exec_.value(gaps), forces.value(exec_, weak));
        return report.gap_change <= bound;
    }

    /// True if it is decided which pairs stick, or if that has been all that was missing
    /// for kMostUndecided iterations: two pairs may pass a slip to and fro for ever.
    bool friction_is_decided(View<const Vec3d> x,
                             double tolerance,
                             double unrest,
                             StepReport& report) {
        if (unrest <= kFrictionUnrest) return true;
        if (++undecided_ < kMostUndecided) return false;
        report.message =
            describe_undecided(model_, direction_.least_settled(x, tolerance, unrest));
        return true;
    }

    Exec& exec_;
    const Model& model_;
    const StepSettings& settings_;
    NewtonState<Exec>& state_;
    NewtonDirection<Exec>& direction_;
    int undecided_ = 0;  ///< iterations that lacked nothing but decided friction
};

}  // namespace noli
