// SPDX-License-Identifier: Apache-2.0
#pragma once
/// When the elastic Hessian is taken as it is, and when projected element by element.
///
/// A projected Hessian is always positive definite, and too stiff wherever the energy is
/// concave in part: near the end of a step Newton's method then takes off a constant
/// share of what is left in each iteration, and the direction that it is judged by is a
/// fraction of the way still to go. The exact Hessian has neither fault, but need not be
/// positive definite. So it is tried after every full step; where the linear solver finds
/// negative curvature, that system is solved with the projected one, and the next tries
/// wait, twice as long each time. Source: [Longva2023] (projection on demand).

#include <algorithm>

namespace noli {

class ProjectionOnDemand {
  public:
    /// `always`: project every time.
    void begin(bool always) {
        *this = {};
        always_ = always;
    }

    /// Whether the next Hessian is tried without projection.
    bool exact() {
        if (always_ || !full_step_) return false;
        if (wait_ == 0) return true;
        --wait_;
        return false;
    }

    /// The exact Hessian of this iteration was not positive definite.
    void broke_down() {
        wait_ = delay_;
        delay_ = std::min(2 * delay_, kLongestDelay);
    }

    /// The iteration went `step` along its direction.
    void took(double step, bool boundary_moved) {
        full_step_ = step == 1.0 && !boundary_moved;
    }

  private:
    static constexpr int kLongestDelay = 64;
    bool always_ = false;
    bool full_step_ = false;  ///< the last iteration took one
    int wait_ = 0;            ///< iterations until the next try
    int delay_ = 2;           ///< of the next breakdown
};

}  // namespace noli
