// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How far a Newton iteration goes along its direction: no further than to the first
/// inversion or collision, and from there back until the energy does not rise.
/// line_search.hpp says when it counts as not rising.

#include "step/line_search.hpp"
#include "step/newton_state.hpp"
#include "step/trouble.hpp"

namespace noli {

template <class Exec>
class NewtonSearch {
  public:
    NewtonSearch(Exec& exec,
                 const Model& model,
                 const StepSettings& settings,
                 NewtonState<Exec>& state)
        : exec_(exec), model_(model), settings_(settings), state_(state) {
        for (std::size_t t = 0; t < model.tets.size(); ++t)
            stiffness_sum_ += model.volume[t] * (model.mu[t] + model.lambda[t]);
    }

    /// Largest step without inversion and without collision; candidates of that motion.
    void bound_step(View<const Vec3d> x,
                    const InversionLater& inverting,
                    IterationRecord& record,
                    StepReport& report) {
        const View<const Vec3d> p = state_.p.view();
        const InversionBound inversion = inverting.value(exec_);
        record.step_bound = inversion.alpha;
        if (inversion.tet >= 0) record.limiting = describe_tet(model_, inversion.tet);
        {
            const PhaseTimer timer(report.t_pairs);
            state_.collision.find_candidates_seen(
                exec_, x, p, record.step_bound, settings_.dhat);
        }
        const PhaseTimer timer(report.t_ccd);
        const StepBound bound = state_.collision.bound(
            exec_, x, p, record.step_bound, settings_.contact.min_separation);
        if (bound.alpha < record.step_bound) {
            record.step_bound = bound.alpha;
            record.limiting = describe_bound(model_, bound);
        }
    }

    /// Backtracks until the energy does not rise (or boundary motion makes that moot),
    /// then takes the step. False if no step was found in `most_halvings` trials; x then
    /// stays.
    bool search(View<Vec3d> x,
                bool converged,
                double slope,
                int most_halvings,
                IterationRecord& record,
                StepReport& report) {
        const PhaseTimer timer(report.t_search);
        const double h_sq = state_.objective.scales().h_sq;
        LineSearch search{.energy_before = state_.energy,
                          .slope = slope,
                          .rounding = kElasticRounding * h_sq * stiffness_sum_,
                          .may_rise = record.boundary_moved};
        const View<Vec3d> x_trial = state_.x_trial.view();
        double alpha = record.step_bound;
        for (; search.halvings < most_halvings; ++search.halvings, alpha *= 0.5) {
            detail::trial_point(exec_,
                                View<const Vec3d>(x),
                                View<const Vec3d>(state_.p.view()),
                                alpha,
                                x_trial);
            find_pairs_at(x_trial);
            const Later gap = gap_at(x_trial);
            const double energy = state_.objective.energy(
                exec_, x_trial, state_.pairs, state_.law.current());
            if (!search.accepts(energy, alpha)) continue;
            exec_.copy(View<const Vec3d>(x_trial), x);
            if (settings_.has_friction)
                state_.objective.advance_friction(
                    exec_, x, settings_.contact.friction_hessian);
            state_.energy = energy;
            record.energy_after = energy;
            record.step = alpha;
            record.halvings = search.halvings;
            record.noise_accepted = search.noise_accepted;
            finish_iteration(exec_.value(gap), record, report);
            return true;
        }
        record.step = 0.0;
        record.halvings = search.halvings;
        find_pairs_at(x);
        if (converged) finish_iteration(exec_.value(gap_at(x)), record, report);
        return false;
    }

  private:
    /// Elastic energy densities are differences of terms of size mu and lambda, near rest
    /// too: their rounding error is about this share of them.
    static constexpr double kElasticRounding = 2.3e-16;

    void find_pairs_at(View<const Vec3d> x) {
        state_.collision.find_pairs_at(exec_, x, settings_.dhat, state_.pairs);
    }
    [[nodiscard]] Later gap_at(View<const Vec3d> x) {
        return state_.collision.gap_at(exec_, state_.pairs, x);
    }

    /// Contact figures of the accepted state, and a stiffer barrier where a tiny gap
    /// still shrinks.
    void finish_iteration(double gap, IterationRecord& record, StepReport& report) {
        record.contacts = state_.pairs.size();
        record.min_gap = gap;
        report.contacts = record.contacts;
        report.min_gap = gap;
        if (state_.law.stiffen(gap)) state_.energy_known = false;
        report.kappa = state_.law.current().barrier.kappa;
    }

    Exec& exec_;
    const Model& model_;
    const StepSettings& settings_;
    NewtonState<Exec>& state_;
    double stiffness_sum_ = 0.0;  ///< sum of V (mu + lambda), J
};

}  // namespace noli
