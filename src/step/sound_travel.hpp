// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How far stiffness reaches within a time step: what decides how large the rigid pieces
/// of the linear solver's coarse space are.
///
/// There is always a coarse space: with the rigid motions of every connected piece in it,
/// what conjugate gradients leave of the residual has no net force and no net torque on
/// any free piece, whenever they stop. Estimates of the error made of the iteration's own
/// coefficients cannot see a rigid motion of a stiff body before it has been found.

#include "model/model.hpp"

#include <string>

namespace noli {

/// Above this sound travel small pieces save more iterations than they cost. Measured:
/// sweeps alone are faster at 1.5 to 9.2, small pieces are at 20 and above.
inline constexpr double kSmallPieceSoundTravel = 14.0;
/// Vertices per piece below it: whole bodies, and large ones in few pieces, so that all
/// threads have some.
inline constexpr int kLargePiece = 1024;

/// Largest dt sqrt(E / rho) / L over the elastic bodies, L the largest extent of the
/// body. E is the Young modulus of its stiffest tetrahedron, rho its mean density.
double sound_travel(const Model& model, double dt);

/// Vertices per rigid piece of the coarse space, about.
int piece_size(const Model& model, double dt, LinearSolver linear, bool on_device);

/// The linear solver of a scene in words, and why it is that one.
std::string describe_linear_solver(const Model& model,
                                   LinearSolver asked,
                                   double dt,
                                   bool on_device);

}  // namespace noli
