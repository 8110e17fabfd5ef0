// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Walls: the regions that whole bodies are to stay in, each given by a formula. A
/// half-space {x : n . x > o}, the inside of a sphere |x - c| < R, the inside of an
/// infinite cylinder |(I - a a^T)(x - c)| < R about an axis of direction a.
///
/// All three are convex. So a body is in a wall's region when its surface vertices are,
/// and a vertex stays in it on a straight way when both ends are in it.

#include "core/device.hpp"
#include "core/vec.hpp"

#include <cmath>
#include <cstdint>

namespace noli {

enum class WallShape : std::uint8_t { HalfSpace, Sphere, Cylinder };

/// What is free is the side `normal` points to, or the inside.
struct Wall {
    Vec3d normal;         ///< unit; half-space: into the free side; cylinder: the axis
    double offset = 0.0;  ///< m; half-space: its plane is normal . x = offset
    WallShape shape = WallShape::HalfSpace;
    Vec3d center{};       ///< m; sphere: its centre; cylinder: a point of its axis
    double radius = 0.0;  ///< m; sphere and cylinder
};

/// Number of directions in which the wall curves: modes that its Hessian has besides the
/// one along the normal.
NOLI_HD inline int num_curved_directions(WallShape shape) {
    if (shape == WallShape::HalfSpace) return 0;
    return shape == WallShape::Sphere ? 2 : 1;
}

/// The part of a displacement from a curved wall's centre that takes to the wall: all of
/// it for a sphere, what is across the axis for a cylinder.
NOLI_HD inline Vec3d across_axis(const Wall& wall, const Vec3d& from_center) {
    if (wall.shape != WallShape::Cylinder) return from_center;
    return from_center - dot(wall.normal, from_center) * wall.normal;
}

/// Signed distance, m; positive where it is free.
NOLI_HD inline double wall_distance(const Wall& wall, const Vec3d& x) {
    if (wall.shape == WallShape::HalfSpace) return dot(wall.normal, x) - wall.offset;
    return wall.radius - norm(across_axis(wall, x - wall.center));
}

/// Gradient of the distance: unit, into what is free. Zero in the centre or on the axis
/// of a curved wall, where there is none.
NOLI_HD inline Vec3d wall_normal(const Wall& wall, const Vec3d& x) {
    if (wall.shape == WallShape::HalfSpace) return wall.normal;
    const Vec3d outward = across_axis(wall, x - wall.center);
    const double r = norm(outward);
    return r > 0.0 ? (-1.0 / r) * outward : Vec3d{0.0, 0.0, 0.0};
}

}  // namespace noli
