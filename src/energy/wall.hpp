// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Barrier between a point and a wall: kappa b(d^2) of the distance d to a half-space, or
/// from inside to a sphere or cylinder.

#include "core/stencil.hpp"
#include "energy/barrier.hpp"
#include "energy/contact_pair.hpp"
#include "energy/tangents.hpp"
#include "geometry/wall.hpp"

namespace noli {

/// Most modes that a wall's Hessian has.
inline constexpr int kMaxWallRank = 3;

/// kappa b(d^2), J, with the same exponent as all other pairs; infinite at and behind the
/// wall. Source: MATH 6.
NOLI_HD inline double wall_energy(const Vec3d& x,
                                  const Wall& wall,
                                  const BarrierParams& params) {
    const double d = wall_distance(wall, x);
    if (!(d > params.min_separation)) return HUGE_VAL;
    return params.kappa * barrier_at(params, d).value;
}

/// kappa b_d n, N. Valid: d > 0. Source: MATH 6.
NOLI_HD inline StencilGradient<1> wall_gradient(const Vec3d& x,
                                                const Wall& wall,
                                                const BarrierParams& params) {
    const double d = wall_distance(wall, x);
    const double slope = params.kappa * barrier_slope_at(params, d);
    return {{slope * wall_normal(wall, x)}};
}

namespace detail {

/// The part of a curved wall's Hessian that its curvature makes, -kappa b_d / r in every
/// curved direction.
NOLI_HD inline void add_curved_modes(const Wall& wall,
                                     const Vec3d& n,
                                     double stiffness,
                                     StencilModes<1, kMaxWallRank>& out) {
    if (!(stiffness > 0.0)) return;
    const bool sphere = wall.shape == WallShape::Sphere;
    // The first tangent follows a cylinder's axis, along which it does not curve.
    const Tangents t = tangents_across(n, sphere ? Vec3d{0.0, 0.0, 0.0} : wall.normal);
    const double scale = std::sqrt(stiffness);
    if (sphere) out.q[out.rank++][0] = scale * t.t0;
    out.q[out.rank++][0] = scale * t.t1;
}

}  // namespace detail

/// The exact Hessian, N/m, always PSD, without a projection:
///
///     kappa (b_dd n n^T - (b_d / r) T),   r = |(x - c) across the axis|,
///
/// T the projection on the directions in which the wall curves (none of a half-space,
/// across the axis and n of a cylinder, across n of a sphere), since the second
/// derivative of d = R - r is -T / r, and b_d < 0. The curvature cap does not apply.
/// Valid: 0 < d; r > 0 where b_d < 0, which dhat < R makes sure of. Source: MATH 6.
NOLI_HD inline StencilModes<1, kMaxWallRank> wall_hessian(const Vec3d& x,
                                                          const Wall& wall,
                                                          const BarrierParams& params) {
    const double d = wall_distance(wall, x);
    const double curvature = params.kappa * barrier_curvature_at(params, d);
    StencilModes<1, kMaxWallRank> out{};
    if (!(curvature > 0.0)) return out;
    const Vec3d n = wall_normal(wall, x);
    out.rank = 1;
    out.q[0][0] = std::sqrt(curvature) * n;
    if (wall.shape == WallShape::HalfSpace) return out;
    const double slope = params.kappa * barrier_slope_at(params, d);
    detail::add_curved_modes(wall, n, -slope / (wall.radius - d), out);
    return out;
}

}  // namespace noli
