// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The mollified barrier of nearly parallel edges in the stretch space of the GIPC
/// supplement, section 4, written as it is printed there: 3 x 3 matrices and 9 x 9
/// Hessians, vec stacking columns.
///
///     b~(gamma, g) = m(gamma) b(g),  gamma = |J n_gamma|^2,  g = |J n_g|^2,
///     J = diag(1, c, s),  n_gamma = e_2,  n_g = e_3,  c = |u x v|,  s = d / dhat
///
/// (The printed J has sqrt(c): there c is what is called gamma here.)
/// Source: [Huang2024] supplement 4; MATH 3.2, 3.3.

#include "derivative/contact_oracle.hpp"
#include "energy/barrier.hpp"
#include "energy/mollified_pair.hpp"
#include "energy/mollifier.hpp"

#include <Eigen/Dense>

#include <array>
#include <cmath>

namespace noli::test {

using Vec9 = Eigen::Matrix<double, 9, 1>;
using Mat9 = Eigen::Matrix<double, 9, 9>;

inline Vec9 vec(const Eigen::Matrix3d& Q) {
    return Q.reshaped();
}

/// b~ and its partial derivatives in gamma and g, for kappa dhat^4 = 1.
struct MollifiedPartials {
    double value, gamma, g, gamma_gamma, gamma_g, g_g;
};

inline MollifiedPartials mollified_partials(int exponent,
                                            double gamma,
                                            double g,
                                            double eps) {
    const MollifierJet m = mollifier(gamma, eps);
    const BarrierJet b = barrier(exponent, g, 1.0);
    return {m.value * b.value,
            m.d1 * b.value,
            m.value * b.d1,
            m.d2 * b.value,
            m.d1 * b.d1,
            m.value * b.d2};
}

/// Eigenvalue 2 (f' + 2 I f'') of a function f of I = |J n|^2; its eigenmatrix is
/// J n n^T / sqrt(I).
inline double stretch_eigenvalue(double invariant, double d1, double d2) {
    return 2.0 * (d1 + 2.0 * invariant * d2);
}

inline Eigen::Matrix3d stretch_eigenmatrix(const Eigen::Matrix3d& J,
                                           const Eigen::Vector3d& n) {
    return J * n * n.transpose() / (J * n).norm();
}

/// Eqs. (11) and (12): the two unit eigenmatrices with eigenvalue 2 f'. Not defined where
/// J n is along the first left singular vector of J.
inline std::array<Eigen::Matrix3d, 2> twist_eigenmatrices(const Eigen::Matrix3d& U,
                                                          const Eigen::Vector3d& sigma,
                                                          const Eigen::Matrix3d& V,
                                                          const Eigen::Vector3d& n) {
    Eigen::Matrix3d Tx;
    Eigen::Matrix3d Ty;
    Eigen::Matrix3d Tz;
    Tx << 0, 0, 0, 0, 0, 1, 0, -1, 0;
    Ty << 0, 0, -1, 0, 0, 0, 1, 0, 0;
    Tz << 0, 1, 0, -1, 0, 0, 0, 0, 0;
    const Eigen::Vector3d a = V.transpose() * n;
    const Eigen::Matrix3d right = sigma.asDiagonal() * V.transpose() * n * n.transpose();
    const Eigen::Matrix3d Q2 = U * Tx * right;
    const Eigen::Matrix3d Q3 =
        (sigma[1] * a[1] * U * Tz - sigma[2] * a[2] * U * Ty) * right;
    return {Q2.normalized(), Q3.normalized()};
}

/// The eigenvalues of section 4 at one (c, s), and the matrices of Eqs. (13) to (15).
struct MollifiedSpectrum {
    double gamma1, gamma23, g1, g23;
    double coupling;         ///< 4 t
    double prime7, prime8;   ///< lambda'_7 >= lambda'_8, eigenvalues of M
    Eigen::Vector2d q7, q8;  ///< diagonal entries (2, 3) of Q'_7 and Q'_8
};

inline MollifiedSpectrum mollified_spectrum(int exponent,
                                            double c,
                                            double s,
                                            double eps) {
    const MollifiedPartials b = mollified_partials(exponent, c * c, s * s, eps);
    MollifiedSpectrum out;
    out.gamma1 = stretch_eigenvalue(c * c, b.gamma, b.gamma_gamma);
    out.gamma23 = 2.0 * b.gamma;
    out.g1 = stretch_eigenvalue(s * s, b.g, b.g_g);
    out.g23 = 2.0 * b.g;
    out.coupling = 4.0 * c * s * b.gamma_g;
    const double half_gap = 0.5 * (out.gamma1 - out.g1);
    const double radius = std::hypot(half_gap, out.coupling);
    const double middle = 0.5 * (out.gamma1 + out.g1);
    out.prime7 = middle + radius;
    out.prime8 = middle - radius;
    out.q7 = Eigen::Vector2d(out.coupling, out.prime7 - out.gamma1).normalized();
    out.q8 = Eigen::Vector2d(out.coupling, out.prime8 - out.gamma1).normalized();
    return out;
}

inline Mat9 outer(double value, const Eigen::Matrix3d& Q) {
    return value * vec(Q) * vec(Q).transpose();
}

/// Eq. (13): the coupling of gamma and g.
inline Mat9 coupling_matrix(const MollifiedSpectrum& spectrum) {
    Mat9 out = Mat9::Zero();
    out(4, 8) = out(8, 4) = spectrum.coupling;
    return out;
}

/// Eq. (14), from its four terms; lambda_7,8 = +- 4t with Q_7,8 = (e2 e2^T +- e3 e3^T) /
/// sqrt 2.
inline Mat9 auxiliary_matrix(const MollifiedSpectrum& spectrum) {
    const Eigen::Matrix3d Q_gamma = Eigen::Vector3d(0, 1, 0).asDiagonal();
    const Eigen::Matrix3d Q_g = Eigen::Vector3d(0, 0, 1).asDiagonal();
    const double half = std::sqrt(0.5);
    return outer(spectrum.gamma1, Q_gamma) + outer(spectrum.g1, Q_g)
         + outer(spectrum.coupling, half * (Q_gamma + Q_g))
         + outer(-spectrum.coupling, half * (Q_gamma - Q_g));
}

/// Eq. (15): the whole Hessian of b~ with respect to vec J at J = diag(1, c, s).
inline Mat9 mollified_stretch_hessian(const MollifiedSpectrum& spectrum,
                                      double c,
                                      double s) {
    const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
    const Eigen::Vector3d sigma(1.0, c, s);
    Mat9 out = auxiliary_matrix(spectrum);
    for (const auto& Q : twist_eigenmatrices(identity, sigma, identity, identity.col(1)))
        out += outer(spectrum.gamma23, Q);
    for (const auto& Q : twist_eigenmatrices(identity, sigma, identity, identity.col(2)))
        out += outer(spectrum.g23, Q);
    return out;
}

/// Exact value, gradient and Hessian of m(gamma) b(D), kappa = 1, with respect to the
/// four edge vertices.
inline Jet<12> mollified_oracle(const MollifiedCase& sub,
                                const Stencil<4>& x,
                                double eps,
                                int exponent,
                                double dhat) {
    const auto all = variables(x);
    Point<Jet<12>> points[4];
    for (int i = 0; i < 4; ++i)
        if (sub.local[i] >= 0) points[i] = all[sub.local[i]];
    return mollifier_of(all.data(), eps)
         * barrier_of(exponent, distance_sq_of(sub.kind, points), dhat);
}

/// Sub-case of PairSampler::near_parallel: a1 against b0, b0 against the first edge, or
/// both edges.
inline MollifiedCase near_parallel_case(PairKind kind) {
    if (kind == PairKind::PointPoint) return {kind, {1, 2, -1, -1}};
    if (kind == PairKind::PointEdge) return {kind, {2, 0, 1, -1}};
    return {kind, {0, 1, 2, 3}};
}

}  // namespace noli::test
