// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Inertia: 1/2 sum_i m_i |x_i - x~_i|^2 over vertices that are not prescribed, plus mass
/// damping.

#include "core/vec.hpp"
#include "core/view.hpp"

namespace noli {

/// Lumped masses and what they are pulled towards. Source: MATH 7 (incremental
/// potential).
struct InertiaViews {
    View<const double> mass;         ///< kg
    View<const std::uint8_t> fixed;  ///< prescribed vertices: no inertia
    View<const Vec3d> x_tilde;       ///< predicted positions, m
    View<const Vec3d> x_start;       ///< positions at the step's start, m
    double damping;  ///< h^2 alpha / dt, dimensionless: mass-proportional damping
};

/// Energy of one vertex: m/2 |x - x~|^2 + damping m/2 |x - x_start|^2.
NOLI_HD inline double inertia_energy(const InertiaViews& in, const Vec3d& x, int v) {
    if (in.fixed[v]) return 0.0;
    return 0.5 * in.mass[v]
         * (norm_sq(x - in.x_tilde[v]) + in.damping * norm_sq(x - in.x_start[v]));
}

NOLI_HD inline Vec3d inertia_gradient(const InertiaViews& in, const Vec3d& x, int v) {
    if (in.fixed[v]) return {0.0, 0.0, 0.0};
    return in.mass[v] * ((x - in.x_tilde[v]) + in.damping * (x - in.x_start[v]));
}

/// Diagonal of the Hessian; prescribed vertices keep their mass so that the diagonal
/// stays positive.
NOLI_HD inline double inertia_diagonal(const InertiaViews& in, int v) {
    return in.mass[v] * (1.0 + in.damping);
}

}  // namespace noli
