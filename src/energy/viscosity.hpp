// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Viscosity of a tetrahedron over one time step: the strain that the step adds, measured
/// so that it is 0 for every rigid motion, however far it turns.
///
///     W = V_n (mu E:E + lambda/2 (tr E)^2),   E = (FᵀF - I) / 2,   F = D(x) D(x_n)⁻¹
///
/// D are the edge matrices, V_n the volume at the start of the step. Times beta / dt it
/// is the Kelvin-Voigt model whose stress is beta C : (rate of strain); for small turns
/// it is Rayleigh's beta K. Source: Kelvin-Voigt viscosity and Green's strain, standard
/// texts [Hughes2000]; as an incremental potential, docs/theory/damping.md.

#include "core/device.hpp"
#include "core/vec.hpp"

namespace noli {

/// One tetrahedron with its shape at the start of the step.
struct ViscousTet {
    Vec3d x[4];         ///< corners now, m
    Mat3d d_inv;        ///< inverse edge matrix at the step's start, 1/m
    double volume;      ///< at the step's start, m^3
    double mu, lambda;  ///< Lame constants of small strains, Pa
};

namespace detail {

/// Edge matrix times the inverse of the one at the step's start.
NOLI_HD inline Mat3d step_deformation(const ViscousTet& tet) {
    return from_columns(tet.x[1] - tet.x[0], tet.x[2] - tet.x[0], tet.x[3] - tet.x[0])
         * tet.d_inv;
}

/// E = (FᵀF - I) / 2
NOLI_HD inline Mat3d added_strain(const Mat3d& F) {
    Mat3d E = transpose(F) * F;
    for (int k = 0; k < 3; ++k)
        E(k, k) -= 1.0;
    for (double& e : E.a)
        e *= 0.5;
    return E;
}

}  // namespace detail

/// W, J (beta / dt = 1).
NOLI_HD inline double viscous_energy(const ViscousTet& tet) {
    const Mat3d E = detail::added_strain(detail::step_deformation(tet));
    double square = 0.0;
    for (const double e : E.a)
        square += e * e;
    const double trace = E(0, 0) + E(1, 1) + E(2, 2);
    return tet.volume * (tet.mu * square + 0.5 * tet.lambda * trace * trace);
}

/// dW/dx of the four corners, N.
NOLI_HD inline void viscous_gradient(const ViscousTet& tet, Vec3d (&g)[4]) {
    const Mat3d F = detail::step_deformation(tet);
    Mat3d S = detail::added_strain(F);
    const double pressure = tet.lambda * (S(0, 0) + S(1, 1) + S(2, 2));
    for (double& s : S.a)
        s *= 2.0 * tet.mu;
    for (int k = 0; k < 3; ++k)
        S(k, k) += pressure;
    const Mat3d H = (F * S) * transpose(tet.d_inv);
    for (int c = 0; c < 3; ++c)
        g[c + 1] = tet.volume * Vec3d{H(0, c), H(1, c), H(2, c)};
    g[0] = -1.0 * (g[1] + g[2] + g[3]);
}

}  // namespace noli
