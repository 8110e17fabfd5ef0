// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Which pairs surely may move all the way, several at a time: plain arithmetic, no
/// branches. What it is not sure of is for ccd.hpp.
///
/// One look, like the first of advance_by_normals: along the direction n from the closest
/// point of one primitive to that of the other, no pair of their points may get nearer
/// than the target. Any n will do, and the length of r, the difference of two points of
/// the primitives, is no less than their distance whichever points they are, so that
/// the target is never too low. A direction spoilt by cancellation costs the answer only.
///
/// Source: MATH 8.5 (target), 9 (candidates of closest points).

#include "core/scalar.hpp"
#include "geometry/ccd.hpp"

namespace noli {

namespace detail {

/// The shortest of the differences that were offered, each between a point of the first
/// primitive and one of the second.
template <class T>
struct ShortestDifference {
    Vec3<T> r;
    T sq;

    NOLI_HD explicit ShortestDifference(const Vec3<T>& first)
        : r(first), sq(norm_sq(first)) {}
    NOLI_HD void offer(const Vec3<T>& other) {
        const T other_sq = norm_sq(other);
        const auto shorter = other_sq < sq;  // false for NaN
        r = select3(shorter, other, r);
        sq = select(shorter, other_sq, sq);
    }
};

/// s in [0, 1], nearest to it; 0 for NaN.
template <class T>
NOLI_HD inline T clamped(const T& s) {
    const T positive = select(s > T(0.0), s, T(0.0));
    return select(positive < T(1.0), positive, T(1.0));
}

/// p minus the nearest point of segment a b.
template <class T>
NOLI_HD inline Vec3<T> from_segment(const Vec3<T>& p,
                                    const Vec3<T>& a,
                                    const Vec3<T>& b) {
    const Vec3<T> e = b - a;
    return (p - a) - clamped(dot(p - a, e) / norm_sq(e)) * e;
}

/// Point x[0] against triangle x[1] x[2] x[3].
template <class T>
NOLI_HD inline ShortestDifference<T> point_triangle_difference(const Vec3<T> (&x)[4]) {
    ShortestDifference<T> out(from_segment(x[0], x[1], x[2]));
    out.offer(from_segment(x[0], x[2], x[3]));
    out.offer(from_segment(x[0], x[3], x[1]));
    const Vec3<T> u = x[2] - x[1];
    const Vec3<T> v = x[3] - x[1];
    const Vec3<T> ap = x[0] - x[1];
    const Vec3<T> n = cross(u, v);
    const T n_sq = norm_sq(n);
    const T b1 = clamped(dot(cross(ap, v), n) / n_sq);
    const T b2 = clamped(dot(cross(u, ap), n) / n_sq);
    const T sum = b1 + b2;
    const T over = select(sum > T(1.0), sum, T(1.0));
    out.offer(ap - (b1 / over) * u - (b2 / over) * v);
    return out;
}

/// Edge x[0] x[1] against edge x[2] x[3].
template <class T>
NOLI_HD inline ShortestDifference<T> edge_edge_difference(const Vec3<T> (&x)[4]) {
    ShortestDifference<T> out(from_segment(x[0], x[2], x[3]));
    out.offer(from_segment(x[1], x[2], x[3]));
    out.offer(-from_segment(x[2], x[0], x[1]));
    out.offer(-from_segment(x[3], x[0], x[1]));
    const Vec3<T> u = x[1] - x[0];
    const Vec3<T> v = x[3] - x[2];
    const Vec3<T> w = x[0] - x[2];
    const Vec3<T> n = cross(u, v);
    const T n_sq = norm_sq(n);
    const T sigma = clamped(dot(cross(v, w), n) / n_sq);
    const T tau = clamped(dot(cross(u, w), n) / n_sq);
    out.offer(w + sigma * u - tau * v);
    return out;
}

/// Largest 1-norm.
template <class T>
NOLI_HD inline T largest_size(const Vec3<T> (&x)[4]) {
    T out(0.0);
    for (const Vec3<T>& a : x) {
        const T size = fabs(a.x) + fabs(a.y) + fabs(a.z);
        out = select(size > out, size, out);
    }
    return out;
}

}  // namespace detail

/// Where true, the pair keeps 1 - params.slack of its distance above
/// params.min_separation along x + t p, t in [0, t_max]. Lanes that are not finite are
/// false.
///
/// In: x, p  points and their motion: point and triangle, or both edges, m
template <PairKind Parent, class T>
NOLI_HD inline auto surely_free(const Vec3<T> (&x)[4],
                                const Vec3<T> (&p)[4],
                                double t_max,
                                const AdvanceParams& params) {
    constexpr bool kPointTriangle = Parent == PairKind::PointTriangle;
    constexpr int kFirst = kPointTriangle ? 1 : 2;
    detail::ShortestDifference<T> shortest = kPointTriangle
                                               ? detail::point_triangle_difference(x)
                                               : detail::edge_edge_difference(x);
    const T d = sqrt(shortest.sq);
    const Vec3<T> n = (T(1.0) / d) * shortest.r;
    // Rounding of r and of the products below, and what storing x + t p takes away.
    const T rounding = T(64.0 * detail::kUnitRoundoff) * detail::largest_size(x);
    const T p_rounding = T(32.0 * detail::kUnitRoundoff) * detail::largest_size(p);
    const T target = d * T(1.0 + detail::kDistanceTolerance)
                   - T(params.slack) * (d - T(params.min_separation)) + rounding
                   + T(t_max) * p_rounding;
    auto free = d > T(params.min_separation);
    for (int i = 0; i < kFirst; ++i) {
        for (int j = kFirst; j < 4; ++j) {
            const T room = dot(x[i] - x[j], n) - target;
            const T closing = dot(p[j] - p[i], n) + p_rounding;
            free = free & (room > T(0.0)) & (room >= T(t_max) * closing);
        }
    }
    return free;
}

}  // namespace noli
