// SPDX-License-Identifier: Apache-2.0
#include "scene/affine.hpp"

#include <cmath>
#include <numbers>

namespace noli {

CosSin cos_sin_deg(double degrees) {
    const double quarters = degrees / 90.0;
    if (quarters == std::floor(quarters)) {
        constexpr CosSin kQuarters[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
        const double turn = std::fmod(quarters, 4.0);
        return kQuarters[static_cast<int>(turn < 0 ? turn + 4.0 : turn)];
    }
    const double radians = degrees * (std::numbers::pi / 180.0);
    return {std::cos(radians), std::sin(radians)};
}

Affine compose(const Affine& a, const Affine& b) {
    Affine c;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 4; ++j)
            c.rows[i][j] = a.rows[i][0] * b.rows[0][j] + a.rows[i][1] * b.rows[1][j]
                         + a.rows[i][2] * b.rows[2][j] + (j == 3 ? a.rows[i][3] : 0.0);
    return c;
}

Affine make_rotation(const Vector3& rotation_deg) {
    const auto [cx, sx] = cos_sin_deg(rotation_deg[0]);
    const auto [cy, sy] = cos_sin_deg(rotation_deg[1]);
    const auto [cz, sz] = cos_sin_deg(rotation_deg[2]);
    const Affine x{{{{1, 0, 0, 0}, {0, cx, -sx, 0}, {0, sx, cx, 0}}}};
    const Affine y{{{{cy, 0, sy, 0}, {0, 1, 0, 0}, {-sy, 0, cy, 0}}}};
    const Affine z{{{{cz, -sz, 0, 0}, {sz, cz, 0, 0}, {0, 0, 1, 0}}}};
    return compose(x, compose(y, z));
}

Affine make_rotation(const Vector3& axis, double degrees) {
    const double length = std::hypot(axis[0], axis[1], axis[2]);
    const double x = axis[0] / length;
    const double y = axis[1] / length;
    const double z = axis[2] / length;
    const auto [c, s] = cos_sin_deg(degrees);
    const double d = 1.0 - c;
    return Affine{{{{c + d * x * x, d * x * y - s * z, d * x * z + s * y, 0},
                    {d * x * y + s * z, c + d * y * y, d * y * z - s * x, 0},
                    {d * x * z - s * y, d * y * z + s * x, c + d * z * z, 0}}}};
}

Affine make_affine(const Vector3& scale,
                   const Vector3& rotation_deg,
                   const Vector3& translation) {
    Affine a = make_rotation(rotation_deg);
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j)
            a.rows[i][j] *= scale[j];
        a.rows[i][3] = translation[i];
    }
    return a;
}

Affine scaled_and_moved(const Affine& a, double scale, const Vector3& translation) {
    Affine b = a;
    for (std::size_t i = 0; i < 3; ++i) {
        for (double& entry : b.rows[i])
            entry *= scale;
        b.rows[i][3] += translation[i];
    }
    return b;
}

double determinant(const Affine& a) {
    const auto& m = a.rows;
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
         - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
         + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

}  // namespace noli
