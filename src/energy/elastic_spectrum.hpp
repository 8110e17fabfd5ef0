// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The second derivative of an isotropic energy density in the frame of the singular
/// vectors.
///
/// With F = U diag(sigma) V^T and dF = U X V^T the quadratic form d2Psi(dF, dF) splits
/// into
///   * the diagonal (x00, x11, x22) of X: a 3x3 matrix A, d2Psi / dsigma_i dsigma_j;
///   * for each axis i and the plane (j, k) of the other two:
///       twist (x_jk - x_kj)/sqrt2 with eigenvalue (psi_j + psi_k) / (sigma_j + sigma_k),
///       flip  (x_jk + x_kj)/sqrt2 with eigenvalue (psi_j - psi_k) / (sigma_j - sigma_k),
///     psi = dPsi/dsigma. Each law has these quotients in a form without that division.
/// Source: MATH 7 (stable neo-Hookean; the other laws by the same quotients).

#include "energy/elastic.hpp"
#include "energy/svd3.hpp"

namespace noli {

/// Eigen-system of d2Psi/dF2 in the singular frame, Pa.
template <class T>
struct ElasticSpectrum {
    Symmetric3<T> stretch;  ///< A
    Vec3<T> twist;          ///< eigenvalue of the rotation-like mode about axis i
    Vec3<T> flip;  ///< eigenvalue of the shear mode in the plane normal to axis i
};

namespace detail {

template <class T>
NOLI_HD inline ElasticSpectrum<T> spectrum_stable_neo_hookean(
    const Vec3<T>& s, const LameParameters<T>& lame) {
    const T& mu = lame.mu;
    const T yz = s.y * s.z;
    const T xz = s.x * s.z;
    const T xy = s.x * s.y;
    const T lambda_J = lame.lambda * (s.x * yz);
    const T a = lambda_J - lame.lambda - mu;
    const Vec3<T> shear = a * s;
    const T cross_term = a + lambda_J;
    return {{mu + lame.lambda * (yz * yz),
             mu + lame.lambda * (xz * xz),
             mu + lame.lambda * (xy * xy),
             s.z * cross_term,
             s.y * cross_term,
             s.x * cross_term},
            {mu + shear.x, mu + shear.y, mu + shear.z},
            {mu - shear.x, mu - shear.y, mu - shear.z}};
}

template <class T>
NOLI_HD inline ElasticSpectrum<T> spectrum_neo_hookean(const Vec3<T>& s,
                                                       const LameParameters<T>& lame) {
    const T& mu = lame.mu;
    const T yz = s.y * s.z;
    const T J = s.x * yz;
    const auto valid = J > T(0.0);
    // where the law is infinite the volume terms are left out, as in the stress
    const T inverse = select(valid, T(1.0) / select(valid, J, T(1.0)), T(0.0));
    const Vec3<T> r{yz * inverse, s.x * s.z * inverse, s.x * s.y * inverse};  // 1 / sigma
    const T m = lame.lambda * log_volume(J) - mu;
    const T diag = lame.lambda - m;
    const Vec3<T> shear = (m * inverse) * s;  // m / (sigma_j sigma_k)
    return {{mu + diag * (r.x * r.x),
             mu + diag * (r.y * r.y),
             mu + diag * (r.z * r.z),
             lame.lambda * (r.x * r.y),
             lame.lambda * (r.x * r.z),
             lame.lambda * (r.y * r.z)},
            {mu + shear.x, mu + shear.y, mu + shear.z},
            {mu - shear.x, mu - shear.y, mu - shear.z}};
}

template <class T>
NOLI_HD inline ElasticSpectrum<T> spectrum_fixed_corotated(
    const Vec3<T>& s, const LameParameters<T>& lame) {
    const T two_mu = T(2.0) * lame.mu;
    const T yz = s.y * s.z;
    const T xz = s.x * s.z;
    const T xy = s.x * s.y;
    const T J = s.x * yz;
    const Vec3<T> shear = (lame.lambda * (J - T(1.0))) * s;
    const T cross_term = lame.lambda * (T(2.0) * J - T(1.0));
    // The energy has a downward kink where sigma_j + sigma_k = 0: any very negative
    // number will do.
    const auto rotation = [&two_mu](const T& sum) {
        const T safe = select(sum > T(1e-100), sum, T(1e-100));
        return two_mu - T(2.0) * two_mu / safe;
    };
    return {{two_mu + lame.lambda * (yz * yz),
             two_mu + lame.lambda * (xz * xz),
             two_mu + lame.lambda * (xy * xy),
             s.z * cross_term,
             s.y * cross_term,
             s.x * cross_term},
            {rotation(s.y + s.z) + shear.x,
             rotation(s.x + s.z) + shear.y,
             rotation(s.x + s.y) + shear.z},
            {two_mu - shear.x, two_mu - shear.y, two_mu - shear.z}};
}

}  // namespace detail

/// Eigen-system of the exact second derivative.
/// In:     sigma  as given by svd3()
template <ElasticModel M, class T>
NOLI_HD inline ElasticSpectrum<T> elastic_spectrum(const Vec3<T>& sigma,
                                                   const LameParameters<T>& lame) {
    if constexpr (M == ElasticModel::StableNeoHookean)
        return detail::spectrum_stable_neo_hookean(sigma, lame);
    else if constexpr (M == ElasticModel::NeoHookean)
        return detail::spectrum_neo_hookean(sigma, lame);
    else
        return detail::spectrum_fixed_corotated(sigma, lame);
}

/// The nearest positive semi-definite form: negative eigenvalues become 0.
template <class T>
NOLI_HD inline ElasticSpectrum<T> positive_part(const ElasticSpectrum<T>& s) {
    return {positive_part(s.stretch),
            {detail::positive_part(s.twist.x),
             detail::positive_part(s.twist.y),
             detail::positive_part(s.twist.z)},
            {detail::positive_part(s.flip.x),
             detail::positive_part(s.flip.y),
             detail::positive_part(s.flip.z)}};
}

}  // namespace noli
