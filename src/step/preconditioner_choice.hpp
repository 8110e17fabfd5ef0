// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Sweeps or block Jacobi, from solve to solve. Sweeps take about half the iterations,
/// but order, merge and scale the whole matrix first, which takes as long as a dozen
/// iterations; block Jacobi begins at once, and an iteration takes as long as one of
/// theirs. So block Jacobi is the faster one where few iterations are enough, and how
/// many that will be the solve before it says.
///
/// Deterministic: counts decide, never a clock, and every step begins anew, so that a
/// resumed run takes the same choices. Measured: docs/decisions/012-deflation.md.

#include "linear/pcg_options.hpp"

namespace noli {

class PreconditionerChoice {
  public:
    /// Iterations that sweeps take as long to set up as, and iterations of block Jacobi
    /// per one of theirs.
    static constexpr double kSetup = 12.0;
    static constexpr double kJacobiPerSweep = 2.0;

    void begin_step() { kind_ = PreconditionerKind::GaussSeidel; }

    /// Of the next solve.
    [[nodiscard]] PreconditionerKind kind() const { return kind_; }

    void after_solve(int iterations) {
        const bool jacobi = kind_ == PreconditionerKind::BlockJacobi;
        const double sweeps = iterations / (jacobi ? kJacobiPerSweep : 1.0);
        kind_ = kJacobiPerSweep * sweeps < sweeps + kSetup
                  ? PreconditionerKind::BlockJacobi
                  : PreconditionerKind::GaussSeidel;
    }

  private:
    PreconditionerKind kind_ = PreconditionerKind::GaussSeidel;
};

}  // namespace noli
