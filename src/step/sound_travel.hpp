// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How far stiffness reaches within a time step: what decides whether sweeps over the
/// vertices are enough or the linear solver needs a coarse space.

#include "model/model.hpp"

namespace noli {

/// Above this sound travel the coarse space saves more than it costs. Measured: at 0.13
/// and 0.18 sweeps alone are 1.5 to 2 times faster, at 0.4 the coarse space is, at 4 it
/// saves nine tenths of the solve.
inline constexpr double kCoarseSoundTravel = 0.3;
inline constexpr int kCoarseVertices = 256;  ///< fewer are not worth it

/// Largest dt sqrt(E / rho) / L over the elastic bodies, L the largest extent of the body.
/// E is the Young modulus of its stiffest tetrahedron, rho its mean density.
double sound_travel(const Model& model, double dt);

}  // namespace noli
