// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Distance, normal and weights of the four kinds of contact pair.
///
///     r = sum_i w_i x_i = d n,    grad_{x_i} d = w_i n
///
/// Source: MATH 2.1. Each kind means the distance of its INTERIOR class: point-point,
/// point-line, point-plane, line-line; geometry/closest_feature.hpp says which kind holds
/// for a primitive pair. Normals come from cross products (never from r / |r|, which
/// cancels when d << edge length), and those are computed exactly where doubles would
/// cancel, so d and n are good to about 1e-9 relative even for slivers and nearly
/// parallel edges.

#include "core/stencil.hpp"
#include "geometry/predicates.hpp"

#include <cmath>
#include <cstdint>

namespace noli {

/// Kind of a contact pair; its stencil has 2, 3, 4, 4 points.
enum class PairKind : std::uint8_t { PointPoint, PointEdge, PointTriangle, EdgeEdge };

/// d in m, unit normal n (from the second primitive to the first), weights w.
/// Where the distance is 0 or the kind is degenerate, n is 0.
template <int S>
struct PairGeometry {
    double d;
    Vec3d n;
    double w[S];
};

namespace detail {

NOLI_HD inline Vec3d unit_or_zero(const Vec3d& v) {
    const double length = norm(v);
    return length > 0.0 ? (1.0 / length) * v : Vec3d{0.0, 0.0, 0.0};
}

NOLI_HD inline double ratio_or_zero(double numerator, double denominator) {
    return denominator > 0.0 ? numerator / denominator : 0.0;
}

}  // namespace detail

/// Points p, q. Smooth where d > 0.
NOLI_HD inline PairGeometry<2> point_point_geometry(const Stencil<2>& s) {
    const Vec3d r = s.x[0] - s.x[1];
    return {norm(r), detail::unit_or_zero(r), {1.0, -1.0}};
}

/// Point p against the line through a, b (order p, a, b). Smooth where d > 0.
template <class Stage = Exactly>
NOLI_HD inline PairGeometry<3> point_edge_geometry(const Stencil<3>& s,
                                                   Stage&& stage = {}) {
    const Vec3d& p = s.x[0];
    const Vec3d& a = s.x[1];
    const Vec3d& b = s.x[2];
    const Vec3d e = b - a;
    const Vec3d N = cross_of_edges(a, p, a, b, stage);
    const double tau = detail::ratio_or_zero(dot(p - a, e), norm_sq(e));
    return {detail::ratio_or_zero(norm(N), norm(e)),
            detail::unit_or_zero(cross(e, N)),
            {1.0, tau - 1.0, -tau}};
}

/// Point p against the plane of a, b, c (order p, a, b, c). Smooth where d > 0.
template <class Stage = Exactly>
NOLI_HD inline PairGeometry<4> point_triangle_geometry(const Stencil<4>& s,
                                                       Stage&& stage = {}) {
    const Vec3d& p = s.x[0];
    const Vec3d& a = s.x[1];
    const Vec3d& b = s.x[2];
    const Vec3d& c = s.x[3];
    const Vec3d N = cross_of_edges(a, b, a, c, stage);
    const double n_sq = norm_sq(N);
    const double volume = orient3d_value(a, b, c, p, stage);
    const double beta1 =
        detail::ratio_or_zero(dot(cross_of_edges(a, p, a, c, stage), N), n_sq);
    const double beta2 =
        detail::ratio_or_zero(dot(cross_of_edges(a, b, a, p, stage), N), n_sq);
    return {detail::ratio_or_zero(std::fabs(volume), std::sqrt(n_sq)),
            double(detail::sign_of(volume)) * detail::unit_or_zero(N),
            {1.0, -(1.0 - beta1 - beta2), -beta1, -beta2}};
}

/// Line a0 a1 against line b0 b1 (order a0, a1, b0, b1). Smooth where d > 0 and the lines
/// are not parallel; for exactly parallel lines n and d are 0 (such pairs classify as
/// point-edge).
template <class Stage = Exactly>
NOLI_HD inline PairGeometry<4> edge_edge_geometry(const Stencil<4>& s,
                                                  Stage&& stage = {}) {
    const Vec3d& a0 = s.x[0];
    const Vec3d& a1 = s.x[1];
    const Vec3d& b0 = s.x[2];
    const Vec3d& b1 = s.x[3];
    const Vec3d N = cross_of_edges(a0, a1, b0, b1, stage);
    const double n_sq = norm_sq(N);
    const double volume = orient3d_value(a0, a1, b0, b1, stage);  // (a0 - b0) . N
    const double sigma =
        detail::ratio_or_zero(dot(cross_of_edges(b0, b1, b0, a0, stage), N), n_sq);
    const double tau =
        detail::ratio_or_zero(dot(cross_of_edges(a0, a1, b0, a0, stage), N), n_sq);
    return {detail::ratio_or_zero(std::fabs(volume), std::sqrt(n_sq)),
            double(detail::sign_of(volume)) * detail::unit_or_zero(N),
            {1.0 - sigma, sigma, -(1.0 - tau), -tau}};
}

/// |p - q|^2, m^2.
NOLI_HD inline double point_point_distance_sq(const Stencil<2>& s) {
    return norm_sq(s.x[0] - s.x[1]);
}

/// Squared distance of p to the line a b, m^2 (order p, a, b).
NOLI_HD inline double point_edge_distance_sq(const Stencil<3>& s) {
    return detail::ratio_or_zero(norm_sq(cross_of_edges(s.x[1], s.x[0], s.x[1], s.x[2])),
                                 norm_sq(s.x[2] - s.x[1]));
}

/// Squared distance of p to the plane a b c, m^2 (order p, a, b, c).
NOLI_HD inline double point_triangle_distance_sq(const Stencil<4>& s) {
    const double volume = orient3d_value(s.x[1], s.x[2], s.x[3], s.x[0]);
    return detail::ratio_or_zero(volume * volume,
                                 norm_sq(cross_of_edges(s.x[1], s.x[2], s.x[1], s.x[3])));
}

/// Squared distance of the lines a0 a1 and b0 b1, m^2 (order a0, a1, b0, b1).
NOLI_HD inline double edge_edge_distance_sq(const Stencil<4>& s) {
    const double volume = orient3d_value(s.x[0], s.x[1], s.x[2], s.x[3]);
    return detail::ratio_or_zero(volume * volume,
                                 norm_sq(cross_of_edges(s.x[0], s.x[1], s.x[2], s.x[3])));
}

/// |u x v|^2 with u = a1 - a0, v = b1 - b0, m^4 (order a0, a1, b0, b1). The mollifier's
/// argument, MATH 3.1; plain doubles, so that it agrees with its derivatives.
NOLI_HD inline double edge_cross_sq(const Stencil<4>& s) {
    return norm_sq(cross(s.x[1] - s.x[0], s.x[3] - s.x[2]));
}

}  // namespace noli
