// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Barrier between a point and a fixed or moving half-space {x : normal . x >= offset}.

#include "core/stencil.hpp"
#include "energy/barrier.hpp"
#include "energy/contact_pair.hpp"

namespace noli {

/// The allowed side of a plane.
struct BarrierPlane {
    Vec3d normal;   ///< unit, points into the allowed side
    double offset;  ///< o, m: the plane is normal . x = o
};

/// Signed distance normal . x - o, m; positive on the allowed side.
NOLI_HD inline double half_space_distance(const Vec3d& x, const BarrierPlane& plane) {
    return dot(plane.normal, x) - plane.offset;
}

/// kappa b(d^2), J, with the same exponent as all other pairs; infinite at and behind the
/// plane. Source: MATH 6.
NOLI_HD inline double half_space_energy(const Vec3d& x,
                                        const BarrierPlane& plane,
                                        const BarrierParams& params) {
    const double d = half_space_distance(x, plane);
    if (!(d > 0.0)) return HUGE_VAL;
    return params.kappa
         * barrier(params.exponent, d * d, params.dhat * params.dhat).value;
}

/// kappa b_d n, N. Valid: d > 0. Source: MATH 6.
NOLI_HD inline StencilGradient<1> half_space_gradient(const Vec3d& x,
                                                      const BarrierPlane& plane,
                                                      const BarrierParams& params) {
    const double d = half_space_distance(x, plane);
    const double slope = params.kappa * barrier_slope(params.exponent, d, params.dhat);
    return {{slope * plane.normal}};
}

/// kappa b_dd n n^T as one mode, N/m: the exact Hessian (a plane has no curvature),
/// always PSD. The curvature cap does not apply. Valid: d > 0. Source: MATH 6.
NOLI_HD inline StencilModes<1, 1> half_space_hessian(const Vec3d& x,
                                                     const BarrierPlane& plane,
                                                     const BarrierParams& params) {
    const double d = half_space_distance(x, plane);
    const double curvature =
        params.kappa * barrier_curvature(params.exponent, d, params.dhat);
    StencilModes<1, 1> out{};
    if (!(curvature > 0.0)) return out;
    out.rank = 1;
    out.q[0][0] = std::sqrt(curvature) * plane.normal;
    return out;
}

}  // namespace noli
