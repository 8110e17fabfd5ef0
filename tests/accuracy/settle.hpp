// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Where a scene comes to rest in the steps that it is given.

#include "cover.hpp"

namespace noli::accuracy {

/// omega dt from which 60 steps of an integrator damp an oscillation by far more than a
/// hundred: implicit Euler loses a factor 1 / sqrt(1 + (omega dt)^2) a step, BDF2 needs
/// omega dt of about 2 for 0.6. Newmark's average acceleration damps nothing.
inline double damps_from(Integrator integrator) {
    if (integrator == Integrator::ImplicitEuler) return 0.5;
    return integrator == Integrator::Bdf2 ? 2.0 : HUGE_VAL;
}

/// Bodies on their contacts, piled up to `height` sizes. Two things must be damped: the
/// slowest wave of a column that stands on its end, omega = pi c / (2 height size), and
/// its bounce on the barrier, whose stiffness is at least that of a weight over dhat
/// (1.7e-3 sizes), omega^2 = g / dhat. And the pile must not be crushed: rho g height / E
/// <= 0.03.
inline Domain settling(double height) {
    Domain domain;
    domain.integrators = {Integrator::ImplicitEuler, Integrator::Bdf2};
    domain.holds = [=](const Case& at) {
        const Material m = preset(at.preset);
        const double wave = 1.5708 * sound_speed(m) / (height * at.size);
        const double bounce = std::sqrt(kGravity / (1.7e-3 * height * at.size));
        return std::min(wave, bounce) * at.dt >= damps_from(at.integrator)
            && m.density * kGravity * height * at.size <= 0.03 * m.young;
    };
    return domain;
}

}  // namespace noli::accuracy
