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

/// The largest net force of a body over what the tests that ended the step leave to it,
///
///     |F| / (m s / dt^2 + share sum |f|),
///
/// s the largest displacement (m) that was still wanted, f the contact forces (N) of its
/// vertices, of which a `share` may be wrong. At most 1 where "converged" means it.
double unbalanced(const Topology& topology,
                  const std::vector<NetForce>& net,
                  const std::vector<Vector3>& contact_force,
                  double small,
                  double dt,
                  double share);

}  // namespace noli
