// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Adaptive barrier stiffness kappa. Source: MATH 8.2, 8.8.

#include "energy/barrier.hpp"
#include "objective/objective.hpp"
#include "step/settings.hpp"
#include "step/single_axes.hpp"

#include <algorithm>

namespace noli {

/// Lower and upper bound of kappa, J/m^4.
struct StiffnessRange {
    double low, high;
};

/// kappa_min = 1e11 m / (4 D0 b''(D0)) at D0 = 1e-16 l^2, or where a small dhat puts that
/// beyond a hundredth of Dhat, there; m mean nodal mass, l scene diagonal. kappa_max is
/// 100 kappa_min, or more where material is so stiff that a contact has to carry its
/// largest vertex force, dt^2 (lambda + 2 mu) V^(2/3), at a gap of kWantedGap dhat. The
/// curvature is that of r = 1 for every exponent: with r = 2 the rule would give a kappa
/// 48 times softer, which costs Newton and PCG iterations
/// (docs/decisions/004-stiffness-rule.md). Source: MATH 8.2.
inline StiffnessRange stiffness_range(const StepSettings& settings) {
    const double l_sq = settings.diagonal * settings.diagonal;
    const double mass = settings.mean_mass > 0.0 ? settings.mean_mass : 1.0;
    const double dhat_sq = settings.dhat * settings.dhat;
    const double d0_sq = std::min(1e-16 * l_sq, 0.01 * dhat_sq);
    const double curvature = barrier(1, d0_sq, dhat_sq).d2;
    const double low =
        settings.contact.kappa_min_multiplier * mass / (4.0 * d0_sq * curvature);
    const double slope = -barrier_slope(
        settings.contact.barrier_exponent, kWantedGap * settings.dhat, settings.dhat);
    const double carried = settings.dt * settings.dt * settings.vertex_force / slope;
    return {low, std::max(100.0 * low, carried)};
}

/// The stiffness that balances the barrier's gradient against all others at x, or `kappa`
/// if the balance asks for none; clamped. Coordinates that are prescribed have no say.
/// Source: MATH 8.2.
template <class Exec>
double balanced_stiffness(Exec& exec,
                          Objective<Exec>& objective,
                          View<const Vec3d> x,
                          View<const std::uint8_t> fixed,
                          const PairSet<Exec>& pairs,
                          const ContactLaw& law,
                          StiffnessRange range,
                          View<Vec3d> scratch_other,
                          View<Vec3d> scratch_barrier,
                          View<const std::uint8_t> axes = {}) {
    double kappa = law.barrier.kappa > 0.0 ? law.barrier.kappa : range.low;
    if (pairs.size() > 0) {
        objective.split_gradients(exec, x, pairs, law, scratch_other, scratch_barrier);
        if (axes.size > 0) detail::zero_axes(exec, axes, scratch_barrier);
        const View<const Vec3d> other = scratch_other;
        const View<const Vec3d> barrier = scratch_barrier;
        const Later along =
            exec.sum_later("step/balance_dot", x.size, [=] NOLI_HD(int i) {
                return fixed[i] ? 0.0 : dot(other[i], barrier[i]);
            });
        const Later square =
            exec.sum_later("step/balance_square", x.size, [=] NOLI_HD(int i) {
                return fixed[i] ? 0.0 : norm_sq(barrier[i]);
            });
        const double square_sum = exec.value(square);
        const double balance = square_sum > 0.0 ? -exec.value(along) / square_sum : 0.0;
        if (balance > 0.0) kappa = balance;
    }
    return std::clamp(kappa, range.low, range.high);
}

}  // namespace noli
