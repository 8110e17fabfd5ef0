// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A frame: the simulated bodies at one time, as arrays. docs/frame-format.md describes
/// the files.

#include "noli/scene.hpp"

#include <array>
#include <span>
#include <string>
#include <vector>

namespace noli {

/// What stays the same in all frames of a run. Vertices are numbered through all bodies.
struct FrameMesh {
    std::span<const std::array<int, 4>> tets;
    std::span<const std::array<int, 3>> triangles;  ///< surfaces of tets, and obstacles
    std::span<const std::array<int, 2>> segments;   ///< of obstacles
    std::span<const int> body_of_vertex;
    std::span<const std::string> body_names;
    std::span<const Vector3> initial_positions;  ///< m; displacements count from here
    std::span<const int> unreferenced;  ///< vertices without an element, ascending
};

/// What changes. Empty spans are left out of the files.
struct Frame {
    int step = 0;
    double time = 0.0;                              ///< s
    std::span<const Vector3> positions;             ///< m
    std::span<const Vector3> velocities;            ///< m/s
    std::span<const Vector3> contact_force;         ///< N
    std::span<const double> von_mises;              ///< per tet, Pa
    std::span<const std::array<double, 9>> stress;  ///< per tet, Cauchy, row-major, Pa
};

/// True for bodies that have tetrahedra; one entry per body.
std::vector<bool> elastic_bodies(const FrameMesh& mesh);

/// Vertices that no tetrahedron, triangle or segment uses, of bodies without tetrahedra,
/// and that are not unreferenced: the points of point obstacles. Ascending.
std::vector<int> lone_points(const FrameMesh& mesh);

/// "frame_000012.vtu" for step 12 and "vtu".
std::string frame_file_name(int step, const std::string& extension);

/// Step number of such a name, or -1.
int step_of_frame_file(const std::string& name);

}  // namespace noli
