// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Energy, gradient and four PSD Hessians of one unmollified contact pair (PP, PE, PT,
/// EE).
///
///     E = kappa b(d^2),   dE/dx_i = kappa b_d w_i n,   b_d = 2 d b_D
///
/// GaussNewton      b_dd grad d grad d^T: rank one, the paper's; drops b_d hess d and
///                  with it the only stiffness against slide-and-rotate motions, so it
///                  can stall.
/// GaussNewtonPlus  adds the positive part of b_d hess d in closed form.
/// Exact            projects b_dd grad d grad d^T + b_d hess d as a whole. Its positive
///                  part lies in span{w, W} (x) n + w (x) {t_i}, of dimension 1, 3, 5 for
///                  PP, PE, PT/EE, so an eigenproblem of that size gives the same matrix
///                  as one of size 3 S.
/// Numeric          the same from the full 3 S x 3 S matrix (numeric_hessian.hpp).
///
/// All have at most 1, 2, 3 positive modes for PP, PE, PT/EE: b_d hess d has k
/// positive eigenvalues (k closest-point parameters) and the rank-one term can add at
/// most one.

#include "core/stencil.hpp"
#include "energy/barrier_params.hpp"
#include "energy/contact_frame.hpp"
#include "energy/small_eigen.hpp"

#include <cstdint>

namespace noli {

/// Which PSD model of a pair's Hessian to build.
enum class ContactHessian : std::uint8_t { GaussNewton, GaussNewtonPlus, Exact, Numeric };

/// Largest number of modes that pair_hessian writes for a pair on S points.
template <int S>
inline constexpr int kPairModes = S - 1;

/// Largest rank of one kind of pair under one Hessian model.
NOLI_HD constexpr int max_rank(PairKind kind, ContactHessian model) {
    if (model == ContactHessian::GaussNewton || kind == PairKind::PointPoint) return 1;
    return kind == PairKind::PointEdge ? 2 : 3;
}

/// kappa b(d^2), J. Infinite at d = 0.
template <int S, class Stage = Exactly>
NOLI_HD inline double pair_energy(PairKind kind,
                                  const Stencil<S>& x,
                                  const BarrierParams& params,
                                  Stage&& stage = {}) {
    const double d = pair_geometry(kind, x, stage).d;
    return params.kappa * barrier_at(params, d).value;
}

/// dE/dx_i = kappa b_d w_i n, N. Source: MATH 2.1.
template <int S, class Stage = Exactly>
NOLI_HD inline StencilGradient<S> pair_gradient(PairKind kind,
                                                const Stencil<S>& x,
                                                const BarrierParams& params,
                                                Stage&& stage = {}) {
    const PairGeometry<S> pair = pair_geometry(kind, x, stage);
    const double slope = params.kappa * barrier_slope_at(params, pair.d);
    StencilGradient<S> out;
    for (int i = 0; i < S; ++i)
        out.g[i] = (slope * pair.w[i]) * pair.n;
    return out;
}

namespace detail {

/// Appends sqrt(kappa b_dd) w (x) n.
template <int S>
NOLI_HD inline void append_gauss_newton_mode(double d,
                                             const Vec3d& n,
                                             const double (&w)[S],
                                             const BarrierParams& params,
                                             StencilModes<S, kPairModes<S>>& out) {
    const double curvature =
        params.kappa * barrier_curvature_at(params, d, params.curvature_cap);
    if (!(curvature > 0.0)) return;
    const double scale = std::sqrt(curvature);
    for (int i = 0; i < S; ++i)
        out.q[out.rank][i] = (scale * w[i]) * n;
    ++out.rank;
}

/// Appends the positive part of b_d hess d: one mode per tangent.
///
/// On span{a = w (x) t / A, c = v (x) n / |v|}, A = |w|, B = d |v|, the block is
///
///     2 |b_D| [[0, -A B], [-A B, B^2]]
///
/// with positive eigenvalue 2 |b_D| B m, m = (B + sqrt(B^2 + 4 A^2)) / 2, and eigenvector
/// -A a + m c. Source: MATH 2.5 (mu = B m).
template <int S>
NOLI_HD inline void append_curvature_modes(const ContactFrame<S>& f,
                                           double minus_slope,
                                           StencilModes<S, kPairModes<S>>& out) {
    double w_sq = 0.0;  // A^2
    for (int i = 0; i < S; ++i)
        w_sq += f.w[i] * f.w[i];
    for (int k = 0; k < kPairParameters<S> && k < f.num_tangents; ++k) {
        double v_sq = 0.0;
        for (int i = 0; i < S; ++i)
            v_sq += f.v[k][i] * f.v[k][i];
        const double v_norm = std::sqrt(v_sq);
        const double B = f.d * v_norm;
        const double m = 0.5 * (B + std::sqrt(B * B + 4.0 * w_sq));
        const double weight = 2.0 * minus_slope * B * m / (w_sq + m * m);
        if (!(weight > 0.0)) continue;
        const double scale = std::sqrt(weight);
        for (int i = 0; i < S; ++i)
            out.q[out.rank][i] =
                (-scale * f.w[i]) * f.t[k] + (scale * m * f.v[k][i] / v_norm) * f.n;
        ++out.rank;
    }
}

/// Orthonormal basis of span{w, dw/dbeta_i} in R^S; the first vector is w / |w|. Well
/// conditioned for every shape: the derivatives are constants and w is independent of
/// them.
template <int S>
struct WeightBasis {
    double e[1 + kPairParameters<S>][S];
};

template <int S>
NOLI_HD inline WeightBasis<S> weight_basis(PairKind kind, const double (&w)[S]) {
    constexpr int kSize = 1 + kPairParameters<S>;
    WeightBasis<S> out;
    for (int b = 0; b < kSize; ++b) {
        double(&e)[S] = out.e[b];
        for (int j = 0; j < S; ++j) {
            if constexpr (S > 2) {
                e[j] = b == 0 ? w[j] : weight_derivative<S>(kind, b - 1, j);
            } else {
                e[j] = w[j];
            }
        }
        for (int done = 0; done < b; ++done) {
            double along = 0.0;
            for (int j = 0; j < S; ++j)
                along += e[j] * out.e[done][j];
            for (int j = 0; j < S; ++j)
                e[j] -= along * out.e[done][j];
        }
        double length_sq = 0.0;
        for (int j = 0; j < S; ++j)
            length_sq += e[j] * e[j];
        for (int j = 0; j < S; ++j)
            e[j] /= std::sqrt(length_sq);
    }
    return out;
}

/// Size of the space that holds the positive part of a pair's Hessian: 1, 3, 5 for S = 2,
/// 3, 4.
template <int S>
inline constexpr int kReducedSize = 1 + 2 * kPairParameters<S>;

/// The exact Hessian in the coordinates (e_0 (x) n, .., e_k (x) n, e_0 (x) t_1, ..,
/// e_0 (x) t_k). With z_i = v_i (x) n and a_i = w (x) t_i it is
///
///     (4 D b_DD + 2 b_D) w w^T (x) n n^T
///         + 2 b_D sum_i (d a_i z_i^T + d z_i a_i^T - D z_i z_i^T)
///
/// (contact_frame.hpp with I = n n^T + sum_i t_i t_i^T + rest). What it leaves out is
/// 2 b_D w w^T (x) rest: negative, and orthogonal to everything here.
/// Source: MATH 2.5, side result.
template <int S>
NOLI_HD inline void reduced_hessian(const ContactFrame<S>& f,
                                    const WeightBasis<S>& basis,
                                    const BarrierJet& b,
                                    double (&H)[kReducedSize<S>][kReducedSize<S>]) {
    constexpr int kNormals = 1 + kPairParameters<S>;
    for (int i = 0; i < kReducedSize<S>; ++i)
        for (int j = 0; j < kReducedSize<S>; ++j)
            H[i][j] = 0.0;
    double A = 0.0;
    for (int j = 0; j < S; ++j)
        A += f.w[j] * basis.e[0][j];
    H[0][0] = (4.0 * f.d * f.d * b.d2 + 2.0 * b.d1) * A * A;
    for (int i = 0; i < kPairParameters<S> && i < f.num_tangents; ++i) {
        double y[kNormals];  // v_i in the basis e
        for (int k = 0; k < kNormals; ++k) {
            y[k] = 0.0;
            for (int j = 0; j < S; ++j)
                y[k] += f.v[i][j] * basis.e[k][j];
        }
        for (int k = 0; k < kNormals; ++k) {
            H[kNormals + i][k] += 2.0 * b.d1 * f.d * A * y[k];
            H[k][kNormals + i] = H[kNormals + i][k];
            for (int l = 0; l < kNormals; ++l)
                H[k][l] -= 2.0 * b.d1 * f.d * f.d * y[k] * y[l];
        }
    }
}

/// Appends the positive eigenpairs of the reduced Hessian, largest first.
template <int S>
NOLI_HD inline void append_exact_modes(PairKind kind,
                                       const ContactFrame<S>& f,
                                       const BarrierParams& params,
                                       StencilModes<S, kPairModes<S>>& out) {
    constexpr int kNormals = 1 + kPairParameters<S>;
    const WeightBasis<S> basis = weight_basis<S>(kind, f.w);
    double H[kReducedSize<S>][kReducedSize<S>];
    reduced_hessian(f, basis, barrier_at(params, f.d), H);
    SymmetricEigen<kReducedSize<S>> eigen = eigen_symmetric<kReducedSize<S>>(H);
    while (out.rank < kPairModes<S>) {
        int best = 0;
        for (int k = 1; k < kReducedSize<S>; ++k)
            if (eigen.values[k] > eigen.values[best]) best = k;
        if (!(eigen.values[best] > 0.0)) break;
        const double scale = std::sqrt(params.kappa * eigen.values[best]);
        eigen.values[best] = 0.0;
        const double(&z)[kReducedSize<S>] = eigen.vectors[best];
        Vec3d tangential{0.0, 0.0, 0.0};
        for (int i = 0; i < kPairParameters<S> && i < f.num_tangents; ++i)
            tangential += z[kNormals + i] * f.t[i];
        for (int j = 0; j < S; ++j) {
            double normal = 0.0;
            for (int k = 0; k < kNormals; ++k)
                normal += z[k] * basis.e[k][j];
            out.q[out.rank][j] = scale * (normal * f.n + basis.e[0][j] * tangential);
        }
        ++out.rank;
    }
}

}  // namespace detail

/// PSD Hessian of a pair as at most kPairModes<S> modes q, H = sum_k q_k q_k^T, N/m.
///
/// Source:  MATH 2.1 (GaussNewton), 2.5 (GaussNewtonPlus, Exact)
/// Valid:   d > 0; finite for collapsed edges and triangles (their tangents are dropped)
/// Smooth:  zero from d = reach() on. GaussNewton is continuous where the kind changes;
/// the
///          others jump there, as hess d does
/// Numeric is not among these: numeric_pair_hessian(), whose 12 x 12 matrices no GPU
/// kernel of the others should carry.
template <int S, class Stage = Exactly>
NOLI_HD inline StencilModes<S, kPairModes<S>> pair_hessian(ContactHessian model,
                                                           PairKind kind,
                                                           const Stencil<S>& x,
                                                           const BarrierParams& params,
                                                           Stage&& stage = {}) {
    NOLI_DCHECK(model != ContactHessian::Numeric);
    StencilModes<S, kPairModes<S>> out{};
    if (model == ContactHessian::GaussNewton) {
        const PairGeometry<S> pair = pair_geometry(kind, x, stage);
        detail::append_gauss_newton_mode<S>(pair.d, pair.n, pair.w, params, out);
        return out;
    }
    const ContactFrame<S> frame = contact_frame(kind, x, stage);
    if (!(frame.d < params.reach())) return out;
    if (model == ContactHessian::Exact) {
        detail::append_exact_modes(kind, frame, params, out);
        return out;
    }
    const BarrierJet b = barrier_at(params, frame.d);
    detail::append_gauss_newton_mode<S>(frame.d, frame.n, frame.w, params, out);
    detail::append_curvature_modes(frame, -params.kappa * b.d1, out);
    return out;
}

}  // namespace noli
