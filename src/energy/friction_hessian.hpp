// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Second derivatives of lagged friction, with the direction of its force as an unknown
/// of its own (primal-dual).
///
/// On the scale of a step friction has a kink: its force turns about within a slip of
/// eps = epsv dt. Newton's own Hessian is 0 along the slip once |u| > eps, so a pair that
/// is pushed back crosses zero at full speed, its force flips, and the line search halves
/// the step of the whole scene. Written with the force direction w as an unknown,
///
///     rho(|u|) w = u,   |w| <= 1,   rho(y) = y / f1(y)
///
/// linearised in u and w, and w eliminated, Newton's system keeps the true gradient and
/// gets
///
///     K = (mu lambda_N / rho) [I - rho'/2 (w n^T + n w^T)],   n = u / |u|
///
/// which is PSD for every |w| <= 1, and the exact Hessian where w = f1 n.
///
/// Source: for |u| in image denoising [Chan1999]; for Tresca friction [Stadler2004]; for
/// the smoothed law of [Li2020] derived here (docs/theory/friction.md).

#include "energy/friction.hpp"

namespace noli {

namespace detail {

/// u / |u|, or the first tangent where there is no displacement.
NOLI_HD inline Vec2d slip_direction(const Vec2d& u, double y) {
    return y > 0.0 ? Vec2d{u.x / y, u.y / y} : Vec2d{1.0, 0.0};
}

/// Eigenvectors (unit, orthogonal) and eigenvalues of w n^T + n w^T in the plane; |n|
/// = 1.
struct SlipSpectrum {
    Vec2d e0, e1;
    double value0, value1;
};

NOLI_HD inline SlipSpectrum slip_spectrum(const Vec2d& w, const Vec2d& n) {
    const double size = hypot2(w.x, w.y);
    const double along = w.x * n.x + w.y * n.y;
    if (!(size > 0.0)) return {n, {-n.y, n.x}, 0.0, 0.0};
    // w/|w| + n and w/|w| - n; the longer one is well defined, the other is across it.
    const double side = along >= 0.0 ? 1.0 : -1.0;
    const Vec2d sum{w.x / size + side * n.x, w.y / size + side * n.y};
    const double length = hypot2(sum.x, sum.y);
    const Vec2d e{sum.x / length, sum.y / length};
    const Vec2d across{-e.y, e.x};
    return {e, across, along + side * size, along - side * size};
}

}  // namespace detail

/// w = f1(|u|) u / |u|, the force direction that belongs to u: with it K is Newton's own
/// Hessian.
NOLI_HD inline Vec2d settled_dual(const Vec2d& u, double eps) {
    const double f1_over_y = friction_law(detail::hypot2(u.x, u.y), eps).f1_over_y;
    return {f1_over_y * u.x, f1_over_y * u.y};
}

/// w after a Newton step that took the tangential displacement from u0 to u1. Outwards
/// the settled one: there is no kink ahead, and stiffness would only slow a slip that
/// starts.
///
/// In:   dual    w at u0, |w| <= 1
///       u0, u1  m
///       eps     epsv dt, m; > 0
/// Out:  |w| <= f1(|u1|)
NOLI_HD inline Vec2d next_dual(const Vec2d& dual,
                               const Vec2d& u0,
                               const Vec2d& u1,
                               double eps) {
    const double y0 = detail::hypot2(u0.x, u0.y);
    const double y1 = detail::hypot2(u1.x, u1.y);
    if (y1 >= y0 && u0.x * u1.x + u0.y * u1.y >= 0.0) return settled_dual(u1, eps);
    const FrictionRatio ratio = friction_ratio(y0, eps);
    const Vec2d n = detail::slip_direction(u0, y0);
    const Vec2d du{u1.x - u0.x, u1.y - u0.y};
    const double along = ratio.drho * (n.x * du.x + n.y * du.y);
    Vec2d w{(u0.x + du.x - along * dual.x) / ratio.rho,
            (u0.y + du.y - along * dual.y) / ratio.rho};
    const double most = friction_law(y1, eps).f1;
    const double size = detail::hypot2(w.x, w.y);
    if (size > most) w = {w.x * (most / size), w.y * (most / size)};
    return w;
}

/// K as modes: two, or fewer where an eigenvalue is 0; none without force.
///
/// In:      moved  displacements since the step's start, m
///          dual   w, |w| <= 1
///          mu     friction coefficient; >= 0
///          eps    epsv dt, m; > 0
template <int S>
NOLI_HD inline StencilModes<S, 2> friction_hessian(const FrictionBasis<S>& basis,
                                                   const Stencil<S>& moved,
                                                   const Vec2d& dual,
                                                   double mu,
                                                   double eps) {
    const Vec2d u = detail::tangential_displacement(basis, moved);
    const double y = detail::hypot2(u.x, u.y);
    const FrictionRatio ratio = friction_ratio(y, eps);
    const detail::SlipSpectrum spectrum =
        detail::slip_spectrum(dual, detail::slip_direction(u, y));
    const Vec2d vectors[2] = {spectrum.e0, spectrum.e1};
    const double values[2] = {spectrum.value0, spectrum.value1};

    StencilModes<S, 2> out{};
    for (int k = 0; k < 2; ++k) {
        const double stiffness =
            (mu * basis.normal_force / ratio.rho) * (1.0 - 0.5 * ratio.drho * values[k]);
        if (!(stiffness > 0.0)) continue;
        const double scale = std::sqrt(stiffness);
        const Vec3d direction = vectors[k].x * basis.t0 + vectors[k].y * basis.t1;
        for (int i = 0; i < S; ++i)
            out.q[out.rank][i] = (scale * basis.w[i]) * direction;
        ++out.rank;
    }
    return out;
}

/// Newton's own Hessian, exact and PSD without projection: along u it is mu lambda_N f1',
/// across u it is mu lambda_N f1/|u|. Continuous at |u| = eps.
template <int S>
NOLI_HD inline StencilModes<S, 2> friction_hessian(const FrictionBasis<S>& basis,
                                                   const Stencil<S>& moved,
                                                   double mu,
                                                   double eps) {
    const Vec2d u = detail::tangential_displacement(basis, moved);
    return friction_hessian(basis, moved, settled_dual(u, eps), mu, eps);
}

}  // namespace noli
