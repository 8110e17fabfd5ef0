// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How far stiffness reaches within a time step: what decides whether the linear solver
/// has a coarse space of rigid motions, at any number of vertices.
///
/// With the rigid motions of every connected piece in it, what conjugate gradients leave
/// of the residual has no net force and no net torque on any free piece, whenever they
/// stop. Estimates of the error made of the iteration's own coefficients cannot see a
/// rigid motion of a stiff body before it has been found; of soft ones they do, and where
/// nothing touches them those move by inertia anyway (retraction.hpp).

#include "model/model.hpp"

#include <string>

namespace noli {

/// Up to this sound travel sweeps alone are faster. Measured: at 1.5 to 9.2 they are, at
/// 20 and above rigid motions save more iterations than they cost.
inline constexpr double kSoftSoundTravel = 14.0;

/// Largest dt sqrt(E / rho) / L over the elastic bodies, L the largest extent of the
/// body. E is the Young modulus of its stiffest tetrahedron, rho its mean density.
double sound_travel(const Model& model, double dt);

/// Vertices per rigid piece of the coarse space, about; 0: there is none.
int piece_size(const Model& model, double dt, LinearSolver linear, bool on_device);

/// The linear solver of a scene in words, and why it is that one.
std::string describe_linear_solver(const Model& model,
                                   LinearSolver asked,
                                   double dt,
                                   bool on_device);

}  // namespace noli
