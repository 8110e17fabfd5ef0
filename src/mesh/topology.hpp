// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Who touches whom: surfaces, edges, components. Indices must be in range (see
/// check.hpp); every result has one fixed order, whatever the machine.

#include "mesh/mesh.hpp"

#include <cstdint>
#include <vector>

namespace noli {

/// Faces that belong to exactly one tetrahedron, counterclockwise seen from outside if
/// the tetrahedra are positive; in the order of the tetrahedra.
std::vector<Int3> boundary_triangles(const std::vector<Int4>& tets);

/// The four faces of a tetrahedron, each counterclockwise seen from outside; face k lies
/// opposite corner k.
inline constexpr int kTetFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

/// Every edge once, as (smaller, larger), sorted.
std::vector<Int2> unique_edges(const std::vector<Int3>& triangles);
std::vector<Int2> unique_edges(const std::vector<Int4>& tets);

/// Vertices that the elements use, sorted.
std::vector<int> used_vertices(const std::vector<Int4>& tets);
std::vector<int> used_vertices(const std::vector<Int3>& triangles);
std::vector<int> used_vertices(const std::vector<Int2>& segments);

/// Per vertex: 1 if it belongs to an element of the mesh's natural role, or to a cloud of
/// points. The others have no part in a body: not in its box, not in its motion.
std::vector<std::uint8_t> referenced_vertices(const Mesh& mesh);

/// Segments that are no edges of triangles.
std::vector<Int2> loose_segments(const Mesh& mesh);

/// first[i] is the smallest index whose coordinates equal those of i (-0 equals 0); no
/// NaN allowed.
std::vector<int> first_equal_vertex(const std::vector<Vec3d>& x);

struct Components {
    int count = 0;
    std::vector<int>
        of_vertex;  ///< component of each vertex, numbered by smallest vertex index
};

/// Vertices joined by elements of any kind; a vertex without element is its own
/// component.
Components connected_components(const Mesh& mesh);

/// Signed volume of a tetrahedron, m^3.
inline double tet_volume(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    return dot(cross(b - a, c - a), d - a) / 6.0;
}
/// Signed volume of each tetrahedron, m^3.
std::vector<double> tet_volumes(const Mesh& mesh);

/// Drops vertices that no element uses. Returns the old index of each vertex that stays.
std::vector<int> drop_unreferenced_vertices(Mesh& mesh);

}  // namespace noli
