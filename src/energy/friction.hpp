// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Lagged friction of one pair: mu lambda_N f0(|u|) of the tangential displacement
///
///     u = B^T sum_i w_i (x_i - x_i^n)
///
/// with basis B, weights w and normal force lambda_N frozen at the lagged state.

#include "core/stencil.hpp"
#include "energy/contact_pair.hpp"
#include "energy/friction_law.hpp"
#include "energy/mollified_pair.hpp"
#include "energy/tangents.hpp"
#include "energy/wall.hpp"

namespace noli {

/// Frozen state of a pair's friction.
template <int S>
struct FrictionBasis {
    Vec3d t0, t1;         ///< orthonormal, perpendicular to the contact normal
    double w[S];          ///< weights of the points in the relative displacement
    double normal_force;  ///< lambda_N = -dE/dd, N; >= 0
};

namespace detail {

template <int S>
NOLI_HD inline void set_tangents(const Vec3d& n,
                                 const Vec3d& hint,
                                 FrictionBasis<S>& out) {
    const Tangents t = tangents_across(n, hint);
    out.t0 = t.t0;
    out.t1 = t.t1;
}

/// u = B^T sum_i w_i moved_i, m.
template <int S>
NOLI_HD inline Vec2d tangential_displacement(const FrictionBasis<S>& basis,
                                             const Stencil<S>& moved) {
    Vec3d slip{0.0, 0.0, 0.0};
    for (int i = 0; i < S; ++i)
        slip += basis.w[i] * moved.x[i];
    return {dot(basis.t0, slip), dot(basis.t1, slip)};
}

}  // namespace detail

/// Basis of a PP, PE, PT or EE pair.
///
/// Source:  MATH 5; first tangent along b - a (PE, PT) or u (EE), any for PP
/// In:      kind, x  the pair at the lagged state; d > 0
///          params   kappa and exponent of that moment
template <int S>
NOLI_HD inline FrictionBasis<S> friction_basis(PairKind kind,
                                               const Stencil<S>& x,
                                               const BarrierParams& params) {
    const PairGeometry<S> pair = pair_geometry(kind, x);
    FrictionBasis<S> out;
    Vec3d hint{0.0, 0.0, 0.0};
    if constexpr (S == 3) hint = x.x[2] - x.x[1];
    if constexpr (S == 4)
        hint = kind == PairKind::EdgeEdge ? x.x[1] - x.x[0] : x.x[2] - x.x[1];
    detail::set_tangents(pair.n, hint, out);
    for (int i = 0; i < S; ++i)
        out.w[i] = pair.w[i];
    out.normal_force = -params.kappa * barrier_slope_at(params, pair.d);
    return out;
}

/// Basis of a mollified pair: normal and weights of its sub-case (zero for the vertices
/// that take no part), and lambda_N = -d(kappa m b)/dd = -kappa m b_d, the normal force
/// that the mollified energy exerts along n. Exactly parallel edges thus have no
/// friction, as they have no force.
///
/// Source:  MATH 5 applied to MATH 3 ([Li2020] leaves mollified pairs frictionless)
NOLI_HD inline FrictionBasis<4> mollified_friction_basis(const MollifiedCase& sub,
                                                         const Stencil<4>& x,
                                                         double eps_cross,
                                                         const BarrierParams& params) {
    const PairGeometry<4> pair = mollified_geometry(sub, x);
    FrictionBasis<4> out;
    detail::set_tangents(pair.n, x.x[1] - x.x[0], out);
    for (int i = 0; i < 4; ++i)
        out.w[i] = pair.w[i];
    out.normal_force = -params.kappa * mollifier(edge_cross_sq(x), eps_cross).value
                     * barrier_slope_at(params, pair.d);
    return out;
}

/// Basis of a point at a wall: the tangent plane at the lagged point. For a moving wall
/// the caller subtracts the wall's own displacement from the point's. Valid: d > 0.
/// Source: MATH 5, 6.
NOLI_HD inline FrictionBasis<1> wall_friction_basis(const Vec3d& x,
                                                    const Wall& wall,
                                                    const BarrierParams& params) {
    FrictionBasis<1> out;
    detail::set_tangents(wall_normal(wall, x), Vec3d{0.0, 0.0, 0.0}, out);
    out.w[0] = 1.0;
    out.normal_force = -params.kappa * barrier_slope_at(params, wall_distance(wall, x));
    return out;
}

/// mu lambda_N f0(|u|), J.
///
/// Source:  MATH 5
/// In:      moved  x_i - x_i^n, displacements since the step's start, m
///          mu     friction coefficient; >= 0
///          eps    epsv dt, m; > 0
template <int S>
NOLI_HD inline double friction_energy(const FrictionBasis<S>& basis,
                                      const Stencil<S>& moved,
                                      double mu,
                                      double eps) {
    const Vec2d u = detail::tangential_displacement(basis, moved);
    return mu * basis.normal_force * friction_law(detail::hypot2(u.x, u.y), eps).f0;
}

/// How far a Newton direction is from having settled this pair's friction: |du| over
/// max(eps, |u|), du and u the tangential displacements of the direction and since the
/// step's start. Of order 1: it cannot be told yet whether the pair sticks.
/// In:      direction  p_i, m
template <int S>
NOLI_HD inline double friction_unrest(const FrictionBasis<S>& basis,
                                      const Stencil<S>& moved,
                                      const Stencil<S>& direction,
                                      double eps) {
    const Vec2d u = detail::tangential_displacement(basis, moved);
    const Vec2d du = detail::tangential_displacement(basis, direction);
    const double size = detail::hypot2(u.x, u.y);
    return detail::hypot2(du.x, du.y) / (size > eps ? size : eps);
}

/// mu lambda_N (f1 / |u|) w_i B u, N. Source: MATH 5.
template <int S>
NOLI_HD inline StencilGradient<S> friction_gradient(const FrictionBasis<S>& basis,
                                                    const Stencil<S>& moved,
                                                    double mu,
                                                    double eps) {
    const Vec2d u = detail::tangential_displacement(basis, moved);
    const FrictionJet f = friction_law(detail::hypot2(u.x, u.y), eps);
    const Vec3d force =
        (mu * basis.normal_force * f.f1_over_y) * (u.x * basis.t0 + u.y * basis.t1);
    StencilGradient<S> out;
    for (int i = 0; i < S; ++i)
        out.g[i] = basis.w[i] * force;
    return out;
}

}  // namespace noli
