// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Orientation predicates and cross products that are right even when doubles cancel.
///
/// Each is computed in double first, together with a bound on its own error; only where
/// that bound does not suffice is it computed again with expansions, without error. The
/// values take that second stage from their caller (geometry/stages.hpp); the signs are
/// always exact.
///
/// The bounds, with u = 2^-53: a product of k coordinate differences inside such a
/// determinant passes through r roundings (its k differences, its k-1 products, the sums
/// above it), so it is off by at most ((1+u)^r - 1) of its magnitude. Summed over all
/// products this is at most (r + 1) u P for the computed sum P of their magnitudes: P
/// itself is off by the same relative amount, and r u < 1e-15. One more u for safety.
///   orient2d and one cross component: r = 2 + 1 + 1 = 4        (kCrossError  = 6 u)
///   orient3d:                         r = 3 + 2 + 1 + 2 = 8    (kOrient3dError = 10 u)
/// Exact while every non-zero coordinate lies in [2^-300, 2^300].

#include "core/vec.hpp"
#include "geometry/expansion.hpp"
#include "geometry/stages.hpp"

#include <cmath>

namespace noli {

namespace detail {

inline constexpr double kUnitRoundoff = 0x1p-53;
inline constexpr double kCrossError = 6.0 * kUnitRoundoff;
inline constexpr double kOrient3dError = 10.0 * kUnitRoundoff;

/// Relative error allowed in values (not signs) before they are computed exactly.
inline constexpr double kValueTolerance = 1e-10;

/// 1-norm.
NOLI_HD inline double size_1(const Vec3d& a) {
    return std::fabs(a.x) + std::fabs(a.y) + std::fabs(a.z);
}

NOLI_HD inline int sign_of(double value) {
    return (value > 0.0) - (value < 0.0);
}

// The exact stages are rare and large: kept out of line, they cost their callers one
// call.

struct ExactVec3 {
    Expansion<2> x, y, z;
};

NOLI_HD inline ExactVec3 exact_difference(const Vec3d& to, const Vec3d& from) {
    return {make_expansion(two_diff(to.x, from.x)),
            make_expansion(two_diff(to.y, from.y)),
            make_expansion(two_diff(to.z, from.z))};
}

[[gnu::noinline]] NOLI_HD inline double orient3d_exact(const Vec3d& a,
                                                       const Vec3d& b,
                                                       const Vec3d& c,
                                                       const Vec3d& d) {
    const ExactVec3 u = exact_difference(b, a);
    const ExactVec3 v = exact_difference(c, a);
    const ExactVec3 w = exact_difference(d, a);
    const Expansion<64> along_x = product(det2_exact(u.y, u.z, v.y, v.z), w.x);
    const Expansion<64> along_y = product(det2_exact(u.z, u.x, v.z, v.x), w.y);
    const Expansion<64> along_z = product(det2_exact(u.x, u.y, v.x, v.y), w.z);
    return rounded(sum(sum(along_x, along_y), along_z));
}

[[gnu::noinline]] NOLI_HD inline double orient2d_exact(const Vec2d& a,
                                                       const Vec2d& b,
                                                       const Vec2d& c) {
    return det2_rounded(make_expansion(two_diff(b.x, a.x)),
                        make_expansion(two_diff(b.y, a.y)),
                        make_expansion(two_diff(c.x, a.x)),
                        make_expansion(two_diff(c.y, a.y)));
}

/// det [b-a, c-a, d-a]; second stage where the error may exceed `tolerance` times the
/// value.
template <class Stage>
NOLI_HD inline double orient3d_filtered(const Vec3d& a,
                                        const Vec3d& b,
                                        const Vec3d& c,
                                        const Vec3d& d,
                                        double tolerance,
                                        Stage&& stage) {
    const Vec3d u = b - a;
    const Vec3d v = c - a;
    const Vec3d w = d - a;
    const Vec3d plus = {u.y * v.z, u.z * v.x, u.x * v.y};
    const Vec3d minus = {u.z * v.y, u.x * v.z, u.y * v.x};
    const double det = dot(plus - minus, w);
    const double magnitude = (std::fabs(plus.x) + std::fabs(minus.x)) * std::fabs(w.x)
                           + (std::fabs(plus.y) + std::fabs(minus.y)) * std::fabs(w.y)
                           + (std::fabs(plus.z) + std::fabs(minus.z)) * std::fabs(w.z);
    if (kOrient3dError * magnitude <= tolerance * std::fabs(det)) return det;
    return stage.refined(det, [&] { return orient3d_exact(a, b, c, d); });
}

[[gnu::noinline]] NOLI_HD inline Vec3d cross_exact(const Vec3d& a,
                                                   const Vec3d& b,
                                                   const Vec3d& c,
                                                   const Vec3d& d) {
    const ExactVec3 u = exact_difference(b, a);
    const ExactVec3 v = exact_difference(d, c);
    return {det2_rounded(u.y, u.z, v.y, v.z),
            det2_rounded(u.z, u.x, v.z, v.x),
            det2_rounded(u.x, u.y, v.x, v.y)};
}

}  // namespace detail

/// Sign (-1, 0, 1) of det [b-a, c-a], exact: 1 when a, b, c turn left.
NOLI_HD inline int orient2d_sign(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
    const double plus = (b.x - a.x) * (c.y - a.y);
    const double minus = (b.y - a.y) * (c.x - a.x);
    const double det = plus - minus;
    const double error = detail::kCrossError * (std::fabs(plus) + std::fabs(minus));
    if (error <= 0.5 * std::fabs(det)) return detail::sign_of(det);
    return detail::sign_of(detail::orient2d_exact(a, b, c));
}

/// Sign (-1, 0, 1) of det [b-a, c-a, d-a], exact: 1 when d lies on the side of (b-a) x
/// (c-a).
NOLI_HD inline int orient3d_sign(const Vec3d& a,
                                 const Vec3d& b,
                                 const Vec3d& c,
                                 const Vec3d& d) {
    return detail::sign_of(detail::orient3d_filtered(a, b, c, d, 0.5, Exactly{}));
}

/// det [b-a, c-a, d-a] in m^3, to a relative error of 1e-10 however much it cancels; 0
/// only if it is 0.
template <class Stage = Exactly>
NOLI_HD inline double orient3d_value(
    const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d, Stage&& stage = {}) {
    return detail::orient3d_filtered(a, b, c, d, detail::kValueTolerance, stage);
}

/// (b - a) x (d - c) in m^2, to 2e-10 of its norm however parallel the two are; 0 only if
/// it is 0.
template <class Stage = Exactly>
NOLI_HD inline Vec3d cross_of_edges(
    const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d, Stage&& stage = {}) {
    const Vec3d u = b - a;
    const Vec3d v = d - c;
    const Vec3d plus = {u.y * v.z, u.z * v.x, u.x * v.y};
    const Vec3d minus = {u.z * v.y, u.x * v.z, u.y * v.x};
    const Vec3d out = plus - minus;
    const double magnitude = detail::size_1(plus) + detail::size_1(minus);
    if (detail::kCrossError * magnitude <= detail::kValueTolerance * detail::size_1(out))
        return out;
    return stage.refined(out, [&] { return detail::cross_exact(a, b, c, d); });
}

}  // namespace noli
