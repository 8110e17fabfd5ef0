// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The Newton loop of one time step. Source: MATH 8, with these differences:
///   * the stopping test looks at the direction just found, not at the one before, and
///   that
///     direction is still applied;
///   * prescribed vertices take part in the direction (see direction.hpp), so in
///   iterations in
///     which they still move the energy may rise; in all others it must not;
///   * contact candidates are found once per iteration, for the whole swept motion, and
///   serve the
///     step bound and all line-search trials.

#include "noli/simulator.hpp"

#include "core/timer.hpp"
#include "step/adaptive_law.hpp"
#include "step/boundary_pace.hpp"
#include "step/boundary_path.hpp"
#include "step/collision.hpp"
#include "step/direction.hpp"
#include "step/line_search.hpp"
#include "step/sound_travel.hpp"
#include "step/stiffness.hpp"
#include "step/trouble.hpp"

namespace noli {

template <class Exec>
class Newton {
  public:
    template <class T>
    using Buffer = typename Exec::template Buffer<T>;

    Newton(Exec& exec,
           const Model& model,
           const BlockPattern& pattern,
           const StepSettings& settings)
        : exec_(exec),
          model_(model),
          settings_(settings),
          objective_(exec, model, pattern),
          direction_(model, settings.solver.linear),
          law_(settings) {
        exec.upload(model.obstacle, obstacle_);
        p_.resize(model.num_vertices);
        x_trial_.resize(model.num_vertices);
        by_warps_ = settings.solver.contact_product == ContactProduct::Warp;
        use_coarse_ = wants_coarse_space(model, settings.dt, Exec::kIsDevice)
                   && settings.solver.linear != LinearSolver::BlockJacobi;
        for (std::size_t t = 0; t < model.tets.size(); ++t)
            stiffness_sum_ += model.volume[t] * (model.mu[t] + model.lambda[t]);
    }

    /// Prepares a step that starts at x: contact surface, pairs, kappa and lagged
    /// friction.
    void begin_step(const StepScales& scales,
                    View<const std::uint8_t> fixed,
                    View<const Vec3d> x,
                    View<const Vec3d> x_tilde,
                    StepReport& report) {
        fixed_ = fixed;
        yielded_ = false;
        direction_.begin_step();
        objective_.begin_step(exec_, scales, x, x_tilde, fixed);
        law_.begin_step();
        {
            const PhaseTimer timer(report.t_pairs);
            collision_.begin_step(exec_, model_, model_.obstacle);
            collision_.find_candidates_along(exec_, x, {}, 0.0, settings_.dhat);
            collision_.find_pairs_at(exec_, x, settings_.dhat, pairs_);
        }
        if (law_.adapts())
            law_.set_kappa(balanced_stiffness(exec_,
                                              objective_,
                                              x,
                                              fixed_,
                                              pairs_,
                                              law_.current(),
                                              law_.range(),
                                              p_.view(),
                                              x_trial_.view()));
        lag_friction_at(x);
    }

    void lag_friction_at(View<const Vec3d> x) {
        if (settings_.has_friction) objective_.lag_friction_at(exec_, pairs_, x, law());
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
        energy_known_ = false;
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

    Objective<Exec>& objective() { return objective_; }
    Collision<Exec>& collision() { return collision_; }
    [[nodiscard]] const PairSet<Exec>& pairs() const { return pairs_; }
    [[nodiscard]] const ContactLaw& law() const { return law_.current(); }
    /// True if prescribed vertices had to yield in this step.
    [[nodiscard]] bool yielded() const { return yielded_; }
    void set_kappa(double kappa) { law_.set_kappa(kappa); }

  private:
    /// Elastic energy densities are differences of terms of size mu and lambda, near rest
    /// too: their rounding error is about this share of them.
    static constexpr double kElasticRounding = 2.3e-16;

    /// Of a direction, on their way to the host.
    struct DirectionFigures {
        Later gradient, slope, unrest;
        InversionLater inversion;
    };

    struct Progress {
        bool ended = false;
        Outcome outcome = Outcome::Converged;
    };

    Progress iterate(BoundaryPath& path,
                     double tolerance,
                     View<Vec3d> x,
                     IterationRecord& record,
                     StepReport& report) {
        direction_.look_ahead(exec_, fixed_, path, x);
        assemble(x, report);
        record.energy = energy_;
        record.energy_after = energy_;
        record.kappa = law().barrier.kappa;
        const bool arrived = direction_.find_remaining(exec_, fixed_, path, x) == 0.0;
        record.boundary_moved = !arrived && pace_.moves();
        if (!record.boundary_moved) direction_.hold_prescribed();
        const DirectionResult solved =
            solve_direction(x, arrived ? tolerance * settings_.dt : 0.0, record, report);
        if (!solved.ok) {
            report.message = solved.trouble;
            return {true, Outcome::LinearSolverFailed};
        }
        const bool may_end =
            arrived && (solved.fine || settings_.solver.gradient_tolerance > 0.0);
        const DirectionFigures figures = [&] {
            const PhaseTimer timer(report.t_ccd);
            return measure_direction(x, may_end, tolerance, record);
        }();
        if (!(record.direction < HUGE_VAL) || !(energy_ < HUGE_VAL)) {
            report.message =
                describe_not_finite(record.direction, energy_, report.newton);
            return {true, Outcome::NumericalTrouble};
        }
        const bool converged = may_end && small_enough(record, tolerance)
                            && exec_.value(figures.unrest) <= kFrictionUnrest;
        bound_step(x, figures.inversion, record, report);
        const bool moved =
            search(x, converged, exec_.value(figures.slope), record, report);
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

    /// Gradient, operator and, where it is not known yet, the energy.
    void assemble(View<const Vec3d> x, StepReport& report) {
        const PhaseTimer timer(report.t_assemble);
        EnergyParts parts;
        if (!energy_known_) parts = objective_.energy_later(exec_, x, pairs_, law());
        objective_.assemble(exec_, x, pairs_, law());
        if (!energy_known_) energy_ = objective_.total(exec_, parts);
        energy_known_ = true;
        const AssemblySeconds seconds = objective_.take_seconds();
        report.t_elastic += seconds.elastic;
        report.t_barrier += seconds.barrier;
        report.t_friction += seconds.friction;
    }

    /// All that the direction is asked for, started together. `unrest` tells whether it
    /// is decided which pairs stick, where Newton may end: the tolerance may be far
    /// coarser than the slip epsv dt over which friction builds up. Pairs that can move a
    /// mean vertex by no more than a hundredth of the tolerance have no say.
    DirectionFigures measure_direction(View<const Vec3d> x,
                                       bool may_end,
                                       double tolerance,
                                       IterationRecord& record) {
        const View<const Vec3d> p = p_.view();
        const Later size = detail::max_component(exec_, p);
        DirectionFigures out;
        if (settings_.record_iterations || settings_.solver.gradient_tolerance > 0.0)
            out.gradient =
                detail::max_free_component(exec_, objective_.gradient(), fixed_);
        out.slope = detail::dot_sum(exec_, objective_.gradient(), p);
        const double weak = 0.01 * tolerance * settings_.dt * settings_.mean_mass;
        if (may_end) out.unrest = objective_.friction_unrest(exec_, x, p, weak);
        out.inversion = objective_.inversion_bound_along(exec_, x, p, kKeepVolume);
        collision_.look_along(exec_, x, p);
        record.direction = exec_.value(size);
        record.gradient = exec_.value(out.gradient);
        return out;
    }

    /// Prescribed vertices of elastic bodies that something blocks are held by springs
    /// from here on (docs/decisions/001-boundary-by-elimination.md); those of obstacles
    /// are not.
    void yield_boundary(View<const Vec3d> target) {
        const View<const std::uint8_t> obstacle = obstacle_.view();
        objective_.yield(exec_, fixed_, obstacle, target);
        fixed_ = obstacle;
        yielded_ = true;
        energy_known_ = false;
        stall_ = {};
        pace_ = {};
    }

    /// `small` is the size of a direction, m, below which Newton may end.
    DirectionResult solve_direction(View<const Vec3d> x,
                                    double small,
                                    IterationRecord& record,
                                    StepReport& report) {
        const PhaseTimer timer(report.t_solve);
        DirectionResult solved = direction_.solve(exec_,
                                                  objective_,
                                                  fixed_,
                                                  settings_.solver,
                                                  pcg_options(x, small, record),
                                                  p_);
        ++report.newton;
        report.pcg += solved.iterations;
        record.pcg = solved.iterations;
        return solved;
    }

    /// Far from the solution a rough direction serves as well as an exact one; a
    /// direction that may be the last is found to the fine tolerance before it is
    /// believed.
    PcgOptions pcg_options(View<const Vec3d> x,
                           double small,
                           const IterationRecord& record) {
        const double asked = settings_.solver.pcg_tolerance;
        PcgOptions options{.max_iterations = settings_.solver.max_pcg,
                           .preconditioner = preconditioner(),
                           .contacts_by_warps = by_warps_,
                           .inertia = objective_.inertia_diagonal()};
        if (use_coarse_) options.positions = x;
        if (asked > 0.0) {
            options.tolerance = pace_.tolerance(asked, record.boundary_moved);
            return options;
        }
        options.test = PcgOptions::Test::Energy;
        options.tolerance = pace_.tolerance(kRoughDirection, record.boundary_moved);
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

    /// Largest step without inversion and without collision; candidates of that motion.
    void bound_step(View<const Vec3d> x,
                    const InversionLater& inverting,
                    IterationRecord& record,
                    StepReport& report) {
        const View<const Vec3d> p = p_.view();
        const InversionBound inversion = inverting.value(exec_);
        record.step_bound = inversion.alpha;
        if (inversion.tet >= 0) record.limiting = describe_tet(model_, inversion.tet);
        {
            const PhaseTimer timer(report.t_pairs);
            collision_.find_candidates_seen(
                exec_, x, p, record.step_bound, settings_.dhat);
        }
        const PhaseTimer timer(report.t_ccd);
        const StepBound bound = collision_.bound(
            exec_, x, p, record.step_bound, settings_.contact.min_separation);
        if (bound.alpha < record.step_bound) {
            record.step_bound = bound.alpha;
            record.limiting = describe_bound(model_, bound);
        }
    }

    /// Backtracks until the energy does not rise (or boundary motion makes that moot),
    /// then takes the step. False if no step was found; x then stays.
    bool search(View<Vec3d> x,
                bool converged,
                double slope,
                IterationRecord& record,
                StepReport& report) {
        const PhaseTimer timer(report.t_search);
        LineSearch search{
            .energy_before = energy_,
            .slope = slope,
            .rounding = kElasticRounding * objective_.scales().h_sq * stiffness_sum_,
            .may_rise = record.boundary_moved};
        double alpha = record.step_bound;
        for (; search.halvings < kMaxHalvings; ++search.halvings, alpha *= 0.5) {
            detail::trial_point(exec_,
                                View<const Vec3d>(x),
                                View<const Vec3d>(p_.view()),
                                alpha,
                                x_trial_.view());
            collision_.find_pairs_at(exec_, x_trial_.view(), settings_.dhat, pairs_);
            const Later gap = collision_.gap_at(exec_, pairs_, x_trial_.view());
            const double energy =
                objective_.energy(exec_, x_trial_.view(), pairs_, law());
            if (!search.accepts(energy, alpha)) continue;
            exec_.copy(View<const Vec3d>(x_trial_.view()), x);
            energy_ = energy;
            record.energy_after = energy;
            record.step = alpha;
            record.halvings = search.halvings;
            record.noise_accepted = search.noise_accepted;
            finish_iteration(exec_.value(gap), record, report);
            return true;
        }
        record.step = 0.0;
        record.halvings = search.halvings;
        collision_.find_pairs_at(exec_, View<const Vec3d>(x), settings_.dhat, pairs_);
        if (converged)
            finish_iteration(
                exec_.value(collision_.gap_at(exec_, pairs_, x)), record, report);
        return false;
    }

    /// Contact figures of the accepted state, and a stiffer barrier where a tiny gap
    /// still shrinks.
    void finish_iteration(double gap, IterationRecord& record, StepReport& report) {
        record.contacts = pairs_.size();
        record.min_gap = gap;
        report.contacts = record.contacts;
        report.min_gap = gap;
        if (law_.stiffen(gap)) energy_known_ = false;
        report.kappa = law().barrier.kappa;
    }

    /// Counts short steps; moves to a stronger contact Hessian, or gives up with the
    /// cause.
    Progress judge_progress(const IterationRecord& record, StepReport& report) {
        stall_.add(record);
        pace_.add(record);
        if (stall_.short_steps == kShortStepsBeforeSwitch && law_.strengthen()) {
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
    Objective<Exec> objective_;
    Collision<Exec> collision_;
    DirectionSolver<Exec> direction_;
    PairSet<Exec> pairs_;
    AdaptiveLaw law_;
    StallDetector stall_;
    BoundaryPace pace_;
    View<const std::uint8_t> fixed_{};
    double stiffness_sum_ = 0.0;  ///< sum of V (mu + lambda), J
    bool use_coarse_ = false;     ///< rigid modes in the linear solver
    bool by_warps_ = false;       ///< contacts multiplied as in the supplement
    bool yielded_ = false;
    Buffer<std::uint8_t> obstacle_;
    Buffer<Vec3d> p_, x_trial_;
    double energy_ = 0.0;
    bool energy_known_ = false;
};

}  // namespace noli
