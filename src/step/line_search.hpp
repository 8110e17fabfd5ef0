// SPDX-License-Identifier: Apache-2.0
#pragma once
/// When a trial step of the backtracking line search may be taken.

#include "core/vec.hpp"
#include "core/view.hpp"

#include <cmath>

namespace noli {

inline constexpr int kMaxHalvings = 60;

struct LineSearch {
    double energy_before = 0.0;
    double slope = 0.0;  ///< g . p
    double rounding =
        0.0;  ///< rounding error of an energy that does not shrink with the energy
    bool may_rise = false;  ///< prescribed vertices move in this iteration: they do work
    int halvings = 0;
    bool noise_accepted = false;

    /// The energy must not rise. A rise within rounding error of the two sums counts as
    /// none if the expected change is itself no larger than that error: then halving
    /// could only chase noise.
    bool accepts(double energy, double alpha) {
        if (!(energy < HUGE_VAL)) return false;
        if (energy <= energy_before || may_rise) return true;
        const double noise =
            rounding + kRounding * (std::fabs(energy) + std::fabs(energy_before));
        const bool within =
            energy - energy_before <= noise && std::fabs(alpha * slope) <= 10.0 * noise;
        noise_accepted = noise_accepted || within;
        return within;
    }

    static constexpr double kRounding =
        1e-13;  ///< of sums of up to 10^7 terms of one sign
};

namespace detail {

template <class Exec>
void trial_point(
    Exec& exec, View<const Vec3d> x, View<const Vec3d> p, double alpha, View<Vec3d> out) {
    exec.for_each(
        "step/trial_point", x.size, [=] NOLI_HD(int i) { out[i] = x[i] + alpha * p[i]; });
}

}  // namespace detail

}  // namespace noli
