// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The one in-memory form of every mesh file and generator.

#include "core/vec.hpp"

#include <vector>

namespace noli {

/// Vertices and the elements on them; indices count from 0 into x. A cloud of points has
/// x alone: then all of them count.
struct Mesh {
    std::vector<Vec3d> x;    ///< vertex positions, m
    std::vector<Int4> tets;  ///< positive volume when (x1-x0) x (x2-x0) . (x3-x0) > 0
    std::vector<Int3> triangles;  ///< counterclockwise seen from outside
    std::vector<Int2> segments;
    std::vector<int> points;  ///< vertices that count for themselves beside elements
};

/// What a mesh is used as, and so which of its elements count.
enum class MeshRole { Solid /*tets*/, Surface /*triangles*/, Segments, Points };

/// Segments and points beside triangles count in a Surface, points beside segments too.
/// The role of the highest-dimensional elements that the mesh has.
inline MeshRole natural_role(const Mesh& mesh) {
    if (!mesh.tets.empty()) return MeshRole::Solid;
    if (!mesh.triangles.empty()) return MeshRole::Surface;
    return mesh.segments.empty() ? MeshRole::Points : MeshRole::Segments;
}

/// "tetrahedra", "triangles", "segments" or "points".
inline const char* element_name(MeshRole role) {
    constexpr const char* kNames[] = {"tetrahedra", "triangles", "segments", "points"};
    return kNames[static_cast<int>(role)];
}

}  // namespace noli
