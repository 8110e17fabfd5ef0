// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Nearly parallel edge-edge pairs: E = kappa m(gamma) b(d^2) on the four edge vertices.
///
/// gamma always comes from the two whole edges; the distance from the sub-case that is
/// closest (point-point, point-edge or edge-edge), whose other vertices get weight zero.
/// Notation as in MATH 3: u = a1 - a0, v = b1 - b0, k = u x v, c = |k|, gamma = c^2,
/// s = d / dhat, and the 3 x 12 matrix K = dk/dx.

#include "core/stencil.hpp"
#include "energy/barrier.hpp"
#include "energy/contact_pair.hpp"
#include "energy/mollified_case.hpp"
#include "energy/mollified_exact.hpp"
#include "energy/mollifier.hpp"
#include "energy/small_eigen.hpp"

#include <cstdint>

namespace noli {

/// Which PSD model of a mollified pair's Hessian to build.
///
/// TwoMode   A PSD(M2) A^T, A = [grad c | grad d / dhat]: the authors', rank 2, too soft.
/// FourMode  TwoMode + 2 b_gamma K^T (I - k k^T / c^2) K: rank 4, finite at c = 0.
/// Default. Exact     numeric projection of the exact Hessian.
enum class MollifiedHessian : std::uint8_t { TwoMode, FourMode, Exact };

/// Largest number of modes that mollified_hessian writes.
inline constexpr int kMollifiedModes = 12;

/// Largest rank under one Hessian model. Exact: translations of the pair carry no energy.
NOLI_HD constexpr int max_rank(MollifiedHessian model) {
    if (model == MollifiedHessian::TwoMode) return 2;
    return model == MollifiedHessian::FourMode ? 4 : 9;
}

namespace detail {

/// min_separation < d < reach: elsewhere the pair has no gradient (from min_separation
/// down its energy is infinite).
NOLI_HD inline bool inside_band(double d, const BarrierParams& params) {
    return d > params.min_separation && d < params.reach();
}

}  // namespace detail

/// kappa m(gamma) b(d^2), J.
///
/// Source:  MATH 3.1
/// In:      sub        sub-case of the distance
///          x          a0, a1, b0, b1, m
///          eps_cross  threshold of the rest edges (edge_edge_threshold), m^4
/// Smooth:  C1 at gamma == eps_cross; zero for exactly parallel edges; infinite at d = 0
template <class Stage = Exactly>
NOLI_HD inline double mollified_energy(const MollifiedCase& sub,
                                       const Stencil<4>& x,
                                       double eps_cross,
                                       const BarrierParams& params,
                                       Stage&& stage = {}) {
    const double d = mollified_geometry(sub, x, stage).d;
    if (!(d > params.min_separation)) return HUGE_VAL;
    return params.kappa * mollifier(edge_cross_sq(x), eps_cross).value
         * barrier_at(params, d).value;
}

/// kappa (m' b grad gamma + m b_d grad d), N; grad gamma = 2 K^T k needs no division by
/// c. Source: MATH 3.4.
template <class Stage = Exactly>
NOLI_HD inline StencilGradient<4> mollified_gradient(const MollifiedCase& sub,
                                                     const Stencil<4>& x,
                                                     double eps_cross,
                                                     const BarrierParams& params,
                                                     Stage&& stage = {}) {
    const PairGeometry<4> pair = mollified_geometry(sub, x, stage);
    if (!detail::inside_band(pair.d, params)) return {};
    const Vec3d u = x.x[1] - x.x[0];
    const Vec3d v = x.x[3] - x.x[2];
    const Vec3d k = cross(u, v);
    const MollifierJet m = mollifier(norm_sq(k), eps_cross);
    const BarrierJet b = barrier_at(params, pair.d);

    StencilGradient<4> out = detail::cross_product_pullback(u, v, k);
    const double along_gamma = 2.0 * params.kappa * m.d1 * b.value;
    const double along_d = 2.0 * params.kappa * m.value * pair.d * b.d1;
    for (int i = 0; i < 4; ++i)
        out.g[i] = along_gamma * out.g[i] + (along_d * pair.w[i]) * pair.n;
    return out;
}

namespace detail {

/// Two unit vectors that complete the unit vector k to an orthonormal frame.
NOLI_HD inline void complete_frame(const Vec3d& k, Vec3d& p, Vec3d& q) {
    const Vec3d axis = std::fabs(k.x) < 0.6 ? Vec3d{1.0, 0.0, 0.0} : Vec3d{0.0, 1.0, 0.0};
    p = normalized(cross(k, axis));
    q = cross(k, p);
}

/// k / |k| where |k|^2 may underflow; k != 0.
NOLI_HD inline Vec3d scaled_unit(const Vec3d& k) {
    const double size = max_abs(k);
    return normalized(Vec3d{k.x / size, k.y / size, k.z / size});
}

/// The closed-form models, TwoMode or FourMode. Exactly parallel edges (c = 0) have no
/// direction k / c: FourMode's sum does not depend on it there (any unit vector gives 2
/// b_gamma K^T K), TwoMode's does, so the authors' model has no modes there.
template <MollifiedHessian Model, class Stage>
NOLI_HD inline StencilModes<4, max_rank(Model)> closed_form_modes(
    const MollifiedCase& sub,
    const Stencil<4>& x,
    double eps_cross,
    const BarrierParams& params,
    Stage& stage) {
    StencilModes<4, max_rank(Model)> out{};
    const PairGeometry<4> pair = mollified_geometry(sub, x, stage);
    if (!detail::inside_band(pair.d, params)) return out;
    const Vec3d u = x.x[1] - x.x[0];
    const Vec3d v = x.x[3] - x.x[2];
    const Vec3d k = cross(u, v);
    const double gamma = norm_sq(k);
    const double c = std::sqrt(gamma);
    const bool parallel = !(max_abs(k) > 0.0);
    if (parallel && Model == MollifiedHessian::TwoMode) return out;
    const Vec3d k_hat = parallel ? Vec3d{1.0, 0.0, 0.0} : scaled_unit(k);

    const MollifierJet m = mollifier(gamma, eps_cross);
    const BarrierJet b = barrier_at(params, pair.d);
    const double b_d = 2.0 * pair.d * b.d1;
    const double b_dd = 4.0 * pair.d * pair.d * b.d2 + 2.0 * b.d1;
    const double dhat = params.dhat;
    const SymmetricEigen<2> eigen =
        eigen_symmetric_2x2(params.kappa * 2.0 * b.value * (m.d1 + 2.0 * gamma * m.d2),
                            params.kappa * 2.0 * c * m.d1 * b_d * dhat,
                            params.kappa * m.value * b_dd * dhat * dhat);
    const StencilGradient<4> grad_c = cross_product_pullback(u, v, k_hat);
    for (int mode = 0; mode < 2; ++mode) {
        if (!(eigen.values[mode] > 0.0)) continue;
        const double scale = std::sqrt(eigen.values[mode]);
        const double along_c = scale * eigen.vectors[mode][0];
        const double along_d = scale * eigen.vectors[mode][1] / dhat;
        for (int i = 0; i < 4; ++i)
            out.q[out.rank][i] = along_c * grad_c.g[i] + (along_d * pair.w[i]) * pair.n;
        ++out.rank;
    }
    const double b_gamma = params.kappa * m.d1 * b.value;
    if (Model == MollifiedHessian::TwoMode || !(b_gamma > 0.0)) return out;

    Vec3d across[2];
    complete_frame(k_hat, across[0], across[1]);
    for (const Vec3d& p : across) {
        const StencilGradient<4> mode =
            cross_product_pullback(u, v, std::sqrt(2.0 * b_gamma) * p);
        for (int i = 0; i < 4; ++i)
            out.q[out.rank][i] = mode.g[i];
        ++out.rank;
    }
    return out;
}

/// The numeric projection of the exact Hessian.
template <class Stage>
NOLI_HD inline StencilModes<4, max_rank(MollifiedHessian::Exact)> projected_modes(
    const MollifiedCase& sub,
    const Stencil<4>& x,
    double eps_cross,
    const BarrierParams& params,
    Stage& stage) {
    StencilModes<4, max_rank(MollifiedHessian::Exact)> out{};
    const ContactFrame<4> frame = mollified_frame(sub, x, stage);
    if (!inside_band(frame.d, params)) return out;
    double H[9][9];
    mollified_exact_hessian(
        frame, x, mollifier(edge_cross_sq(x), eps_cross), barrier_at(params, frame.d), H);
    const SymmetricEigen<9> eigen = eigen_symmetric<9>(H);
    for (int mode = 0; mode < 9; ++mode) {
        if (!(eigen.values[mode] > 0.0)) continue;
        from_contrasts(eigen.vectors[mode],
                       std::sqrt(params.kappa * eigen.values[mode]),
                       out.q[out.rank]);
        ++out.rank;
    }
    return out;
}

template <int R>
NOLI_HD inline StencilModes<4, kMollifiedModes> widened(const StencilModes<4, R>& from) {
    StencilModes<4, kMollifiedModes> to{};
    to.rank = from.rank;
    for (int k = 0; k < from.rank; ++k)
        for (int i = 0; i < 4; ++i)
            to.q[k][i] = from.q[k][i];
    return to;
}

}  // namespace detail

/// PSD Hessian of a mollified pair, H = sum_k q_k q_k^T, N/m.
///
/// Source:  MATH 3.3, 3.4; no cap on the curvature
/// In:      as mollified_energy
/// Out:     at most max_rank(Model) modes
/// Valid:   d > 0; finite for exactly parallel edges
template <MollifiedHessian Model, class Stage = Exactly>
NOLI_HD inline StencilModes<4, max_rank(Model)> mollified_modes(
    const MollifiedCase& sub,
    const Stencil<4>& x,
    double eps_cross,
    const BarrierParams& params,
    Stage&& stage = {}) {
    if constexpr (Model == MollifiedHessian::Exact)
        return detail::projected_modes(sub, x, eps_cross, params, stage);
    else
        return detail::closed_form_modes<Model>(sub, x, eps_cross, params, stage);
}

/// The same for a model that is chosen at run time.
NOLI_HD inline StencilModes<4, kMollifiedModes> mollified_hessian(
    MollifiedHessian model,
    const MollifiedCase& sub,
    const Stencil<4>& x,
    double eps_cross,
    const BarrierParams& params) {
    using Kind = MollifiedHessian;
    if (model == Kind::TwoMode)
        return detail::widened(mollified_modes<Kind::TwoMode>(sub, x, eps_cross, params));
    if (model == Kind::FourMode)
        return detail::widened(
            mollified_modes<Kind::FourMode>(sub, x, eps_cross, params));
    return detail::widened(mollified_modes<Kind::Exact>(sub, x, eps_cross, params));
}

}  // namespace noli
