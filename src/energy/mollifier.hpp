// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The factor that fades out the barrier of two nearly parallel edges, whose distance is
/// not smooth there.

#include "core/stencil.hpp"

namespace noli {

/// m, dm/dgamma and d2m/dgamma2; units 1, m^-4, m^-8.
struct MollifierJet {
    double value, d1, d2;
};

/// Edge-edge mollifier of gamma = ||u x v||^2 (squared area spanned by the two edges).
///
///     m(gamma) = 2 gamma / eps - gamma^2 / eps^2   for gamma < eps,   1 otherwise
///
/// Source:  MATH 3.1, [Li2020]
/// In:      gamma      m^4; >= 0 (edge_cross_sq)
///          eps_cross  edge_edge_threshold, m^4; >= 0, and 0 means never mollified
/// Smooth:  C1 at gamma == eps_cross
NOLI_HD inline MollifierJet mollifier(double gamma, double eps_cross) {
    if (gamma >= eps_cross) return {1.0, 0.0, 0.0};
    const double ratio = gamma / eps_cross;
    return {ratio * (2.0 - ratio),
            2.0 * (1.0 - ratio) / eps_cross,
            -2.0 / (eps_cross * eps_cross)};
}

/// Rest threshold 1e-3 ||ea||^2 ||eb||^2 of a pair of edges with rest vectors ea, eb;
/// m^4. A pair is mollified iff its gamma lies below this. Source: MATH 3.1.
NOLI_HD inline double edge_edge_threshold(const Vec3d& rest_a, const Vec3d& rest_b) {
    return 1e-3 * norm_sq(rest_a) * norm_sq(rest_b);
}

namespace detail {

/// K^T p: the 12-vector of derivatives of p . (u x v).
NOLI_HD inline StencilGradient<4> cross_product_pullback(const Vec3d& u,
                                                         const Vec3d& v,
                                                         const Vec3d& p) {
    const Vec3d du = cross(v, p);
    const Vec3d dv = cross(p, u);
    return {{-du, du, -dv, dv}};
}

}  // namespace detail

}  // namespace noli
