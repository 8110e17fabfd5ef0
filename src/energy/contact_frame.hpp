// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Second-order geometry of a pair, in the one form that all contact Hessians share.
///
/// With r = sum_i w_i x_i = d n the closest-point difference, beta its k closest-point
/// parameters (k = 0 PP, 1 PE, 2 PT and EE), W = dw/dbeta and T = -dr/dbeta, the squared
/// distance D = d^2 has
///
///     grad D = 2 d w (x) n,      hess D = 2 w w^T (x) I - 2 sum_i Y_i Y_i^T,
///     Y_i    = -w (x) t_i + d v_i (x) n
///
/// where t_i, v_i are the columns of T and W after the same change of parameters that
/// makes the t_i orthonormal and the v_i orthogonal. Source: MATH 2.1, 2.5.

#include "core/stencil.hpp"
#include "energy/small_eigen.hpp"
#include "geometry/pair_geometry.hpp"

namespace noli {

/// Number of closest-point parameters of a pair on S points: 0, 1, 2 for S = 2, 3, 4.
template <int S>
inline constexpr int kPairParameters = S - 2;

/// A pair's distance, normal, weights, and the whitened tangents and weight derivatives.
template <int S>
struct ContactFrame {
    double d;          ///< distance, m
    Vec3d n;           ///< unit normal, r = d n
    double w[S];       ///< weights of the points in r
    int num_tangents;  ///< kPairParameters, less where an edge or triangle has collapsed
    Vec3d t[2];        ///< orthonormal tangents, perpendicular to n
    double v[2][S];    ///< weight derivatives that belong to t, 1/m; orthogonal
};

/// Distance, normal and weights of a pair.
template <int S, class Stage = Exactly>
NOLI_HD inline PairGeometry<S> pair_geometry(PairKind kind,
                                             const Stencil<S>& x,
                                             Stage&& stage = {}) {
    static_assert(S >= 2 && S <= 4);
    if constexpr (S == 2) {
        return point_point_geometry(x);
    } else if constexpr (S == 3) {
        return point_edge_geometry(x, stage);
    } else {
        return kind == PairKind::EdgeEdge ? edge_edge_geometry(x, stage)
                                          : point_triangle_geometry(x, stage);
    }
}

/// dw_j / dbeta_i of a pair: constants, because the weights are linear in the parameters.
///     PE (p;a,b): tau    PT (p;a,b,c): beta_1, beta_2    EE (a0,a1;b0,b1): sigma, tau
/// Source: MATH 2.1.
template <int S>
NOLI_HD inline double weight_derivative(PairKind kind, int parameter, int point) {
    if constexpr (S == 3) {
        constexpr double kPointEdge[3] = {0.0, 1.0, -1.0};
        return kPointEdge[point];
    } else {
        constexpr double kPointTriangle[2][4] = {{0.0, 1.0, -1.0, 0.0},
                                                 {0.0, 1.0, 0.0, -1.0}};
        constexpr double kEdgeEdge[2][4] = {{-1.0, 1.0, 0.0, 0.0}, {0.0, 0.0, 1.0, -1.0}};
        return kind == PairKind::EdgeEdge ? kEdgeEdge[parameter][point]
                                          : kPointTriangle[parameter][point];
    }
}

namespace detail {

/// T_i = -sum_j (dw_j / dbeta_i) x_j.
template <int S>
NOLI_HD inline Vec3d raw_tangent(PairKind kind, const Stencil<S>& x, int parameter) {
    Vec3d sum{0.0, 0.0, 0.0};
    for (int j = 0; j < S; ++j)
        sum -= weight_derivative<S>(kind, parameter, j) * x.x[j];
    return sum;
}

/// Turns (t_0, t_1) and (v_0, v_1) by one angle so that the v become orthogonal.
template <int S>
NOLI_HD inline void orthogonalize_weight_derivatives(ContactFrame<S>& f) {
    double a = 0.0;
    double b = 0.0;
    double c = 0.0;
    for (int j = 0; j < S; ++j) {
        a += f.v[0][j] * f.v[0][j];
        b += f.v[0][j] * f.v[1][j];
        c += f.v[1][j] * f.v[1][j];
    }
    const Rotation2 rot = givens_angle(a, b, c);
    const Vec3d t0 = f.t[0];
    f.t[0] = rot.cos * t0 + rot.sin * f.t[1];
    f.t[1] = rot.cos * f.t[1] - rot.sin * t0;
    for (int j = 0; j < S; ++j) {
        const double v0 = f.v[0][j];
        f.v[0][j] = rot.cos * v0 + rot.sin * f.v[1][j];
        f.v[1][j] = rot.cos * f.v[1][j] - rot.sin * v0;
    }
}

/// Whitens the tangents. The second one is n x t_0, which stays accurate for slivers
/// where Gram-Schmidt cancels; a tangent whose length is lost in rounding is dropped, so
/// that every output stays finite for collapsed edges and triangles.
template <int S>
NOLI_HD inline void whiten_tangents(PairKind kind,
                                    const Stencil<S>& x,
                                    ContactFrame<S>& f) {
    constexpr double kCollapsed = 1e-12;  // sine of the angle between the two tangents
    Vec3d raw[2];
    raw[0] = raw_tangent(kind, x, 0);
    int first = 0;
    if constexpr (S == 4) {
        raw[1] = raw_tangent(kind, x, 1);
        first = norm_sq(raw[1]) > norm_sq(raw[0]) ? 1 : 0;  // pivot on the longer one
    }
    const double length = norm(raw[first]);
    if (!(length > 0.0)) return;
    f.num_tangents = 1;
    f.t[0] = (1.0 / length) * raw[first];
    for (int j = 0; j < S; ++j)
        f.v[0][j] = weight_derivative<S>(kind, first, j) / length;

    if constexpr (S == 4) {
        const int second = 1 - first;
        f.t[1] = unit_or_zero(cross(f.n, f.t[0]));
        const double along = dot(f.t[0], raw[second]);
        const double across = dot(f.t[1], raw[second]);
        if (!(std::fabs(across) > kCollapsed * norm(raw[second]))) return;
        f.num_tangents = 2;
        for (int j = 0; j < S; ++j)
            f.v[1][j] =
                (weight_derivative<S>(kind, second, j) - along * f.v[0][j]) / across;
        orthogonalize_weight_derivatives(f);
    }
}

}  // namespace detail

/// All of the above for one pair.
///
/// Source:  MATH 2.5
/// In:      kind  the pair's class; must fit S (S == 4: PointTriangle or EdgeEdge)
///          x     points, in the order of MATH 2.1; closest points inside the class
/// Valid:   d > 0
template <int S, class Stage = Exactly>
NOLI_HD inline ContactFrame<S> contact_frame(PairKind kind,
                                             const Stencil<S>& x,
                                             Stage&& stage = {}) {
    const PairGeometry<S> pair = pair_geometry(kind, x, stage);
    ContactFrame<S> f{};
    f.d = pair.d;
    f.n = pair.n;
    for (int j = 0; j < S; ++j)
        f.w[j] = pair.w[j];
    if constexpr (S > 2) detail::whiten_tangents(kind, x, f);
    return f;
}

}  // namespace noli
