// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Isotropic elastic energy densities of a deformation gradient F, and their stresses.
/// Templated on the scalar: double or a SIMD pack (core/pack.hpp).
///
/// Notation: J = det F; sigma the singular values of F with the sign of J in the
/// smallest; R = U V^T the rotation of F = U diag(sigma) V^T; cof F = dJ/dF.

#include "core/scalar.hpp"
#include "core/vec.hpp"
#include "energy/svd3.hpp"

#include <cmath>
#include <cstdint>
#include <limits>

namespace noli {

/// The material laws of tetrahedra.
enum class ElasticModel : std::uint8_t {
    /// mu/2 (|F|^2 - 3) + lambda/2 (J - 1)^2 - mu (J - 1); finite for every F. Source:
    /// MATH 7.
    StableNeoHookean,
    /// mu/2 (|F|^2 - 3) - mu ln J + lambda/2 (ln J)^2; +infinity for J <= 0.
    NeoHookean,
    /// mu |F - R|^2 + lambda/2 (J - 1)^2; finite for every F.
    FixedCorotated,
};

/// The two constants of a material law, Pa. What they mean depends on the law: take them
/// from lame_parameters().
template <class T>
struct LameParameters {
    T mu, lambda;
};

/// The constants with which `model` has Young's modulus and Poisson's ratio in small
/// strains.
///
/// Stable neo-Hookean has no logarithm, so its constants are mu and lambda + mu of
/// Lame's. `gipc_compat` gives that law the constants of the GIPC authors' program
/// instead (4/3 mu, lambda + 5/6 mu), which make the material 4/3 times too stiff in
/// shear; it does not change the other laws.
///
/// Source: MATH 7.
/// In:     young    Young's modulus, Pa, > 0
///         poisson  Poisson's ratio, in (-1, 0.5)
inline LameParameters<double> lame_parameters(ElasticModel model,
                                              double young,
                                              double poisson,
                                              bool gipc_compat) {
    NOLI_DCHECK(young > 0.0 && poisson > -1.0 && poisson < 0.5);
    const double mu = young / (2.0 * (1.0 + poisson));
    const double lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    if (model != ElasticModel::StableNeoHookean) return {mu, lambda};
    if (gipc_compat) return {4.0 / 3.0 * mu, lambda + 5.0 / 6.0 * mu};
    return {mu, lambda + mu};
}

namespace detail {

struct Log {
    NOLI_HD double operator()(double x) const { return std::log(x); }
};

/// ln J, and 0 where J <= 0.
template <class T>
NOLI_HD inline T log_volume(const T& J) {
    return map_lanes(select(J > T(0.0), J, T(1.0)), Log{});
}

template <class T>
NOLI_HD inline T frobenius_sq(const Mat3<T>& m) {
    return norm_sq(m.col(0)) + norm_sq(m.col(1)) + norm_sq(m.col(2));
}

/// a A + b B + c C
template <class T>
NOLI_HD inline Mat3<T> combine(const T& a,
                               const Mat3<T>& A,
                               const T& b,
                               const Mat3<T>& B) {
    return from_columns(a * A.col(0) + b * B.col(0),
                        a * A.col(1) + b * B.col(1),
                        a * A.col(2) + b * B.col(2));
}

/// U V^T
template <class T>
NOLI_HD inline Mat3<T> rotation_of(const Svd3<T>& svd) {
    const Mat3<T>& v = svd.v;
    return from_columns(svd.u * v.row(0), svd.u * v.row(1), svd.u * v.row(2));
}

/// Whether energy and stress of a law need the singular values.
template <ElasticModel M>
inline constexpr bool kNeedsSvd = M == ElasticModel::FixedCorotated;

/// Energy density; sigma is read by the laws with kNeedsSvd only.
template <ElasticModel M, class T>
NOLI_HD inline T energy_density(const Mat3<T>& F,
                                const Vec3<T>& sigma,
                                const LameParameters<T>& lame) {
    const T J = det(F);
    const T grown = J - T(1.0);
    if constexpr (M == ElasticModel::FixedCorotated) {
        const Vec3<T> stretch{sigma.x - T(1.0), sigma.y - T(1.0), sigma.z - T(1.0)};
        return lame.mu * norm_sq(stretch) + T(0.5) * lame.lambda * (grown * grown);
    } else {
        const T shape = T(0.5) * lame.mu * (frobenius_sq(F) - T(3.0));
        if constexpr (M == ElasticModel::StableNeoHookean) {
            return shape + (T(0.5) * lame.lambda * grown - lame.mu) * grown;
        } else {
            const T log_J = log_volume(J);
            const T energy = shape + (T(0.5) * lame.lambda * log_J - lame.mu) * log_J;
            return select(J > T(0.0), energy, T(std::numeric_limits<double>::infinity()));
        }
    }
}

/// Stress; R is read by the laws with kNeedsSvd only.
template <ElasticModel M, class T>
NOLI_HD inline Mat3<T> stress(const Mat3<T>& F,
                              const Mat3<T>& R,
                              const LameParameters<T>& lame) {
    const Mat3<T> cof = cofactor(F);
    const T J = dot(F.col(0), cof.col(0));
    if constexpr (M == ElasticModel::FixedCorotated) {
        const T two_mu = T(2.0) * lame.mu;
        const Mat3<T> strain{F.a[0] - R.a[0],
                             F.a[1] - R.a[1],
                             F.a[2] - R.a[2],
                             F.a[3] - R.a[3],
                             F.a[4] - R.a[4],
                             F.a[5] - R.a[5],
                             F.a[6] - R.a[6],
                             F.a[7] - R.a[7],
                             F.a[8] - R.a[8]};
        return combine(two_mu, strain, lame.lambda * (J - T(1.0)), cof);
    } else if constexpr (M == ElasticModel::StableNeoHookean) {
        return combine(lame.mu, F, lame.lambda * (J - T(1.0)) - lame.mu, cof);
    } else {
        const auto valid = J > T(0.0);
        const T inverse = select(valid, T(1.0) / select(valid, J, T(1.0)), T(0.0));
        return combine(
            lame.mu, F, (lame.lambda * log_volume(J) - lame.mu) * inverse, cof);
    }
}

}  // namespace detail

/// Energy density, J/m^3; 0 at rest.
template <ElasticModel M, class T>
NOLI_HD inline T elastic_energy(const Mat3<T>& F, const LameParameters<T>& lame) {
    if constexpr (detail::kNeedsSvd<M>)
        return detail::energy_density<M>(F, svd3(F).sigma, lame);
    else
        return detail::energy_density<M>(F, Vec3<T>{}, lame);
}

/// First Piola-Kirchhoff stress P = d(energy density)/dF, Pa.
/// Where the law is infinite (neo-Hookean with J <= 0) it is the finite part mu F.
template <ElasticModel M, class T>
NOLI_HD inline Mat3<T> elastic_stress(const Mat3<T>& F, const LameParameters<T>& lame) {
    if constexpr (detail::kNeedsSvd<M>)
        return detail::stress<M>(F, detail::rotation_of(svd3(F)), lame);
    else
        return detail::stress<M>(F, Mat3<T>{}, lame);
}

/// Cauchy stress P F^T / J, Pa: symmetric, what a sensor in the deformed body would
/// measure. Zero where J = 0.
template <ElasticModel M, class T>
NOLI_HD inline Mat3<T> cauchy_stress(const Mat3<T>& F, const LameParameters<T>& lame) {
    const Mat3<T> kirchhoff = elastic_stress<M>(F, lame) * transpose(F);
    const T J = det(F);
    const T size = select(J > T(0.0), J, -J);
    const auto valid = size > T(0.0);
    return select(valid, T(1.0) / select(valid, J, T(1.0)), T(0.0)) * kirchhoff;
}

/// Von Mises equivalent of a symmetric stress, in the unit of the stress.
template <class T>
NOLI_HD inline T von_mises(const Mat3<T>& s) {
    const T xy = s(0, 0) - s(1, 1);
    const T yz = s(1, 1) - s(2, 2);
    const T zx = s(2, 2) - s(0, 0);
    const T shear = s(0, 1) * s(0, 1) + s(0, 2) * s(0, 2) + s(1, 2) * s(1, 2);
    return sqrt(T(0.5) * (xy * xy + yz * yz + zx * zx) + T(3.0) * shear);
}

}  // namespace noli
