// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The contact barrier as a function of one number, the squared distance D = d^2 of a
/// pair:
///
///     b(D) = (-1)^r (D - Dhat)^2 ln(D / Dhat)^r   for 0 < D < Dhat,   0 for D >= Dhat
///
/// with exponent r = 1 (the log barrier of [Li2020]) or r = 2 (stiffer, smoother at
/// Dhat), and stiffness kappa = 1; callers multiply by kappa. In gap form g = D / Dhat
/// the same function is Dhat^2 (g - 1)^2 (-ln g)^r.

#include "core/device.hpp"

#include <cmath>

namespace noli {

/// b, db/dD and d2b/dD2 at one D; units m^4, m^2, 1 (kappa = 1).
struct BarrierJet {
    double value, d1, d2;
};

namespace detail {

/// ln(D / Dhat), accurate also where D is close to Dhat.
NOLI_HD inline double log_gap(double d_sq, double dhat_sq) {
    const double ratio = d_sq / dhat_sq;
    return ratio > 0.5 ? std::log1p((d_sq - dhat_sq) / dhat_sq) : std::log(ratio);
}

}  // namespace detail

/// Barrier and its first two derivatives with respect to the squared distance.
///
/// Source:  MATH 1.2 (r = 1: [Li2020]); written so that all terms of d1 and of d2 have
///          the same sign on (0, Dhat): nothing cancels.
/// In:      exponent  r, 1 or 2
///          d_sq      squared distance, m^2
///          dhat_sq   squared activation distance, m^2; > 0
/// Out:     value >= 0, d1 <= 0, d2 >= 0; units m^4, m^2, 1
///          At d_sq <= 0 the value is infinite and the derivatives are 0: such a state is
///          refused for its energy, and no NaN spreads from it.
/// Smooth:  C2 (r = 1) or C3 (r = 2) at d_sq == dhat_sq
NOLI_HD inline BarrierJet barrier(int exponent, double d_sq, double dhat_sq) {
    NOLI_DCHECK(exponent == 1 || exponent == 2);
    if (d_sq >= dhat_sq) return {0.0, 0.0, 0.0};
    if (!(d_sq > 0.0)) return {HUGE_VAL, 0.0, 0.0};

    const double gap = d_sq - dhat_sq;  // negative inside the active band
    const double log_ratio = detail::log_gap(d_sq, dhat_sq);
    const double u = gap / d_sq;
    if (exponent == 1) {
        return {-gap * gap * log_ratio,
                -gap * (2.0 * log_ratio + u),
                -2.0 * log_ratio - 4.0 * u + u * u};
    }
    const double log_sq = log_ratio * log_ratio;
    return {gap * gap * log_sq,
            2.0 * gap * log_ratio * (log_ratio + u),
            2.0 * log_sq + 8.0 * u * log_ratio + 2.0 * u * u * (1.0 - log_ratio)};
}

/// lambda_1(g) = d2b/ds2 with s = sqrt(g) = d / dhat, for K = kappa dhat^4 = 1: the one
/// positive eigenvalue of the barrier in stretch space. Source: MATH 1.3.
NOLI_HD inline double barrier_lambda1(int exponent, double g) {
    const BarrierJet b = barrier(exponent, g, 1.0);
    return 4.0 * g * b.d2 + 2.0 * b.d1;
}

/// lambda_2,3(g) = (1/s) db/ds for K = 1: the negative (twist) eigenvalues. Source:
/// MATH 1.3.
NOLI_HD inline double barrier_lambda23(int exponent, double g) {
    return 2.0 * barrier(exponent, g, 1.0).d1;
}

/// db/dd, m^3 (kappa = 1): minus the contact force for kappa = 1. Source: MATH 2.1.
NOLI_HD inline double barrier_slope(int exponent, double d, double dhat) {
    return 2.0 * d * barrier(exponent, d * d, dhat * dhat).d1;
}

/// d2b/dd2 = 4 D b_DD + 2 b_D = dhat^2 lambda_1(g), m^2 (kappa = 1): the Gauss-Newton
/// curvature.
///
/// Source:  MATH 2.1, 2.4
/// In:      exponent       r, 1 or 2
///          d, dhat        distance and activation distance, m; > 0
///          curvature_cap  g_c: below g = g_c the curvature stays at its value at g_c;
///                         0 disables. It bounds the conditioning and lengthens the
///                         escaping step by g_c / g.
NOLI_HD inline double barrier_curvature(int exponent,
                                        double d,
                                        double dhat,
                                        double curvature_cap = 0.0) {
    const double dhat_sq = dhat * dhat;
    const double d_sq = std::fmax(d * d, curvature_cap * dhat_sq);
    const BarrierJet b = barrier(exponent, d_sq, dhat_sq);
    return 4.0 * d_sq * b.d2 + 2.0 * b.d1;
}

/// d2b/dD2 (kappa = 1, dimensionless), from which the bounds of an adaptive kappa are
/// set. Source: MATH 8.2.
NOLI_HD inline double barrier_second_derivative_d_sq(int exponent,
                                                     double d_sq,
                                                     double dhat_sq) {
    return barrier(exponent, d_sq, dhat_sq).d2;
}

}  // namespace noli
