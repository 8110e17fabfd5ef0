// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How often a step freezes friction anew: the normal forces and directions that friction
/// is computed with are those of the last minimisation (docs/theory/friction.md).

#include "noli/simulator.hpp"

#include "step/settings.hpp"

namespace noli {

inline constexpr int kMaxFrictionUpdates =
    100;  ///< where friction_iterations = until convergence
inline constexpr int kFrictionUpdatesAsNeeded =
    4;  ///< at most, where friction_iterations = as needed

class FrictionLag {
  public:
    explicit FrictionLag(const StepSettings& settings)
        : asked_(settings.contact.friction_iterations),
          tolerance_(settings.contact.friction_tolerance),
          has_friction_(settings.has_friction) {}

    /// After update number `lag` (0 first) and `iterations` of Newton's method with it:
    /// true if the minimisation is to be repeated. `freeze_again` freezes friction anew
    /// and returns the relative change of the forces of bodies; it is also asked where
    /// that change is only reported.
    template <class FreezeAgain>
    bool again(int lag, int iterations, StepReport& report, FreezeAgain freeze_again) {
        if (!has_friction_) return false;
        if (asked_ == 0 && lag > 0 && iterations == 1) return false;
        const bool is_last = lag + 1 >= most_updates();
        if (asked_ >= 0 && is_last) return false;
        report.lag_change = freeze_again();
        if (is_last) return false;
        return asked_ >= 0 || report.lag_change > tolerance_;
    }

  private:
    [[nodiscard]] int most_updates() const {
        if (asked_ == kFrictionAsNeeded) return kFrictionUpdatesAsNeeded;
        return asked_ > 0 ? asked_ : kMaxFrictionUpdates;
    }

    int asked_;
    double tolerance_;
    bool has_friction_;
};

}  // namespace noli
