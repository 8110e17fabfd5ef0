// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What a step has left unbalanced: sums of the residual forces over each body.

#include "noli/simulator.hpp"

#include "model/model.hpp"
#include "sim/engine.hpp"

namespace noli {

/// Per body; 0 of obstacles and of bodies with prescribed vertices, which their supports
/// hold. The torque is about the centre of mass.
std::vector<NetForce> net_forces(const Model& model,
                                 const std::vector<Vec3d>& x,
                                 const Residual& residual);

}  // namespace noli
