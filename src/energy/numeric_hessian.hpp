// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The Hessian of an unmollified pair as [Li2020] projects it: the full matrix in all
/// vertex coordinates,
///
///     H = kappa (b_DD grad D grad D^T + b_D hess D)
///
/// of size 3 S (6, 9, 12), diagonalised numerically, negative eigenvalues dropped. The
/// baseline to which the closed forms of contact_pair.hpp are compared, in counts and in
/// time; Exact gives the same matrix from a problem of size 1, 3, 5.
/// Source: MATH 2.5 (grad D and hess D as in contact_frame.hpp).

#include "energy/contact_pair.hpp"

namespace noli {

namespace detail {

/// H += coefficient q q^T.
template <int S>
NOLI_HD inline void add_outer(double coefficient,
                              const Vec3d (&q)[S],
                              double (&H)[3 * S][3 * S]) {
    for (int i = 0; i < S; ++i)
        for (int a = 0; a < 3; ++a)
            for (int j = 0; j < S; ++j)
                for (int b = 0; b < 3; ++b)
                    H[3 * i + a][3 * j + b] += coefficient * q[i][a] * q[j][b];
}

/// b_DD grad D grad D^T + b_D hess D, kappa = 1.
template <int S>
NOLI_HD inline void full_pair_hessian(const ContactFrame<S>& f,
                                      const BarrierJet& b,
                                      double (&H)[3 * S][3 * S]) {
    for (int i = 0; i < 3 * S; ++i)
        for (int j = 0; j < 3 * S; ++j)
            H[i][j] = 0.0;
    Vec3d q[S];
    for (int i = 0; i < S; ++i)
        q[i] = f.w[i] * f.n;
    add_outer<S>(4.0 * f.d * f.d * b.d2, q, H);
    for (int i = 0; i < S; ++i)
        for (int j = 0; j < S; ++j)
            for (int a = 0; a < 3; ++a)
                H[3 * i + a][3 * j + a] += 2.0 * b.d1 * f.w[i] * f.w[j];
    for (int k = 0; k < f.num_tangents; ++k) {
        for (int i = 0; i < S; ++i)
            q[i] = (-f.w[i]) * f.t[k] + (f.d * f.v[k][i]) * f.n;
        add_outer<S>(-2.0 * b.d1, q, H);
    }
}

}  // namespace detail

/// PSD Hessian of a pair: the positive eigenpairs of the full matrix, largest first.
/// There are at most S - 1 (contact_pair.hpp); what exceeds them is rounding.
///
/// Valid: distance > 0
template <int S>
NOLI_HD inline StencilModes<S, kPairModes<S>> numeric_pair_hessian(
    PairKind kind, const Stencil<S>& x, const BarrierParams& params) {
    StencilModes<S, kPairModes<S>> out{};
    const ContactFrame<S> f = contact_frame(kind, x);
    if (!(f.d < params.reach())) return out;
    double H[3 * S][3 * S];
    detail::full_pair_hessian<S>(f, barrier_at(params, f.d), H);
    SymmetricEigen<3 * S> eigen = eigen_symmetric<3 * S>(H);
    while (out.rank < kPairModes<S>) {
        int best = 0;
        for (int k = 1; k < 3 * S; ++k)
            if (eigen.values[k] > eigen.values[best]) best = k;
        if (!(eigen.values[best] > 0.0)) break;
        const double scale = std::sqrt(params.kappa * eigen.values[best]);
        eigen.values[best] = 0.0;
        const double(&z)[3 * S] = eigen.vectors[best];
        for (int i = 0; i < S; ++i)
            out.q[out.rank][i] = scale * Vec3d{z[3 * i], z[3 * i + 1], z[3 * i + 2]};
        ++out.rank;
    }
    return out;
}

}  // namespace noli
