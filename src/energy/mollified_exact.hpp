// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The exact second derivatives of a mollified pair, E = m(gamma) b(D):
///
///     hess E = m'' b grad gamma grad gamma^T + m' b hess gamma
///            + m' b_D (grad gamma grad D^T + grad D grad gamma^T)
///            + m (b_DD grad D grad D^T + b_D hess D),   gamma = |u x v|^2
///
/// in nine coordinates without the pair's translation, where its eigenproblem is smaller
/// than 12 x 12 and has the same positive part. Source: MATH 3.1, 3.4 (hess D as in
/// contact_frame.hpp).

#include "core/stencil.hpp"
#include "energy/barrier.hpp"
#include "energy/contact_frame.hpp"
#include "energy/mollifier.hpp"

namespace noli {
namespace detail {

/// The nine coordinates of a pair without its translation, orthonormal: u / sqrt 2,
/// v / sqrt 2, and half the difference of the edges' vertex sums. Every gradient of the
/// pair lies in them.
struct ContrastVector {
    double z[9];
};

/// 1 / sqrt 2; a function because device code cannot refer to a host constant.
NOLI_HD constexpr double inv_sqrt2() {
    return 0.70710678118654752440;
}

NOLI_HD inline ContrastVector to_contrasts(const Vec3d (&q)[4]) {
    const Vec3d u = inv_sqrt2() * (q[1] - q[0]);
    const Vec3d v = inv_sqrt2() * (q[3] - q[2]);
    const Vec3d gap = 0.5 * (q[0] + q[1] - q[2] - q[3]);
    return {{u.x, u.y, u.z, v.x, v.y, v.z, gap.x, gap.y, gap.z}};
}

NOLI_HD inline void from_contrasts(const double (&z)[9], double scale, Vec3d (&q)[4]) {
    const Vec3d u = (scale * inv_sqrt2()) * Vec3d{z[0], z[1], z[2]};
    const Vec3d v = (scale * inv_sqrt2()) * Vec3d{z[3], z[4], z[5]};
    const Vec3d gap = (0.5 * scale) * Vec3d{z[6], z[7], z[8]};
    q[0] = gap - u;
    q[1] = gap + u;
    q[2] = -gap - v;
    q[3] = v - gap;
}

/// H += coefficient (a b^T + b a^T) / 2.
NOLI_HD inline void add_symmetric(double (&H)[9][9],
                                  double coefficient,
                                  const ContrastVector& a,
                                  const ContrastVector& b) {
    // H in registers would take 162 of them.
    NOLI_ROLLED
    for (int i = 0; i < 9; ++i)
        for (int j = 0; j < 9; ++j)
            H[i][j] += 0.5 * coefficient * (a.z[i] * b.z[j] + b.z[i] * a.z[j]);
}

/// H += coefficient hess gamma, gamma = |u x v|^2:
///     x^T (hess gamma) x = 2 |K x|^2 + 4 k . (du x dv).
NOLI_HD inline void add_gamma_hessian(double (&H)[9][9],
                                      double coefficient,
                                      const Vec3d& u,
                                      const Vec3d& v) {
    for (int axis = 0; axis < 3; ++axis) {
        Vec3d e{0.0, 0.0, 0.0};
        e[axis] = 1.0;
        const StencilGradient<4> row = cross_product_pullback(u, v, e);
        const ContrastVector z = to_contrasts(row.g);
        add_symmetric(H, 2.0 * coefficient, z, z);
    }
    const Vec3d k = cross(u, v);
    const double twist[3][3] = {{0.0, k.z, -k.y}, {-k.z, 0.0, k.x}, {k.y, -k.x, 0.0}};
    // du and dv are sqrt 2 times the first and second triple of contrasts
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            H[i][3 + j] += 4.0 * coefficient * twist[i][j];
            H[3 + j][i] += 4.0 * coefficient * twist[i][j];
        }
    }
}

/// H += coefficient hess D, D the squared distance of the sub-case (contact_frame.hpp).
NOLI_HD inline void add_distance_sq_hessian(double (&H)[9][9],
                                            double coefficient,
                                            const ContactFrame<4>& f) {
    for (int axis = 0; axis < 3; ++axis) {
        Vec3d rows[4];
        for (int j = 0; j < 4; ++j) {
            rows[j] = Vec3d{0.0, 0.0, 0.0};
            rows[j][axis] = f.w[j];
        }
        const ContrastVector z = to_contrasts(rows);
        add_symmetric(H, 2.0 * coefficient, z, z);
    }
    for (int k = 0; k < f.num_tangents; ++k) {
        Vec3d Y[4];
        for (int j = 0; j < 4; ++j)
            Y[j] = (-f.w[j]) * f.t[k] + (f.d * f.v[k][j]) * f.n;
        const ContrastVector z = to_contrasts(Y);
        add_symmetric(H, -2.0 * coefficient, z, z);
    }
}

/// The exact Hessian of m(gamma) b(D) (kappa = 1) in contrast coordinates.
///
/// In:      f     frame of the sub-case on the four edge vertices, 0 < d < dhat
///          x     a0, a1, b0, b1, m
///          m, b  mollifier at gamma and barrier at D = d^2
NOLI_HD inline void mollified_exact_hessian(const ContactFrame<4>& f,
                                            const Stencil<4>& x,
                                            const MollifierJet& m,
                                            const BarrierJet& b,
                                            double (&H)[9][9]) {
    for (int i = 0; i < 9; ++i)
        for (int j = 0; j < 9; ++j)
            H[i][j] = 0.0;
    const Vec3d u = x.x[1] - x.x[0];
    const Vec3d v = x.x[3] - x.x[2];
    const StencilGradient<4> half_grad_gamma = cross_product_pullback(u, v, cross(u, v));
    Vec3d grad_d[4];
    for (int j = 0; j < 4; ++j)
        grad_d[j] = f.w[j] * f.n;
    const ContrastVector grad_gamma = to_contrasts(half_grad_gamma.g);
    const ContrastVector grad = to_contrasts(grad_d);

    add_symmetric(H, 4.0 * m.d2 * b.value, grad_gamma, grad_gamma);
    add_symmetric(H, 8.0 * m.d1 * b.d1 * f.d, grad_gamma, grad);
    add_symmetric(H, 4.0 * m.value * b.d2 * f.d * f.d, grad, grad);
    add_gamma_hessian(H, m.d1 * b.value, u, v);
    add_distance_sq_hessian(H, m.value * b.d1, f);
}

}  // namespace detail
}  // namespace noli
