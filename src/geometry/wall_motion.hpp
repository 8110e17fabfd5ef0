// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How far a vertex may move along a line before too much of its distance to a wall is
/// used up; see ccd.hpp for the target and for what rounding is.

#include "geometry/ccd.hpp"
#include "geometry/wall.hpp"

#include <cmath>

namespace noli {

/// A vertex at `distance` (m) above a plane, moving by t * normal_speed (m) along its
/// normal: largest t in [0, t_max] after which (1 - slack) of the distance is left.
/// Source: MATH 6.
NOLI_HD inline Advance advance_half_space(double distance,
                                          double normal_speed,
                                          double slack,
                                          double t_max = 1.0) {
    if (!(distance < INFINITY) || !(std::fabs(normal_speed) < INFINITY))
        return {0.0, 0, false, AdvanceEnd::NotFinite};
    if (!(distance > 0.0)) return {0.0, 0, false, AdvanceEnd::InitiallyClosed};
    const double usable = slack * distance * (1.0 - 8.0 * detail::kUnitRoundoff);
    if (!(-normal_speed * t_max > usable)) return {t_max, 0, false, AdvanceEnd::Free};
    const double t = usable / -normal_speed;
    return {t, 0, false, t > 0.0 ? AdvanceEnd::GapUsed : AdvanceEnd::BelowRounding};
}

namespace detail {

/// Largest t with |y + t q| <= |y| + usable, usable >= 0: the larger root of
///
///     |q|^2 t^2 + 2 (y . q) t - usable (2 |y| + usable) = 0,
///
/// by the one of its two forms in which nothing cancels. Infinite for q = 0.
NOLI_HD inline double time_to_radius(const Vec3d& y, const Vec3d& q, double usable) {
    const double a = norm_sq(q);
    const double b = dot(y, q);
    const double c = usable * (2.0 * norm(y) + usable);
    const double root = std::sqrt(b * b + a * c);
    return b > 0.0 ? c / (b + root) : (root - b) / a;
}

/// A vertex inside of a sphere or cylinder. The bound on rounding holds for coordinates
/// that stay within the wall's size; along a cylinder's axis they may not, so the time is
/// found without and then with what the way there takes away.
NOLI_HD inline Advance advance_inside(const Wall& wall,
                                      const Vec3d& x,
                                      const Vec3d& p,
                                      double t_max,
                                      const AdvanceParams& params) {
    const Vec3d y = across_axis(wall, x - wall.center);
    const Vec3d q = across_axis(wall, p);
    const double r = norm(y);
    const double gap = wall.radius - r - params.min_separation;
    if (!(std::fabs(gap) < INFINITY) || !(norm_sq(p) < INFINITY))
        return {0.0, 0, false, AdvanceEnd::NotFinite};
    if (!(gap > 0.0)) return {0.0, 0, false, AdvanceEnd::InitiallyClosed};
    if (norm(y + t_max * q) <= r) return {t_max, 0, false, AdvanceEnd::Free};

    const double size = size_1(x) + size_1(wall.center) + wall.radius;
    double usable = params.slack * gap - 32.0 * kUnitRoundoff * size;
    if (!(usable > 0.0)) return {0.0, 0, false, AdvanceEnd::BelowRounding};
    const double first = std::fmin(time_to_radius(y, q, usable), t_max);
    usable -= 32.0 * kUnitRoundoff * first * size_1(p);
    if (!(usable > 0.0)) return {0.0, 0, false, AdvanceEnd::BelowRounding};
    const double t = time_to_radius(y, q, usable) * (1.0 - 8.0 * kUnitRoundoff);
    if (t >= t_max) return {t_max, 0, false, AdvanceEnd::Free};
    return {t, 0, false, t > 0.0 ? AdvanceEnd::GapUsed : AdvanceEnd::BelowRounding};
}

}  // namespace detail

/// A vertex that moves to x + t p: largest t in [0, t_max] after which (1 -
/// params.slack) of its distance to the wall above params.min_separation is left, at any
/// time up to t. Source: MATH 6; the walls' convexity.
NOLI_HD inline Advance advance_wall(const Wall& wall,
                                    const Vec3d& x,
                                    const Vec3d& p,
                                    double t_max,
                                    const AdvanceParams& params) {
    if (wall.shape != WallShape::HalfSpace)
        return detail::advance_inside(wall, x, p, t_max, params);
    return advance_half_space(wall_distance(wall, x) - params.min_separation,
                              dot(wall.normal, p),
                              params.slack,
                              t_max);
}

}  // namespace noli
