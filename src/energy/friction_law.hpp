// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Smoothed Coulomb friction as a function of one number, the tangential displacement y.

#include "core/device.hpp"

namespace noli {

/// f0(y) in m, f1(y) = f0' (dimensionless), f1(y) / y in 1/m, f1'(y) in 1/m.
struct FrictionJet {
    double f0, f1, f1_over_y, df1;
};

/// C1 friction law: full Coulomb force from y = eps on, a quadratic ramp below.
///
///     f1 = 2 y/eps - y^2/eps^2,  f0 = y^2/eps - y^3/(3 eps^2) + eps/3   for y < eps
///     f1 = 1,                    f0 = y                                 otherwise
///
/// Source:  MATH 5, [Li2020]
/// In:      y    tangential displacement over the step, m; >= 0
///          eps  epsv dt, the displacement below which contact counts as sticking, m; > 0
/// Smooth:  f0 is C2 at y == eps (f1 is C1); f1 / y is finite at y = 0
NOLI_HD inline FrictionJet friction_law(double y, double eps) {
    NOLI_DCHECK(y >= 0.0 && eps > 0.0);
    if (y >= eps) return {y, 1.0, 1.0 / y, 0.0};
    const double s = y / eps;
    return {eps * (s * s * (1.0 - s / 3.0) + 1.0 / 3.0),
            s * (2.0 - s),
            (2.0 - s) / eps,
            2.0 * (1.0 - s) / eps};
}

/// rho = y / f1(y), m, by which a tangential displacement is divided to give the
/// direction and size of its friction force, and rho' (dimensionless); finite at y = 0.
struct FrictionRatio {
    double rho, drho;
};

/// In: y, eps  as friction_law. Source: f1 of [Li2020], inverted.
NOLI_HD inline FrictionRatio friction_ratio(double y, double eps) {
    NOLI_DCHECK(y >= 0.0 && eps > 0.0);
    if (y >= eps) return {y, 1.0};
    const double inverse = 1.0 / (2.0 - y / eps);
    return {eps * inverse, inverse * inverse};
}

}  // namespace noli
