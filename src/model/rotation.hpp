// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Vectors and rotations of a scene as those of the model.

#include "noli/scene.hpp"

#include "core/vec.hpp"

#include <cmath>
#include <numbers>

namespace noli {

inline Vec3d to_vec3(const Vector3& v) {
    return {v[0], v[1], v[2]};
}

/// Rx(d.x) Ry(d.y) Rz(d.z), angles in degrees: Rz acts first.
inline Mat3d rotation_from_degrees(const Vec3d& d) {
    constexpr double kRadians = std::numbers::pi / 180.0;
    const double cx = std::cos(kRadians * d.x), sx = std::sin(kRadians * d.x);
    const double cy = std::cos(kRadians * d.y), sy = std::sin(kRadians * d.y);
    const double cz = std::cos(kRadians * d.z), sz = std::sin(kRadians * d.z);
    const Mat3d rx{1, 0, 0, 0, cx, -sx, 0, sx, cx};
    const Mat3d ry{cy, 0, sy, 0, 1, 0, -sy, 0, cy};
    const Mat3d rz{cz, -sz, 0, sz, cz, 0, 0, 0, 1};
    return rx * (ry * rz);
}

}  // namespace noli
