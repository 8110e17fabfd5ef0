// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Which vertices a boundary condition holds.

#include "mesh/mesh.hpp"
#include "model/model.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace noli {

/// A body on its way into the model.
struct PlacedBody {
    const Mesh& mesh;                  ///< topology; positions are placed
    const std::vector<Vec3d>& file_x;  ///< positions as in the file, before the transform
    const std::vector<Vec3d>& x;       ///< of all bodies so far, placed
    const std::vector<std::uint8_t>& used;  ///< per vertex: referenced_vertices
    int first;                              ///< index of this body's first vertex in x
};

/// Centre of the bounding box of those x[first + v] for which used[v] is set.
Vec3d used_box_center(const std::vector<Vec3d>& x,
                      int first,
                      const std::vector<std::uint8_t>& used);

/// Finds the vertices of a condition; those without an element are never among them. Its
/// mesh sequence: load_sequences.
Result<ModelCondition> make_condition(const BoundaryCondition& what,
                                      const PlacedBody& body,
                                      const std::string& where);

}  // namespace noli
