// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Which vertices a boundary condition holds.

#include "mesh/mesh.hpp"
#include "model/model.hpp"

#include <string>
#include <vector>

namespace noli {

/// A body on its way into the model.
struct PlacedBody {
    const Mesh& mesh;                  ///< topology; positions are placed
    const std::vector<Vec3d>& file_x;  ///< positions as in the file, before the transform
    const std::vector<Vec3d>& x;       ///< of all bodies so far, placed
    int first;                         ///< index of this body's first vertex in x
};

/// Centre of the bounding box of x[first, first + count).
Vec3d bounding_box_center(const std::vector<Vec3d>& x, int first, int count);

/// Finds the vertices of a condition and loads its mesh sequence.
Result<ModelCondition> make_condition(const BoundaryCondition& what,
                                      const PlacedBody& body,
                                      const std::string& where,
                                      const std::string& base_folder);

}  // namespace noli
