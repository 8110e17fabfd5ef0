// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Axis-aligned boxes, closed on all sides.

#include "core/stencil.hpp"

#include <cmath>

namespace noli {

/// Points with lo <= x <= hi in every coordinate, m.
struct Aabb {
    Vec3d lo, hi;
};

namespace detail {

// Plain comparisons: fmin and fmax are library calls where NaN must be honoured.
NOLI_HD inline double lesser(double a, double b) {
    return b < a ? b : a;
}
NOLI_HD inline double greater(double a, double b) {
    return a < b ? b : a;
}
NOLI_HD inline Vec3d min_of(const Vec3d& a, const Vec3d& b) {
    return {lesser(a.x, b.x), lesser(a.y, b.y), lesser(a.z, b.z)};
}
NOLI_HD inline Vec3d max_of(const Vec3d& a, const Vec3d& b) {
    return {greater(a.x, b.x), greater(a.y, b.y), greater(a.z, b.z)};
}

}  // namespace detail

/// The box without points: merging it with a box gives that box.
NOLI_HD inline Aabb empty_aabb() {
    return {{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
}

NOLI_HD inline bool is_empty(const Aabb& box) {
    return box.lo.x > box.hi.x || box.lo.y > box.hi.y || box.lo.z > box.hi.z;
}

NOLI_HD inline Aabb aabb_of_point(const Vec3d& x) {
    return {x, x};
}

NOLI_HD inline Aabb merged(const Aabb& a, const Aabb& b) {
    return {detail::min_of(a.lo, b.lo), detail::max_of(a.hi, b.hi)};
}

NOLI_HD inline Aabb merged(const Aabb& a, const Vec3d& x) {
    return {detail::min_of(a.lo, x), detail::max_of(a.hi, x)};
}

/// Box of the S points.
template <int S>
NOLI_HD inline Aabb aabb_of_points(const Stencil<S>& s) {
    Aabb box = aabb_of_point(s.x[0]);
    for (int i = 1; i < S; ++i)
        box = merged(box, s.x[i]);
    return box;
}

/// Box of the S points at every time in [0, t], moving by t * p (p: displacement per unit
/// time, m).
template <int S>
NOLI_HD inline Aabb aabb_of_swept_points(const Stencil<S>& x,
                                         const Stencil<S>& p,
                                         double t) {
    Aabb box = aabb_of_points(x);
    for (int i = 0; i < S; ++i)
        box = merged(box, x.x[i] + t * p.x[i]);
    return box;
}

/// Box grown by `margin` (m, >= 0) on every side.
NOLI_HD inline Aabb inflated(const Aabb& box, double margin) {
    const Vec3d m = {margin, margin, margin};
    return {box.lo - m, box.hi + m};
}

/// The closed boxes have a common point.
NOLI_HD inline bool overlap(const Aabb& a, const Aabb& b) {
    return a.lo.x <= b.hi.x && b.lo.x <= a.hi.x && a.lo.y <= b.hi.y && b.lo.y <= a.hi.y
        && a.lo.z <= b.hi.z && b.lo.z <= a.hi.z;
}

/// Squared distance of two non-empty boxes, m^2; 0 if they overlap.
NOLI_HD inline double distance_sq(const Aabb& a, const Aabb& b) {
    const Vec3d apart =
        detail::max_of(detail::max_of(b.lo - a.hi, a.lo - b.hi), {0.0, 0.0, 0.0});
    return norm_sq(apart);
}

NOLI_HD inline Vec3d center(const Aabb& box) {
    return 0.5 * (box.lo + box.hi);
}

}  // namespace noli
