// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What can be seen wrong in a scene before its first step, besides intersections. Each
/// function appends what it found: an error cannot run, a warning may go wrong or is
/// probably not meant.

#include "noli/simulator.hpp"

#include "model/model.hpp"
#include "sim/verify.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace noli {

using Findings = std::vector<Finding>;

/// dhat against edges, bodies and the rounding of coordinates.
void check_lengths(const Scene& scene, const Model& model, Findings& out);

/// Stiffness and density that look like other units; bodies that cannot carry themselves.
void check_materials(const Scene& scene, const Model& model, Findings& out);

/// The worst element; whether anything moves, and is stopped.
void check_shapes(const Model& model, Findings& out);
void check_boundary(const Scene& scene, const Model& model, Findings& out);

/// Bodies that touch, all but touch, or throw each other apart. `gaps`: Verifier::gaps of
/// the start.
void check_gaps(const Scene& scene,
                const Model& model,
                const std::vector<BodyGap>& gaps,
                Findings& out);

/// Solids inside of solids. The start must be free of intersections.
void check_nested(const Model& model, Findings& out);

/// Obstacles that overlap each other.
void check_obstacles(const Model& model, Verifier& verifier, Findings& out);

/// All of these but the obstacles, for a start without intersections; errors first, then
/// warnings, then notes.
Findings check_start(const Scene& scene, const Model& model, Verifier& verifier);

/// The body of the scene that each body of the model is, or is a copy of.
std::vector<std::size_t> scene_body_of(const Scene& scene);

/// Whether a boundary condition moves vertices of the body, ever.
bool is_moved(const Model& model, int body);

/// Mass of each body of the model, kg; 0 for obstacles.
std::vector<double> body_masses(const Model& model);

/// Sides of the box around each body of the model, m, without vertices that no
/// tetrahedron uses.
std::vector<Vec3d> body_sizes(const Model& model);

/// "vertex 3 of "a" and triangle 4 5 6 of "b"".
std::string describe_pair(const Model& model, const MinGap& pair);

}  // namespace noli
