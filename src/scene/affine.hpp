// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Placements of bodies: composing them from scale, rotation and translation, and
/// applying them.

#include "noli/scene.hpp"

#include "core/vec.hpp"

namespace noli {

/// cos and sin of an angle in degrees, exact at multiples of 90.
struct CosSin {
    double cos, sin;
};
CosSin cos_sin_deg(double degrees);

/// x -> Rx(r.x) Ry(r.y) Rz(r.z) (s .* x) + t, angles in degrees: Rz acts first.
Affine make_affine(const Vector3& scale,
                   const Vector3& rotation_deg,
                   const Vector3& translation);

/// x -> Rx Ry Rz x.
Affine make_rotation(const Vector3& rotation_deg);

/// x -> R x, R turning by `degrees` about `axis` (need not be unit).
Affine make_rotation(const Vector3& axis, double degrees);

/// x -> a(b(x)).
Affine compose(const Affine& a, const Affine& b);

/// x -> s a(x) + t.
Affine scaled_and_moved(const Affine& a, double scale, const Vector3& translation);

/// Volume factor of the linear part; 0 when it flattens.
double determinant(const Affine& a);

/// Evaluated in the order in which the model places bodies, so that both find the same
/// bits.
inline Vec3d apply_affine(const Affine& m, const Vec3d& p) {
    const auto row = [&](std::size_t i) {
        return m.rows[i][0] * p.x + m.rows[i][1] * p.y + m.rows[i][2] * p.z
             + m.rows[i][3];
    };
    return {row(0), row(1), row(2)};
}

}  // namespace noli
