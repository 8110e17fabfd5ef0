// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Distances in plain double precision, for deciding what is far: no exact predicates, no
/// closest feature.
///
/// Every candidate is a distance that the primitives attain, and those to the edges are
/// always among them. So the result is never too small but for rounding, and too large by
/// at most kPlainError times the size of the pair: where the interior candidate is
/// spoilt (triangles without area, parallel edges) the nearest edge is as near.
///
/// Source: MATH 9 (regions)

#include "core/vec.hpp"

namespace noli {

/// Error of a plain distance, in sizes of the pair (largest coordinate difference of its
/// points).
inline constexpr double kPlainError = 1e-7;

/// Squared distance of p from the segment a b, m^2.
NOLI_HD inline double plain_point_segment_sq(const Vec3d& p,
                                             const Vec3d& a,
                                             const Vec3d& b) {
    const Vec3d e = b - a;
    const Vec3d ap = p - a;
    const double length_sq = norm_sq(e);
    double t = length_sq > 0.0 ? dot(ap, e) / length_sq : 0.0;
    t = t < 0.0 ? 0.0 : (t > 1.0 ? 1.0 : t);
    return norm_sq(ap - t * e);
}

/// Squared distance of p from the triangle a b c, m^2.
NOLI_HD inline double plain_point_triangle_sq(const Vec3d& p,
                                              const Vec3d& a,
                                              const Vec3d& b,
                                              const Vec3d& c) {
    const double ab = plain_point_segment_sq(p, a, b);
    const double bc = plain_point_segment_sq(p, b, c);
    const double ca = plain_point_segment_sq(p, c, a);
    double nearest = ab < bc ? ab : bc;
    nearest = ca < nearest ? ca : nearest;
    const Vec3d n = cross(b - a, c - a);
    const bool inside = dot(cross(b - a, p - a), n) > 0.0
                     && dot(cross(c - b, p - b), n) > 0.0
                     && dot(cross(a - c, p - c), n) > 0.0;
    if (!inside) return nearest;
    const double height = dot(p - a, n);
    const double interior = height * height / norm_sq(n);
    return interior < nearest ? interior : nearest;
}

/// Squared distance of the segments a0 a1 and b0 b1, m^2.
NOLI_HD inline double plain_edge_edge_sq(const Vec3d& a0,
                                         const Vec3d& a1,
                                         const Vec3d& b0,
                                         const Vec3d& b1) {
    const double end_a0 = plain_point_segment_sq(a0, b0, b1);
    const double end_a1 = plain_point_segment_sq(a1, b0, b1);
    const double end_b0 = plain_point_segment_sq(b0, a0, a1);
    const double end_b1 = plain_point_segment_sq(b1, a0, a1);
    const double of_a = end_a0 < end_a1 ? end_a0 : end_a1;
    const double of_b = end_b0 < end_b1 ? end_b0 : end_b1;
    const double nearest = of_a < of_b ? of_a : of_b;
    const Vec3d n = cross(a1 - a0, b1 - b0);
    const double n_sq = norm_sq(n);
    const double sigma = dot(cross(b1 - b0, a0 - b0), n);
    const double tau = dot(cross(a1 - a0, a0 - b0), n);
    const bool inside = sigma > 0.0 && sigma < n_sq && tau > 0.0 && tau < n_sq;
    if (!inside) return nearest;
    const double height = dot(a0 - b0, n);
    const double interior = height * height / n_sq;
    return interior < nearest ? interior : nearest;
}

}  // namespace noli
