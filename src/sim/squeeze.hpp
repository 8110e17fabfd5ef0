// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "model/model.hpp"
#include "sim/verify.hpp"

#include <string>
#include <vector>

namespace noli {

/// Where a step failed because moving obstacles leave a body no room: which body, between
/// what, and what to do. Empty if that is not what the gaps at the end of the step say.
/// `gaps`: Verifier::gaps there.
std::string describe_squeeze(const Model& model, const std::vector<BodyGap>& gaps);

}  // namespace noli
