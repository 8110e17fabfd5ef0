// SPDX-License-Identifier: Apache-2.0
#pragma once
/// When prescribed vertices move, when they wait, and how exactly the direction is solved
/// for.
///
/// While they move, a line search on the energy has no say (they do work), so a motion
/// that is cut short by a collision must not be repeated blindly: it would squeeze the
/// same gap again and again. After a short move the free vertices relax first, in plain
/// Newton iterations. A right-hand side with moving vertices is dominated by their stiff
/// contacts, and PCG's relative test would end with everything else unsolved: such
/// systems, and those after a short step, are solved more exactly.

#include "noli/simulator.hpp"

#include <algorithm>

namespace noli {

class BoundaryPace {
  public:
    [[nodiscard]] bool moves() const { return relax_ == 0; }

    /// PCG tolerance (on squared norms) of the next system.
    [[nodiscard]] double tolerance(double usual, bool boundary_moves) const {
        const double factor = (boundary_moves ? kMovingFactor : 1.0) * exactness_;
        return std::max(usual * factor, std::min(usual, kTightest));
    }

    /// Whether the last iteration went all its way.
    [[nodiscard]] bool full_step() const { return full_step_; }

    void add(const IterationRecord& record) {
        full_step_ = record.step == 1.0;
        exactness_ = record.step < kPoorStep ? kMovingFactor * exactness_ : 1.0;
        if (record.boundary_moved) {
            short_moves_ += record.step < kShortMove ? 1 : 0;
            relax_ = record.step < kShortMove ? kMostRelaxing : 0;
        } else if (relax_ > 0) {
            relax_ = record.step >= kShortMove ? 0 : relax_ - 1;
        }
    }

    /// True once the motion has been cut short often enough to call it blocked.
    [[nodiscard]] bool blocked() const { return short_moves_ >= kShortMovesToYield; }

    /// After a line search that found nothing: true if a more exact direction is worth a
    /// try.
    bool retry_more_exactly() {
        if (exactness_ <= kLeastExactness) return false;
        exactness_ *= kMovingFactor;
        return true;
    }

  private:
    static constexpr double kShortMove =
        0.5;  ///< step length of a move that was cut short
    static constexpr double kPoorStep =
        0.01;  ///< step length that suggests a poor direction
    static constexpr int kMostRelaxing =
        20;  ///< plain iterations between two moves at most
    static constexpr double kMovingFactor = 1e-3;
    static constexpr double kLeastExactness = 1e-9;
    static constexpr double kTightest = 1e-20;
    static constexpr int kShortMovesToYield = 6;
    int relax_ = 0;
    int short_moves_ = 0;
    bool full_step_ = false;
    double exactness_ = 1.0;
};

}  // namespace noli
