// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Orthonormal bases of the plane across a contact normal.

#include "core/vec.hpp"
#include "geometry/pair_geometry.hpp"

namespace noli::detail {

struct Tangents {
    Vec3d t0, t1;  ///< orthonormal, perpendicular to n
};

/// Basis of the plane across n whose first vector follows `hint` as far as it can.
/// Without a usable hint (zero, or along n) it starts from the better of e_x x n and e_y
/// x n.
NOLI_HD inline Tangents tangents_across(const Vec3d& n, const Vec3d& hint) {
    Vec3d t = hint - dot(hint, n) * n;
    if (!(norm_sq(t) > 1e-16 * norm_sq(hint))) {
        const Vec3d from_x = cross(Vec3d{1.0, 0.0, 0.0}, n);
        const Vec3d from_y = cross(Vec3d{0.0, 1.0, 0.0}, n);
        t = norm_sq(from_x) > norm_sq(from_y) ? from_x : from_y;
    }
    t = unit_or_zero(t);
    Tangents out;
    out.t0 = unit_or_zero(t - dot(t, n) * n);
    out.t1 = cross(n, out.t0);
    return out;
}

}  // namespace noli::detail
