// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Exact intersection tests: yes or no, decided without rounding.
///
/// All sets are closed (touching counts) and every degenerate case is decided: coplanar
/// segments and triangles, triangles that are a segment or a point, segments that are a
/// point. Flat cases are projected along a coordinate axis on which they keep their area;
/// that projection is one-to-one on their plane, so the 2-D answer is the 3-D answer.
///
/// Source: exact signs of geometry/predicates.hpp and their valid coordinate range.

#include "geometry/predicates.hpp"

namespace noli {

namespace detail {

NOLI_HD inline bool same_point(const Vec3d& a, const Vec3d& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

/// Drops coordinate `axis`, keeping the orientation of the other two.
NOLI_HD inline Vec2d drop_axis(const Vec3d& a, int axis) {
    if (axis == 0) return {a.y, a.z};
    if (axis == 1) return {a.z, a.x};
    return {a.x, a.y};
}

inline constexpr int kNoAxis = -1;

/// An axis along which triangle abc projects to non-zero area; kNoAxis if a, b, c are
/// collinear.
NOLI_HD inline int projection_axis(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    for (int axis = 0; axis < 3; ++axis)
        if (orient2d_sign(drop_axis(a, axis), drop_axis(b, axis), drop_axis(c, axis))
            != 0)
            return axis;
    return kNoAxis;
}

/// An axis along which edges ab and cd project to non-parallel ones; kNoAxis if they are
/// parallel or one of them is a point.
NOLI_HD inline int crossing_axis(const Vec3d& a,
                                 const Vec3d& b,
                                 const Vec3d& c,
                                 const Vec3d& d) {
    // N is off by far less than its largest component, so that one is truly not 0 unless
    // N is.
    const Vec3d N = cross_of_edges(a, b, c, d);
    const double largest = max_abs(N);
    for (int axis = 0; axis < 3; ++axis)
        if (largest > 0.0 && std::fabs(N[axis]) == largest) return axis;
    return kNoAxis;
}

NOLI_HD inline bool between(double x, double a, double b) {
    return (a <= x && x <= b) || (b <= x && x <= a);
}

/// p inside or on the triangle abc of non-zero area, all in the plane.
NOLI_HD inline bool point_on_triangle_2d(const Vec2d& p,
                                         const Vec2d& a,
                                         const Vec2d& b,
                                         const Vec2d& c) {
    const int ab = orient2d_sign(a, b, p);
    const int bc = orient2d_sign(b, c, p);
    const int ca = orient2d_sign(c, a, p);
    const bool any_left = ab > 0 || bc > 0 || ca > 0;
    const bool any_right = ab < 0 || bc < 0 || ca < 0;
    return !(any_left && any_right);
}

/// p on the segment ab, all in the plane.
NOLI_HD inline bool point_on_segment_2d(const Vec2d& p, const Vec2d& a, const Vec2d& b) {
    return between(p.x, a.x, b.x) && between(p.y, a.y, b.y)
        && orient2d_sign(a, b, p) == 0;
}

/// Segments pq and ab in the plane, any of them possibly a point.
NOLI_HD inline bool segments_intersect_2d(const Vec2d& p,
                                          const Vec2d& q,
                                          const Vec2d& a,
                                          const Vec2d& b) {
    const int p_side = orient2d_sign(a, b, p);
    const int q_side = orient2d_sign(a, b, q);
    const int a_side = orient2d_sign(p, q, a);
    const int b_side = orient2d_sign(p, q, b);
    if (p_side * q_side < 0 && a_side * b_side < 0) return true;
    return point_on_segment_2d(p, a, b) || point_on_segment_2d(q, a, b)
        || point_on_segment_2d(a, p, q) || point_on_segment_2d(b, p, q);
}

}  // namespace detail

/// p on the closed segment ab.
NOLI_HD inline bool point_on_segment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
    using detail::between;
    return between(p.x, a.x, b.x) && between(p.y, a.y, b.y) && between(p.z, a.z, b.z)
        && detail::projection_axis(a, b, p) == detail::kNoAxis;
}

/// Closed segments pq and ab have a common point.
NOLI_HD inline bool segments_intersect_3d(const Vec3d& p,
                                          const Vec3d& q,
                                          const Vec3d& a,
                                          const Vec3d& b) {
    if (orient3d_sign(p, q, a, b) != 0) return false;
    const int axis = detail::crossing_axis(p, q, a, b);
    if (axis != detail::kNoAxis) {
        using detail::drop_axis;
        return detail::segments_intersect_2d(drop_axis(p, axis),
                                             drop_axis(q, axis),
                                             drop_axis(a, axis),
                                             drop_axis(b, axis));
    }
    return point_on_segment(p, a, b) || point_on_segment(q, a, b)
        || point_on_segment(a, p, q) || point_on_segment(b, p, q);
}

/// p in the closed triangle abc, which may be a segment or a point.
NOLI_HD inline bool point_on_triangle(const Vec3d& p,
                                      const Vec3d& a,
                                      const Vec3d& b,
                                      const Vec3d& c) {
    if (orient3d_sign(a, b, c, p) != 0) return false;
    const int axis = detail::projection_axis(a, b, c);
    if (axis == detail::kNoAxis)
        return point_on_segment(p, a, b) || point_on_segment(p, b, c)
            || point_on_segment(p, c, a);
    using detail::drop_axis;
    return detail::point_on_triangle_2d(
        drop_axis(p, axis), drop_axis(a, axis), drop_axis(b, axis), drop_axis(c, axis));
}

namespace detail {

/// p and q lie in the plane of abc, or abc has no area.
NOLI_HD inline bool flat_segment_intersects_triangle(
    const Vec3d& p, const Vec3d& q, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const int axis = projection_axis(a, b, c);
    if (axis == kNoAxis)
        return segments_intersect_3d(p, q, a, b) || segments_intersect_3d(p, q, b, c)
            || segments_intersect_3d(p, q, c, a);
    const Vec2d p2 = drop_axis(p, axis);
    const Vec2d q2 = drop_axis(q, axis);
    const Vec2d a2 = drop_axis(a, axis);
    const Vec2d b2 = drop_axis(b, axis);
    const Vec2d c2 = drop_axis(c, axis);
    return point_on_triangle_2d(p2, a2, b2, c2) || segments_intersect_2d(p2, q2, a2, b2)
        || segments_intersect_2d(p2, q2, b2, c2) || segments_intersect_2d(p2, q2, c2, a2);
}

}  // namespace detail

/// Closed segment pq and closed triangle abc have a common point; each may be degenerate.
NOLI_HD inline bool segment_intersects_triangle(
    const Vec3d& p, const Vec3d& q, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const int p_side = orient3d_sign(a, b, c, p);
    const int q_side = orient3d_sign(a, b, c, q);
    if (p_side * q_side > 0) return false;
    if (p_side == 0 && q_side == 0)
        return detail::flat_segment_intersects_triangle(p, q, a, b, c);
    // The line pq meets the plane in one point, which lies on the segment; is it in the
    // triangle?
    const int ab = orient3d_sign(p, q, a, b);
    const int bc = orient3d_sign(p, q, b, c);
    const int ca = orient3d_sign(p, q, c, a);
    const bool any_plus = ab > 0 || bc > 0 || ca > 0;
    const bool any_minus = ab < 0 || bc < 0 || ca < 0;
    return !(any_plus && any_minus);
}

/// Which side of the plane { y : normal . y = offset } the point is on, as the sign of
/// normal . p - offset for the given doubles; the normal need not be of unit length.
NOLI_HD inline int plane_side(const Vec3d& p, const Vec3d& normal, double offset) {
    using detail::make_expansion;
    using detail::two_prod;
    const double terms[4] = {normal.x * p.x, normal.y * p.y, normal.z * p.z, -offset};
    const double rough = terms[0] + terms[1] + terms[2] + terms[3];
    double size = 0.0;
    for (const double term : terms)
        size += std::fabs(term);
    if (std::fabs(rough) > 8.0 * detail::kUnitRoundoff * size)
        return rough > 0.0 ? 1 : -1;
    const auto xy = sum(make_expansion(two_prod(normal.x, p.x)),
                        make_expansion(two_prod(normal.y, p.y)));
    const auto zo = sum(make_expansion(two_prod(normal.z, p.z)),
                        make_expansion(detail::TwoTerms{-offset, 0.0}));
    const auto all = sum(xy, zo);
    if (all.size == 0) return 0;
    return all.term[all.size - 1] > 0.0 ? 1 : -1;
}

}  // namespace noli
