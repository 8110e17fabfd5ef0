// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How far stiffness reaches within a time step: what decides whether sweeps over the
/// vertices are enough or the linear solver needs a coarse space.

#include "model/model.hpp"

#include <string>

namespace noli {

/// Above this sound travel the coarse space saves more than it costs. Measured: sweeps
/// alone are faster at 1.5 to 9.2, the coarse space is at 20 and above.
inline constexpr double kCoarseSoundTravel = 14.0;
/// The same on a device, where block Jacobi stands in for sweeps and needs two to three
/// times their iterations: on real systems rigid motions take off 7 % of them at 1.5, and
/// more than half at 7.8 (tests/unit/linear/real_systems_test.cpp).
inline constexpr double kDeviceCoarseSoundTravel = 3.0;
inline constexpr int kCoarseVertices = 256;  ///< fewer are not worth it

/// Largest dt sqrt(E / rho) / L over the elastic bodies, L the largest extent of the
/// body. E is the Young modulus of its stiffest tetrahedron, rho its mean density.
double sound_travel(const Model& model, double dt);

/// Whether the linear solver uses rigid motions of aggregates as a coarse space.
bool wants_coarse_space(const Model& model, double dt, bool on_device = false);

/// Vertices per aggregate of the coarse space on the CPU. IC(0) pays for more of them.
int aggregate_size_for(int num_vertices, LinearSolver linear);

/// The linear solver of a scene in words, and why it is that one.
std::string describe_linear_solver(const Model& model,
                                   LinearSolver asked,
                                   double dt,
                                   bool on_device);

}  // namespace noli
