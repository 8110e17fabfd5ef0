// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How far a tetrahedron may move before it keeps too little of its volume.
///
/// With A = [x_i - x_0], P = [p_i - p_0], six times the volume is f(t) = det(A + t P), a
/// cubic. The bound is the first time at which  g(t) = f(t) / f(0) - keep  could be 0.
///
/// Method: on [lo, lo + w] write g in Bernstein form; g stays above the hull of its four
/// coefficients. If all are positive the interval is safe, else the hull's first zero is,
/// and lo moves there. No root can be missed, whatever the leading coefficients: there is
/// no division by them. Every coefficient is lowered by a bound on the rounding of the
/// determinants.
///
/// Source: MATH 8.6 (keep = rho), normalised by f(0) instead of its absolute tolerance.

#include "core/stencil.hpp"
#include "geometry/predicates.hpp"

#include <cmath>

namespace noli {

namespace detail {

/// g(t) = c[0] + c[1] t + c[2] t^2 + c[3] t^3, and sizes that bound its rounding error.
struct VolumeCubic {
    double c[4];
    double a_size[3], p_size[3];  ///< 1-norms of the columns of A and P
    double scale;  ///< rounding of f / f(0) per unit product of column sizes
};

NOLI_HD inline double triple(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    return dot(cross(a, b), c);
}

/// False if the tetrahedron has no positive, finite volume.
NOLI_HD inline bool make_volume_cubic(const Stencil<4>& x,
                                      const Stencil<4>& p,
                                      double keep,
                                      VolumeCubic& out) {
    Vec3d a[3];
    Vec3d q[3];
    for (int i = 0; i < 3; ++i) {
        a[i] = x.x[i + 1] - x.x[0];
        q[i] = p.x[i + 1] - p.x[0];
        out.a_size[i] = size_1(a[i]);
        out.p_size[i] = size_1(q[i]);
    }
    const double volume = orient3d_value(x.x[0], x.x[1], x.x[2], x.x[3]);
    if (!(volume > 0.0) || !(volume < INFINITY)) return false;
    const double inverse = 1.0 / volume;
    out.c[0] = 1.0 - keep;
    out.c[1] = inverse
             * (triple(q[0], a[1], a[2]) + triple(a[0], q[1], a[2])
                + triple(a[0], a[1], q[2]));
    out.c[2] = inverse
             * (triple(a[0], q[1], q[2]) + triple(q[0], a[1], q[2])
                + triple(q[0], q[1], a[2]));
    out.c[3] = inverse * triple(q[0], q[1], q[2]);
    out.scale = 32.0 * kUnitRoundoff * inverse;
    return true;
}

/// Bound on the rounding of g over [0, t].
NOLI_HD inline double rounding_bound(const VolumeCubic& g, double t) {
    double change = g.scale;
    double still = g.scale;
    for (int i = 0; i < 3; ++i) {
        change *= g.a_size[i] + t * g.p_size[i];
        still *= g.a_size[i];
    }
    // f(0) itself is exact to 1e-10; only the change since t = 0 carries determinant
    // rounding.
    return (change > still ? change - still : 0.0) + 1e-15;
}

/// Largest part s of [lo, lo + w] (s in [0, 1]) on which the hull of g's Bernstein
/// coefficients is >= 0.
NOLI_HD inline double safe_part(const VolumeCubic& g, double lo, double w) {
    const double* c = g.c;
    const double value = c[0] + lo * (c[1] + lo * (c[2] + lo * c[3]));
    const double d1 = w * (c[1] + lo * (2.0 * c[2] + lo * 3.0 * c[3]));
    const double d2 = w * w * (c[2] + lo * 3.0 * c[3]);
    const double d3 = w * w * w * c[3];
    const double b0 = value - rounding_bound(g, lo + w);
    const double b[4] = {
        b0, b0 + d1 / 3.0, b0 + (2.0 * d1 + d2) / 3.0, b0 + d1 + d2 + d3};
    if (!(b[0] > 0.0)) return 0.0;
    double first = 1.0;
    for (int j = 1; j < 4; ++j) {
        if (b[j] >= 0.0) continue;
        for (int i = 0; i < j; ++i) {
            if (b[i] < 0.0) continue;
            const double crossing = (i + (j - i) * (b[i] / (b[i] - b[j]))) / 3.0;
            if (crossing < first) first = crossing;
        }
    }
    return first;
}

/// Determinant of three columns.
template <class T>
NOLI_HD inline T determinant(const Vec3<T>& a, const Vec3<T>& b, const Vec3<T>& c) {
    return dot(cross(a, b), c);
}

template <class T>
NOLI_HD inline T size_1_of(const Vec3<T>& a) {
    using std::fabs;
    return fabs(a.x) + fabs(a.y) + fabs(a.z);
}

}  // namespace detail

/// Whether inversion_bound is 1 beyond doubt: a mask over lanes, or a bool. True for all
/// but the tetrahedra that lose much of their volume, at a fraction of the price.
///
/// The four Bernstein coefficients on [0, 1] of  f(t) - keep f(0), in the notation of the
/// file's head, must exceed 1e-12 of the product of the columns' sizes, which bound every
/// intermediate value: some hundred times what rounding here and in inversion_bound can
/// change. NaN and overflow give false.
///
/// In:   x, p  (4) vertices, m, and their motions
template <class T>
NOLI_HD inline auto surely_keeps_volume(const Vec3<T> (&x)[4],
                                        const Vec3<T> (&p)[4],
                                        double keep) {
    using detail::determinant;
    Vec3<T> a[3];
    Vec3<T> q[3];
    T size(1e-12);
    for (int i = 0; i < 3; ++i) {
        a[i] = x[i + 1] - x[0];
        q[i] = p[i + 1] - p[0];
        size *= detail::size_1_of(a[i]) + detail::size_1_of(q[i]);
    }
    const T volume = determinant(a[0], a[1], a[2]);
    const T d1 = determinant(q[0], a[1], a[2]) + determinant(a[0], q[1], a[2])
               + determinant(a[0], a[1], q[2]);
    const T d2 = determinant(a[0], q[1], q[2]) + determinant(q[0], a[1], q[2])
               + determinant(q[0], q[1], a[2]);
    const T d3 = determinant(q[0], q[1], q[2]);
    const T b0 = T(1.0 - keep) * volume;
    const T third(1.0 / 3.0);
    return (b0 > size) & (b0 + third * d1 > size) & (b0 + third * (d1 + d1 + d2) > size)
         & (b0 + d1 + d2 + d3 > size);
}

/// Largest t found in (0, 1] such that the signed volume of the tetrahedron x (positive
/// when (x1-x0) x (x2-x0) points to x3) stays >= keep times its initial value at every
/// time in [0, t], the points moving by t * p. keep in [0, 1). Within 1e-6 relative of
/// the exact bound unless rounding forbids. 0 only if the initial volume is not positive,
/// or its changes are lost in rounding, or the input is not finite. Invariant to scale
/// and to translation.
NOLI_HD inline double inversion_bound(const Stencil<4>& x,
                                      const Stencil<4>& p,
                                      double keep) {
    constexpr int kMaxIterations = 200;
    constexpr double kTolerance = 1e-6;
    detail::VolumeCubic g;
    if (!detail::make_volume_cubic(x, p, keep, g)) return 0.0;
    double lo = 0.0;
    double w = 1.0;
    for (int k = 0; k < kMaxIterations; ++k) {
        const double part = detail::safe_part(g, lo, w);
        if (part >= 1.0) {
            lo += w;
            if (lo >= 1.0) return 1.0;
            w *= 2.0;
        } else {
            lo += part * w;
            w *= 0.5;
        }
        if (w > 1.0 - lo) w = 1.0 - lo;
        if (w <= kTolerance * lo) break;
    }
    return lo;
}

}  // namespace noli
