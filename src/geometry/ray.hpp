// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How a ray goes through the triangles of a closed surface: which way, or that it cannot
/// be said because it meets an edge.

#include "geometry/predicates.hpp"

namespace noli {

/// What a ray from p along +x says of one triangle.
struct RayCrossing {
    int turns;      ///< 1: leaves the surface here, -1: enters it, 0: passes by
    bool is_clear;  ///< false: it meets the triangle's plane edge on, or its border
};

/// Crossing of the ray p + t (1, 0, 0), t > 0, and triangle a b c, whose outside is where
/// (b - a) x (c - a) points. Summed over a closed surface: how often the surface goes
/// round p (its winding number), 1 inside and 0 outside of a solid.
///
/// In:      p, a, b, c  m
/// Valid:   exact while every non-zero coordinate lies in [2^-300, 2^300]
NOLI_HD inline RayCrossing cross_ray(const Vec3d& p,
                                     const Vec3d& a,
                                     const Vec3d& b,
                                     const Vec3d& c) {
    const auto beyond = [](double q, double r, double s, double t) {
        return (r < q && s < q && t < q) || (r > q && s > q && t > q);
    };
    if (beyond(p.y, a.y, b.y, c.y) || beyond(p.z, a.z, b.z, c.z)) return {0, true};
    if (a.x < p.x && b.x < p.x && c.x < p.x) return {0, true};
    const auto flat = [](const Vec3d& q) { return Vec2d{q.y, q.z}; };
    const int ab = orient2d_sign(flat(a), flat(b), flat(p));
    const int bc = orient2d_sign(flat(b), flat(c), flat(p));
    const int ca = orient2d_sign(flat(c), flat(a), flat(p));
    if ((ab > 0 || bc > 0 || ca > 0) && (ab < 0 || bc < 0 || ca < 0)) return {0, true};
    if (ab == 0 || bc == 0 || ca == 0) return {0, false};
    const int side = orient3d_sign(a, b, c, p);
    return {side * ab < 0 ? ab : 0, side != 0};
}

}  // namespace noli
