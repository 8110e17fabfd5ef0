// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The three integrators applied to one number: what the model itself says, so that an
/// answer for a finite time step is exact and needs no allowance for the step.
///
/// All vertices of a body that only translates follow the same scalar x. Those of a rigid
/// body that turns in a plane follow x_i = z r_i with one complex z of modulus 1: a stiff
/// body minimises sum m_i |x_i - x~_i|^2 over rigid motions, and with x~_i = z~ r_i the
/// best one is z = z~ / |z~| where r_i are taken about the centre of mass. Formulas of
/// the predictors: docs/theory/inertia_and_integrators.md; written anew here.

#include "noli/scene.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>

namespace noli::accuracy {

using Complex = std::complex<double>;

template <class T>
class Discrete {
  public:
    /// `a0` is the acceleration at the start, which only Newmark reads.
    Discrete(Integrator kind, double dt, T x0, T v0, T a0 = T{})
        : x(x0), v(v0), kind_(kind), dt_(dt), a_(a0), x_1_(x0), v_1_(v0) {}

    [[nodiscard]] double h_sq() const {
        if (now() == Integrator::Bdf2) return 4.0 * dt_ * dt_ / 9.0;
        return now() == Integrator::Newmark ? 0.25 * dt_ * dt_ : dt_ * dt_;
    }
    /// Says whether the body is in contact in the step that comes: then it takes implicit
    /// Euler, and Newmark's acceleration afterwards is `a`, that of all forces but
    /// contact.
    void touch(bool on, T a) {
        touching_ = on;
        a_apart_ = a;
    }
    [[nodiscard]] double dt() const { return dt_; }

    /// x~ under the acceleration a.
    [[nodiscard]] T predicted(T a) const {
        if (now() == Integrator::Bdf2)
            return (4.0 * x - x_1_) / 3.0 + (2.0 * dt_ / 9.0) * (4.0 * v - v_1_)
                 + h_sq() * a;
        if (now() == Integrator::Newmark) return x + dt_ * v + h_sq() * (a_ + a);
        return x + dt_ * v + h_sq() * a;
    }

    /// The step ends at `to`.
    void accept(T to) {
        T v_new = (to - x) / dt_;
        if (now() == Integrator::Bdf2) v_new = (3.0 * to - 4.0 * x + x_1_) / (2.0 * dt_);
        if (now() == Integrator::Newmark) {
            const T a_new = 4.0 * (to - x - dt_ * v) / (dt_ * dt_) - a_;
            v_new = v + 0.5 * dt_ * (a_ + a_new);
            a_ = a_new;
        }
        if (touching_) a_ = a_apart_;
        x_1_ = x;
        v_1_ = v;
        x = to;
        v = v_new;
        ++steps_;
    }

    T x, v;

  private:
    /// BDF2 starts with one step of implicit Euler; bodies in contact take it always.
    [[nodiscard]] Integrator now() const {
        const bool first = kind_ == Integrator::Bdf2 && steps_ == 0;
        return first || touching_ ? Integrator::ImplicitEuler : kind_;
    }

    Integrator kind_;
    double dt_;
    T a_, x_1_, v_1_;
    T a_apart_{};
    bool touching_ = false;
    int steps_ = 0;
};

/// The root of a function that rises from `low` to `high`.
inline double root_of_rising(const std::function<double(double)>& f,
                             double low,
                             double high) {
    for (int k = 0; k < 200; ++k) {
        const double middle = 0.5 * (low + high);
        (f(middle) < 0.0 ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

/// A point mass under constant acceleration and mass damping alpha, which acts on the
/// mean velocity of the step: (x' - x~) / h^2 + alpha (x' - x) / dt = 0.
inline void fall(Discrete<double>& point, double a, double dt, double alpha = 0.0) {
    const double damping = point.h_sq() * alpha / dt;
    point.accept((point.predicted(a) + damping * point.x) / (1.0 + damping));
}

/// Share of mu N that acts at the mean sliding speed v of a step:
/// docs/theory/friction.md.
inline double friction_share(double speed, double epsv) {
    const double y = std::abs(speed) / epsv;
    return std::copysign(y < 1.0 ? y * (2.0 - y) : 1.0, speed);
}

/// A point on a plane: the normal force of each step is what keeps it at its height, 0
/// for a body that stays down. Along the plane
///
///     (x' - x~) / dt^2 + mu N f1((x' - x) / dt - belt speed) = 0.
class Slider {
  public:
    /// Drive along the plane and weight across it, m/s^2.
    Slider(Integrator kind, double dt, double v, double drive, double weight)
        : along(kind, dt, 0.0, v, drive),
          drive_(drive),
          weight_(weight),
          across_(kind, dt, 0.0, 0.0, -weight) {}

    /// `height` above the plane at the end of the step, of a body that may bounce, and
    /// whether it touches in the step.
    void step(double mu,
              double epsv,
              double belt_speed = 0.0,
              double height = 0.0,
              bool touches = true) {
        along.touch(touches, drive_);
        across_.touch(touches, -weight_);
        const double lifted =
            touches ? std::max(0.0, height - across_.predicted(-weight_)) : 0.0;
        across_.accept(height);
        const double free = along.predicted(drive_);
        const double reach = 2.0 * mu * std::abs(lifted) + 1e-300;
        const auto balance = [&](double x) {
            const double speed = (x - along.x) / along.dt() - belt_speed;
            return x - free + mu * lifted * friction_share(speed, epsv);
        };
        along.accept(root_of_rising(balance, free - reach, free + reach));
    }

    Discrete<double> along;

  private:
    double drive_, weight_;
    Discrete<double> across_;
};

/// Slope of the barrier in the distance d, m^3: docs/theory/barrier.md with r = 2.
inline double barrier_slope(double d, double dhat) {
    if (d >= dhat) return 0.0;
    const double log = 2.0 * std::log(d / dhat);
    const double t = d * d - dhat * dhat;
    return 2.0 * d * 2.0 * t * log * (log + t / (d * d));
}

/// The least stiffness of the barrier, J s^2/m^4: docs/theory/stiffness.md with c = 1e11.
inline double least_stiffness(double mean_mass, double diagonal, double dhat) {
    const double d_sq = 1e-16 * diagonal * diagonal;
    const double u = 1.0 - dhat * dhat / d_sq;
    const double curvature = u * u - 4.0 * u - 2.0 * std::log(d_sq / (dhat * dhat));
    return 1e11 * mean_mass / (4.0 * d_sq * curvature);
}

/// A body of mass m at distance point.x from a plane that it meets with n equal vertices.
/// Along the normal it is driven by a: m (x' - x~) + n kappa b_d(x') = 0.
inline void press(Discrete<double>& point,
                  double a,
                  double n_kappa_over_mass,
                  double dhat) {
    point.touch(false, a);
    if (point.x >= dhat && point.predicted(a) >= dhat)
        return point.accept(point.predicted(a));
    point.touch(true, a);
    const double free = point.predicted(a);
    const auto balance = [&](double x) {
        return x - free + n_kappa_over_mass * barrier_slope(x, dhat);
    };
    if (free >= dhat) return point.accept(free);
    point.accept(root_of_rising(balance, std::max(free, 1e-9 * dhat), dhat));
}

/// A stiff body that turns freely.
inline void spin(Discrete<Complex>& z) {
    const Complex free = z.predicted({});
    z.accept(free / std::abs(free));
}

}  // namespace noli::accuracy
