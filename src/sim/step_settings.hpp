// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "model/model.hpp"
#include "step/settings.hpp"

namespace noli {

/// What the step room needs to know of a scene: all that a Stepper is built with besides
/// the model.
StepSettings step_settings(const Scene& scene,
                           const Model& model,
                           bool record_iterations = false);

}  // namespace noli
