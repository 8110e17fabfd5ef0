// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Time integrators as predictors of the incremental potential: x~ and h^2 before the
/// solve, the new velocity after it.
///
///     implicit Euler  h^2 = dt^2       x~ = x + dt v + h^2 a_ext
///                     v'  = (x' - x) / dt
///     BDF2            h^2 = 4/9 dt^2   x~ = (4 x - x_1) / 3 + 2/9 dt (4 v - v_1) + h^2
///     a_ext
///                     v'  = (3 x' - 4 x + x_1) / (2 dt)
///     Newmark         h^2 = beta dt^2  x~ = x + dt v + dt^2 (1/2 - beta) a + h^2 a_ext
///                     a'  = (x' - x - dt v - dt^2 (1/2 - beta) a) / (beta dt^2)
///                     v'  = v + dt ((1 - gamma) a + gamma a')
///
/// x_1, v_1: one step earlier; a: acceleration of the last step. BDF2 starts with one
/// Euler step.
///
/// **Bodies in contact take implicit Euler**, whatever the scene asks for
/// (step/touching.hpp). A contact force that starts or ends within a step is no smooth
/// function of time: BDF2 answers a sudden stop with a rebound of half the speed,
/// Newmark's average pushes on after bodies have parted, and both let energy grow.
/// Source: MATH 7 (Euler), standard texts [Hairer1996] for the others; contact implicit,
/// all else as asked for: [Kane1999]; why whole bodies:
/// docs/decisions/022-integrators-in-contact.md.

#include "noli/scene.hpp"

#include "core/vec.hpp"
#include "core/view.hpp"

#include <cstdint>

namespace noli {

/// Motion of all vertices; arrays are per vertex.
template <class Exec>
struct MotionState {
    typename Exec::template Buffer<Vec3d> x, v, a;         ///< m, m/s, m/s^2
    typename Exec::template Buffer<Vec3d> x_prev, v_prev;  ///< one step earlier
};

struct IntegratorChoice {
    Integrator kind;  ///< Bdf2 only from the second step on
    double dt, beta, gamma;

    [[nodiscard]] NOLI_HD double h_sq() const {
        if (kind == Integrator::Bdf2) return 4.0 / 9.0 * dt * dt;
        return kind == Integrator::Newmark ? beta * dt * dt : dt * dt;
    }
};

/// Which integrator each vertex takes in a step.
struct IntegratorOfVertex {
    IntegratorChoice choice;
    View<const std::uint8_t> touching;  ///< per body: 1 = implicit Euler
    View<const int> body;               ///< per vertex

    [[nodiscard]] NOLI_HD IntegratorChoice at(int vertex) const {
        IntegratorChoice own = choice;
        if (touching[body[vertex]]) own.kind = Integrator::ImplicitEuler;
        return own;
    }
};

namespace detail {

/// x~, and the weight dt^2 / h^2 of a vertex's inertia in the potential, which is scaled
/// by dt^2 for all.
template <class Exec>
void predict(Exec& exec,
             IntegratorOfVertex how,
             View<const Vec3d> x,
             View<const Vec3d> v,
             View<const Vec3d> a,
             View<const Vec3d> x_prev,
             View<const Vec3d> v_prev,
             View<const Vec3d> a_ext,
             View<Vec3d> x_tilde,
             View<double> weight) {
    exec.for_each("step/predict", x.size, [=] NOLI_HD(int i) {
        const IntegratorChoice own = how.at(i);
        const double dt = own.dt;
        const double h_sq = own.h_sq();
        Vec3d at = x[i] + dt * v[i];
        if (own.kind == Integrator::Bdf2)
            at = (1.0 / 3.0) * (4.0 * x[i] - x_prev[i])
               + (2.0 / 9.0 * dt) * (4.0 * v[i] - v_prev[i]);
        if (own.kind == Integrator::Newmark) at += (dt * dt * (0.5 - own.beta)) * a[i];
        x_tilde[i] = at + h_sq * a_ext[i];
        weight[i] = dt * dt / h_sq;
    });
}

/// x_new becomes the state. Newmark's acceleration of vertices that took implicit Euler
/// is left to acceleration_from_forces.
template <class Exec>
void advance(Exec& exec,
             IntegratorOfVertex how,
             View<const std::uint8_t> fixed,
             View<const Vec3d> x_new,
             View<Vec3d> x,
             View<Vec3d> v,
             View<Vec3d> a,
             View<Vec3d> x_prev,
             View<Vec3d> v_prev) {
    exec.for_each("step/advance", x.size, [=] NOLI_HD(int i) {
        const IntegratorChoice own = how.at(i);
        const double dt = own.dt;
        const Vec3d x_old = x[i];
        const Vec3d v_old = v[i];
        const Vec3d to = x_new[i];
        Vec3d v_new = (1.0 / dt) * (to - x_old);
        if (!fixed[i] && own.kind == Integrator::Bdf2)
            v_new = (0.5 / dt) * (3.0 * to - 4.0 * x_old + x_prev[i]);
        if (own.kind == Integrator::Newmark) {
            const double beta = own.beta;
            const Vec3d drift = dt * v_old + (dt * dt * (0.5 - beta)) * a[i];
            const Vec3d a_new = (1.0 / (beta * dt * dt)) * (to - x_old - drift);
            if (!fixed[i])
                v_new = v_old + dt * ((1.0 - own.gamma) * a[i] + own.gamma * a_new);
            a[i] = fixed[i] ? Vec3d{0.0, 0.0, 0.0} : a_new;
        }
        x_prev[i] = x_old;
        v_prev[i] = v_old;
        x[i] = to;
        v[i] = v_new;
    });
}

/// a = a_ext - gradient / m of the vertices whose integrator is not `other_than`; 0 where
/// prescribed.
template <class Exec>
void acceleration_from_forces(Exec& exec,
                              IntegratorOfVertex how,
                              Integrator other_than,
                              View<const double> mass,
                              View<const std::uint8_t> fixed,
                              View<const Vec3d> gradient,
                              View<const Vec3d> a_ext,
                              View<Vec3d> a) {
    exec.for_each("step/start_acceleration", a.size, [=] NOLI_HD(int i) {
        if (how.at(i).kind == other_than) return;
        a[i] = fixed[i] ? Vec3d{0.0, 0.0, 0.0} : a_ext[i] - (1.0 / mass[i]) * gradient[i];
    });
}

}  // namespace detail

}  // namespace noli
