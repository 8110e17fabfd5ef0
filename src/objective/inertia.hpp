// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Inertia: 1/2 sum_i w_i m_i |x_i - x~_i|^2 over vertices that are not prescribed, plus
/// mass damping. w = dt^2 / h^2 belongs to the integrator of the vertex.

#include "core/vec.hpp"
#include "core/view.hpp"
#include "exec/later.hpp"

#include <cstdint>

namespace noli {

/// Spring of a prescribed vertex that has to yield, in multiples of its inertia.
inline constexpr double kYieldWeight = 1e6;

/// Lumped masses and what they are pulled towards. Source: MATH 7 (incremental
/// potential).
struct InertiaViews {
    View<const double> mass;         ///< kg
    View<const double> weight;       ///< w
    View<const std::uint8_t> fixed;  ///< prescribed vertices: no inertia
    View<const Vec3d> x_tilde;       ///< predicted positions, m
    View<const Vec3d> x_start;       ///< positions at the step's start, m
    double damping;  ///< dt alpha, dimensionless: mass-proportional damping
};

/// Energy of one vertex: w m/2 |x - x~|^2 + damping m/2 |x - x_start|^2.
NOLI_HD inline double inertia_energy(const InertiaViews& in, const Vec3d& x, int v) {
    if (in.fixed[v]) return 0.0;
    return 0.5 * in.mass[v]
         * (in.weight[v] * norm_sq(x - in.x_tilde[v])
            + in.damping * norm_sq(x - in.x_start[v]));
}

NOLI_HD inline Vec3d inertia_gradient(const InertiaViews& in, const Vec3d& x, int v) {
    if (in.fixed[v]) return {0.0, 0.0, 0.0};
    return in.mass[v]
         * (in.weight[v] * (x - in.x_tilde[v]) + in.damping * (x - in.x_start[v]));
}

/// Diagonal of the Hessian; prescribed vertices keep their mass so that the diagonal
/// stays positive.
NOLI_HD inline double inertia_diagonal(const InertiaViews& in, int v) {
    return in.mass[v] * (in.weight[v] + in.damping);
}

namespace detail {

template <class Exec>
Later inertia_energy_sum(Exec& exec, InertiaViews in, View<const Vec3d> x) {
    return exec.sum_later("objective/inertia_energy", x.size, [=] NOLI_HD(int v) {
        return inertia_energy(in, x[v], v);
    });
}

template <class Exec>
void inertia_gradients(Exec& exec, InertiaViews in, View<const Vec3d> x, View<Vec3d> g) {
    exec.for_each("objective/inertia_gradient", x.size, [=] NOLI_HD(int v) {
        g[v] = inertia_gradient(in, x[v], v);
    });
}

template <class Exec>
void inertia_diagonals(Exec& exec, InertiaViews in, View<double> out) {
    exec.for_each("objective/inertia_diagonal", out.size, [=] NOLI_HD(int v) {
        out[v] = inertia_diagonal(in, v);
    });
}

template <class Exec>
void hold_by_springs(Exec& exec,
                     View<const std::uint8_t> was_fixed,
                     View<const std::uint8_t> fixed,
                     View<const Vec3d> target,
                     View<Vec3d> x_tilde,
                     View<double> mass) {
    exec.for_each("objective/hold_by_springs", mass.size, [=] NOLI_HD(int v) {
        if (!was_fixed[v] || fixed[v]) return;
        x_tilde[v] = target[v];
        mass[v] *= kYieldWeight;
    });
}

}  // namespace detail

}  // namespace noli
