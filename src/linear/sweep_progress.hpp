// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Where an iteration of SweepCg (sweep_cg.hpp) stands: its scalars.

#include "linear/sweeps.hpp"

namespace noli {

/// `rr` is r.P⁻¹r of the local preconditioner P; with a coarse space r.z is the same,
/// because residuals are orthogonal to it.
struct SweepProgress {
    double rr = 0.0;        ///< IC(0): of the residual before the last step
    double first = 0.0;     ///< rr at the start, and `coarse`
    double coarse = 0.0;    ///< what the coarse start lowered the energy by, twice
    double last = 0.0;      ///< the rr that the last direction was made from; 0: none
    double alpha = 0.0;     ///< of the step that x, r still have to take
    double beta = 0.0;      ///< of the sweeps alone
    double decrease = 0.0;  ///< of the last step: alpha r.p

    [[nodiscard]] double ratio() const { return first > 0.0 ? rr / first : 0.0; }

    /// beta of the next direction from r.P⁻¹r; false when there is none.
    bool begin_direction(double square) {
        alpha = 0.0;
        if (!(square > 0.0)) {
            rr = square;
            decrease = 0.0;
            return false;
        }
        beta = last > 0.0 ? square / last : 0.0;
        last = square;
        return true;
    }

    /// The step along p that lowers the energy most.
    bool take_step(const detail::SweepSums& sums) {
        if (!(sums.pq > 0.0)) return false;
        alpha = sums.rp / sums.pq;
        decrease = alpha * sums.rp;
        return true;
    }
};

}  // namespace noli
