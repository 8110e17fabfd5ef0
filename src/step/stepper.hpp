// SPDX-License-Identifier: Apache-2.0
#pragma once
/// One time step after another: predict, lag, minimise, commit. Owns the state.

#include "exec/sharing.hpp"
#include "model/boundary.hpp"
#include "step/boundary_upload.hpp"
#include "step/first_guess.hpp"
#include "step/friction_lag.hpp"
#include "step/integrator.hpp"
#include "step/newton.hpp"

#include <vector>

namespace noli {

inline constexpr double kYieldShare =
    0.25;  ///< of its motion that a blocked prescribed vertex may lack

/// Up to here a step begins on one thread: with so few vertices more are seldom faster.
inline constexpr int kFewVertices = 120;
/// Seconds of a Newton iteration that all threads shorten wherever the cores are.
inline constexpr double kLongNewton = 1e-3;
/// Of an iteration of PCG, in Newton iterations without it.
inline constexpr double kWorkOfPcg = 0.05;

namespace detail {

/// Largest component of a - b over marked vertices.
template <class Exec>
Later max_distance(Exec& exec,
                   View<const std::uint8_t> marked,
                   View<const Vec3d> a,
                   View<const Vec3d> b) {
    return exec.max_later("step/max_distance", a.size, [=] NOLI_HD(int i) {
        return marked[i] ? max_abs(a[i] - b[i]) : 0.0;
    });
}

}  // namespace detail

/// All that a simulation carries from step to step, on the host.
struct StepState {
    int steps = 0;
    double kappa = 0.0;
    std::vector<Vec3d> x, v, a, x_prev, v_prev;
    std::vector<std::uint8_t> ended;  ///< per boundary condition
};

/// What the last step left unbalanced, on the host, per vertex.
struct Residual {
    std::vector<Vec3d> force;        ///< minus the potential's gradient over dt^2, N
    std::vector<std::uint8_t> held;  ///< 1 = prescribed, on one axis at least
};

template <class Exec>
class Stepper {
  public:
    Stepper(Exec& exec,
            const Model& model,
            const BlockPattern& pattern,
            const StepSettings& settings,
            const Vector3& gravity)
        : exec_(exec),
          model_(model),
          settings_(settings),
          script_(model, gravity),
          newton_(exec, model, pattern, settings_),
          touching_(exec, model),
          friction_lag_(settings_),
          sharing_(model.num_vertices <= kFewVertices, kLongNewton) {
        const std::size_t n = static_cast<std::size_t>(model.num_vertices);
        StepState start;
        start.x = model.x0;
        start.v = model.v0;
        start.a.assign(n, {0.0, 0.0, 0.0});
        start.x_prev = model.x0;
        start.v_prev = model.v0;
        start.ended = script_.ended;
        x_new_.resize(model.num_vertices);
        x_tilde_.resize(model.num_vertices);
        weight_.resize(model.num_vertices);
        set_state(start);
    }

    /// One step. On failure the state keeps the last iterate and the step does not count.
    /// Once `stop` is set the step is cancelled and the state is as it was, bit for bit.
    StepReport step(StopFlag stop = nullptr) {
        settings_.stop = stop;
        StepReport report;
        share_if_faster<Exec>(sharing_, [&](int threads) {
            report.threads = threads;
            take_step(report);
            return report.newton + kWorkOfPcg * report.pcg;
        });
        return report;
    }

    [[nodiscard]] StepState state() {
        StepState out;
        out.steps = steps_;
        out.kappa = newton_.law().barrier.kappa;
        exec_.download(View<const Vec3d>(motion_.x.view()), out.x);
        exec_.download(View<const Vec3d>(motion_.v.view()), out.v);
        exec_.download(View<const Vec3d>(motion_.a.view()), out.a);
        exec_.download(View<const Vec3d>(motion_.x_prev.view()), out.x_prev);
        exec_.download(View<const Vec3d>(motion_.v_prev.view()), out.v_prev);
        out.ended = script_.ended;
        return out;
    }

    void set_state(const StepState& state) {
        steps_ = state.steps;
        newton_.set_kappa(settings_.contact.kappa > 0.0 ? settings_.contact.kappa
                                                        : state.kappa);
        exec_.upload(state.x, motion_.x);
        exec_.upload(state.v, motion_.v);
        exec_.upload(state.a, motion_.a);
        exec_.upload(state.x_prev, motion_.x_prev);
        exec_.upload(state.v_prev, motion_.v_prev);
        script_.ended = state.ended;
        x_host_ = state.x;
        x_is_on_its_way_ = false;
    }

    /// Of the step that ended last; 0 before the first one.
    Residual residual() {
        Residual out;
        out.held = boundary_.prescribed;
        out.held.resize(static_cast<std::size_t>(model_.num_vertices), 1);
        for (std::size_t v = 0; v < boundary_.axes.size(); ++v)
            if (boundary_.axes[v] != 0) out.held[v] = 1;
        newton_.residual_at(motion_.x.view(), x_tilde_.view());
        exec_.download(View<const Vec3d>(x_tilde_.view()), out.force);
        return out;
    }

    Newton<Exec>& newton() { return newton_; }
    /// At the end of the last step. Their copy to the host started there.
    [[nodiscard]] const std::vector<Vec3d>& positions() const {
        if (x_is_on_its_way_) x_arrival_.take(x_host_);
        x_is_on_its_way_ = false;
        return x_host_;
    }
    std::vector<Vec3d> velocities() {
        std::vector<Vec3d> v;
        exec_.download(View<const Vec3d>(motion_.v.view()), v);
        return v;
    }
    [[nodiscard]] View<const Vec3d> x() const { return motion_.x.view(); }
    [[nodiscard]] int steps() const { return steps_; }

  private:
    void take_step(StepReport& report) {
        report.step = steps_ + 1;
        report.time = (steps_ + 1) * settings_.dt;
        const double kappa = newton_.law().barrier.kappa;
        const std::vector<std::uint8_t> ended = script_.ended;
        begin(report);
        report.outcome = solve(report);
        if (report.outcome == Outcome::Cancelled) {
            put_back(kappa, ended);
            return;
        }
        if (newton_.yielded()) judge_yield(report);
        if (report.outcome == Outcome::Converged) {
            detail::advance(exec_,
                            integrators(),
                            on_device_.fixed(),
                            x_new_.view(),
                            motion_.x.view(),
                            motion_.v.view(),
                            motion_.a.view(),
                            motion_.x_prev.view(),
                            motion_.v_prev.view());
            if (settings_.solver.integrator == Integrator::Newmark && some_touch_)
                set_acceleration(Integrator::Newmark);
            if (on_device_.axes().size > 0) advance_axes();
            ++steps_;
        } else {
            exec_.copy(View<const Vec3d>(x_new_.view()), motion_.x.view());
        }
        exec_.start_download(View<const Vec3d>(motion_.x.view()), x_arrival_);
        x_is_on_its_way_ = true;
    }

    /// Undoes a step that does not count; positions and velocities have not changed yet.
    void put_back(double kappa, const std::vector<std::uint8_t>& ended) {
        newton_.set_kappa(kappa);
        script_.ended = ended;
        if (starts_newmark())
            exec_.copy(View<const Vec3d>(a_before_.view()), motion_.a.view());
        newton_.find_pairs_at(motion_.x.view());
    }

    /// Newmark needs an acceleration to start with.
    [[nodiscard]] bool starts_newmark() const {
        return settings_.solver.integrator == Integrator::Newmark && steps_ == 0;
    }

    void advance_axes() {
        detail::advance_axes(exec_,
                             settings_.dt,
                             on_device_.axes(),
                             motion_.x_prev.view(),
                             motion_.x.view(),
                             motion_.v.view(),
                             motion_.a.view());
    }

    /// BDF2 needs two old states: its first step is an Euler step.
    [[nodiscard]] IntegratorChoice choice() const {
        Integrator kind = settings_.solver.integrator;
        if (kind == Integrator::Bdf2 && steps_ == 0) kind = Integrator::ImplicitEuler;
        return {kind,
                settings_.dt,
                settings_.solver.newmark_beta,
                settings_.solver.newmark_gamma};
    }

    [[nodiscard]] IntegratorOfVertex integrators() const {
        return {choice(), touching_.bodies(), newton_.objective().device().body.view()};
    }

    void begin(StepReport& report) {
        script_.evaluate(
            steps_ * settings_.dt, settings_.dt, steps_, positions(), boundary_);
        on_device_.update(exec_, boundary_);
        touching_.begin_step(exec_);
        some_touch_ = false;
        if (starts_newmark()) start_acceleration();
        newton_.find_first_pairs(motion_.x.view(), report);
        find_touching();
        predict();
        const double dt = settings_.dt;
        const StepScales scales{.h_sq = dt * dt,
                                .mass_damping = dt * settings_.damping.mass,
                                .stiffness_damping = settings_.damping.stiffness / dt,
                                .friction_eps = settings_.epsv * dt};
        exec_.copy(View<const Vec3d>(motion_.x.view()), x_new_.view());
        newton_.set_axes(on_device_.axes());
        newton_.begin_step(scales,
                           on_device_.fixed(),
                           motion_.x.view(),
                           x_tilde_.view(),
                           weight_.view());
    }

    void predict() {
        detail::predict(exec_,
                        integrators(),
                        motion_.x.view(),
                        motion_.v.view(),
                        motion_.a.view(),
                        motion_.x_prev.view(),
                        motion_.v_prev.view(),
                        on_device_.acceleration(),
                        x_tilde_.view(),
                        weight_.view());
        if (on_device_.axes().size > 0)
            detail::copy_axes(
                exec_,
                on_device_.axes(),
                BoundaryPath(on_device_.path(), static_cast<int>(boundary_.path.size()))
                    .end(),
                x_tilde_.view());
    }

    /// True if elastic bodies have come into contact since this was asked last in the
    /// step, and that matters to the integrator.
    bool find_touching() {
        if (choice().kind == Integrator::ImplicitEuler) return false;
        const bool more = newton_.add_touching(touching_);
        some_touch_ = some_touch_ || more;
        return more;
    }

    /// Minimises with lagged friction, as often as asked for, until nothing changes any
    /// more, or while the forces of the last lag differ from those at its end.
    Outcome solve(StepReport& report) {
        const double tolerance = model_.tolerance(settings_.solver, steps_);
        BoundaryPath path(on_device_.path(), static_cast<int>(boundary_.path.size()));
        if (settings_.solver.start == NewtonStart::Extrapolated && path.is_one_leg()
            && on_device_.axes().size == 0)
            go_ahead(path, report);
        for (int lag = 0;; ++lag) {
            const int before = report.newton;
            const Outcome outcome =
                newton_.minimize(path, tolerance, x_new_.view(), report);
            report.friction_updates = settings_.has_friction ? lag + 1 : 0;
            if (outcome != Outcome::Converged) return outcome;
            if (!newton_.yielded() && find_touching()) {
                predict();
                newton_.objective().set_prediction(
                    exec_, View<const Vec3d>(x_tilde_.view()), weight_.view());
                newton_.lag_friction_at(x_new_.view());
                --lag;
                continue;
            }
            if (!friction_lag_.again(lag, report.newton - before, report, [&] {
                    return newton_.lag_friction_again_at(x_new_.view());
                }))
                return outcome;
        }
    }

    /// Starts Newton's method where the last two steps lead, if that is any better.
    void go_ahead(const BoundaryPath& path, StepReport& report) {
        detail::extrapolate(exec_,
                            settings_.dt,
                            on_device_.fixed(),
                            path.end(),
                            motion_.x.view(),
                            motion_.v.view(),
                            motion_.v_prev.view(),
                            x_tilde_.view());
        newton_.go_ahead(View<const Vec3d>(x_tilde_.view()),
                         boundary_.num_prescribed > 0,
                         x_new_.view(),
                         report);
    }

    /// How far prescribed vertices stayed behind; too far is a blocked boundary.
    void judge_yield(StepReport& report) {
        const View<const std::uint8_t> fixed = on_device_.fixed();
        const View<const Vec3d> target =
            BoundaryPath(on_device_.path(), static_cast<int>(boundary_.path.size()))
                .end();
        const Later yield = detail::max_distance(exec_, fixed, x_new_.view(), target);
        const Later motion = detail::max_distance(exec_, fixed, motion_.x.view(), target);
        report.boundary_yield = exec_.value(yield);
        const double allowed =
            std::max(settings_.dhat, kYieldShare * exec_.value(motion));
        if (report.boundary_yield <= allowed || report.outcome != Outcome::Converged)
            return;
        report.outcome = Outcome::BoundaryBlocked;
        report.message =
            "prescribed vertices stay " + std::to_string(report.boundary_yield)
            + " m short of their targets, more than the " + std::to_string(allowed)
            + " m that they may yield to contact; the motion runs into something";
    }

    /// Newmark's first acceleration; that of before is kept for a step that is cancelled.
    void start_acceleration() {
        a_before_.resize(model_.num_vertices);
        exec_.copy(View<const Vec3d>(motion_.a.view()), a_before_.view());
        set_acceleration(Integrator::ImplicitEuler);  // of all: nothing touches yet
    }

    /// Newmark's acceleration a = a_ext - M^-1 grad Psi(x), contact left out, of the
    /// vertices whose integrator is not `other_than`.
    void set_acceleration(Integrator other_than) {
        newton_.objective().elastic_gradient_at(exec_, motion_.x.view(), x_tilde_.view());
        detail::acceleration_from_forces(exec_,
                                         integrators(),
                                         other_than,
                                         newton_.objective().device().mass.view(),
                                         on_device_.fixed(),
                                         x_tilde_.view(),
                                         on_device_.acceleration(),
                                         motion_.a.view());
        if (on_device_.axes().size > 0)
            detail::zero_axes(exec_, on_device_.axes(), motion_.a.view());
    }

    Exec& exec_;
    const Model& model_;
    StepSettings settings_;
    BoundaryScript script_;
    StepBoundary boundary_;
    Newton<Exec> newton_;
    Touching<Exec> touching_;
    bool some_touch_ = false;  ///< of the elastic bodies, in this step
    FrictionLag friction_lag_;
    SharingOfSteps sharing_;
    MotionState<Exec> motion_;
    BoundaryUpload<Exec> on_device_;
    typename Exec::template Buffer<Vec3d> x_new_, x_tilde_;
    typename Exec::template Buffer<double> weight_;   ///< of inertia, see predict
    typename Exec::template Buffer<Vec3d> a_before_;  ///< of a first Newmark step
    mutable std::vector<Vec3d> x_host_;
    mutable typename Exec::template Arrival<Vec3d> x_arrival_;
    mutable bool x_is_on_its_way_ = false;
    int steps_ = 0;
};

}  // namespace noli
