// SPDX-License-Identifier: Apache-2.0
#include "linear/inverse_factor.hpp"

#include <cmath>

namespace noli {

bool invert_factor(const Mat3d& m, InverseFactor& out) {
    const double largest = std::fmax(m.a[0], std::fmax(m.a[4], m.a[8]));
    out = {};
    if (largest <= 0.0) return m.a[0] == 0.0 && m.a[4] == 0.0 && m.a[8] == 0.0;
    const double rounding = 1e-14 * largest;
    bool positive = true;
    const auto root = [&](double pivot) {
        positive = positive && pivot > -100.0 * rounding;
        return std::sqrt(std::fmax(pivot, rounding));
    };
    const double c00 = root(m.a[0]);
    const double c10 = m.a[3] / c00;
    const double c20 = m.a[6] / c00;
    const double c11 = root(m.a[4] - c10 * c10);
    const double c21 = (m.a[7] - c20 * c10) / c11;
    const double c22 = root(m.a[8] - c20 * c20 - c21 * c21);
    out.c0[0] = 1.0 / c00;
    out.c1[1] = 1.0 / c11;
    out.c2[2] = 1.0 / c22;
    out.c0[1] = -c10 * out.c0[0] * out.c1[1];
    out.c1[2] = -c21 * out.c1[1] * out.c2[2];
    out.c0[2] = -(c20 * out.c0[0] + c21 * out.c0[1]) * out.c2[2];
    return positive;
}

}  // namespace noli
