// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The barrier of a distance as all contacts share it: b((d - xi)^2), which acts between
/// xi and xi + dhat, xi the minimum separation (an offset of the surfaces).
///
/// In terms of D = d^2 and with B for the barrier as a function of (d - xi)^2, E = d -
/// xi,
///
///     b_D = B' E / d,   b_DD = B'' (E / d)^2 + B' xi / (2 d^3),
///
/// so that b_d = 2 d b_D = 2 E B' and b_dd = 4 D b_DD + 2 b_D = 4 E^2 B'' + 2 B': what is
/// written in D holds for every xi. Source: [Li2021] offsets the barrier to keep
/// codimensional bodies a thickness apart, of squared distances; here the distance itself
/// is shifted.

#include "energy/barrier.hpp"

namespace noli {

/// What all barrier terms share.
struct BarrierParams {
    double dhat;           ///< activation distance beyond min_separation, m; > 0
    double kappa;          ///< stiffness, J/m^4; > 0
    int exponent;          ///< r of the barrier, 1 or 2
    double curvature_cap;  ///< g_c of barrier_curvature, 0 disables; not used by Exact
                           ///< and Numeric
    double min_separation = 0.0;  ///< xi, m; where the barrier is infinite

    /// Distance at which the barrier begins to act, m.
    [[nodiscard]] NOLI_HD double reach() const { return dhat + min_separation; }
};

/// b and its derivatives with respect to D = d^2 (kappa = 1) at distance d, m. At and
/// below min_separation the value is infinite and the derivatives are 0.
NOLI_HD inline BarrierJet barrier_at(const BarrierParams& params, double d) {
    const double dhat_sq = params.dhat * params.dhat;
    if (params.min_separation == 0.0) return barrier(params.exponent, d * d, dhat_sq);
    const double gap = d - params.min_separation;
    if (!(gap > 0.0)) return {HUGE_VAL, 0.0, 0.0};
    const BarrierJet b = barrier(params.exponent, gap * gap, dhat_sq);
    const double ratio = gap / d;
    return {b.value,
            ratio * b.d1,
            ratio * ratio * b.d2 + 0.5 * params.min_separation / (d * d * d) * b.d1};
}

/// db/dd, m^3 (kappa = 1).
NOLI_HD inline double barrier_slope_at(const BarrierParams& params, double d) {
    return barrier_slope(params.exponent, d - params.min_separation, params.dhat);
}

/// d2b/dd2, m^2 (kappa = 1); see barrier_curvature.
NOLI_HD inline double barrier_curvature_at(const BarrierParams& params,
                                           double d,
                                           double curvature_cap = 0.0) {
    return barrier_curvature(
        params.exponent, d - params.min_separation, params.dhat, curvature_cap);
}

}  // namespace noli
