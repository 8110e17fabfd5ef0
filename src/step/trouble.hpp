// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Words for what limits or ends a step: ids and numbers that a user can act on.

#include "noli/simulator.hpp"

#include "contact/step_bound.hpp"
#include "model/model.hpp"

#include <string>

namespace noli {

/// "tet 118 of 'ball'"
std::string describe_tet(const Model& model, int tet);

/// "pair EE 12 13 | 40 41 of 'a' and 'b'"
std::string describe_bound(const Model& model, const StepBound& bound);

/// Of a step that ended without knowing which of its pairs stick: the vertices of one,
/// unused ones -1.
std::string describe_undecided(const Model& model, const Int4& vertices);

std::string describe_not_finite(double direction, double energy, int iteration);
std::string describe_failed_search(const IterationRecord& record);

inline constexpr double kShortStepLength =
    1e-4;  ///< step length that counts as no progress

/// Counts iterations that make no progress, and remembers what limits them.
struct StallDetector {
    int short_steps = 0;
    IterationRecord last;

    void add(const IterationRecord& record);
    [[nodiscard]] std::string describe() const;
};

}  // namespace noli
