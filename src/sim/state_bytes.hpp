// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The complete state of a simulation as bytes, for checkpoints and hashes.

#include "noli/result.hpp"

#include "step/stepper.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace noli {

std::vector<std::byte> encode_state(const StepState& state);

/// Fails with BadCheckpoint when sizes do not fit `num_vertices` and `num_conditions`.
Result<StepState> decode_state(std::span<const std::byte> bytes,
                               int num_vertices,
                               int num_conditions);

}  // namespace noli
