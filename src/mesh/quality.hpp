// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Scale-free measures of element shape, and their statistics over a mesh.

#include "mesh/mesh.hpp"

namespace noli {

/// 3 r_in / R_circum, signed like the volume: 1 for a regular tetrahedron, 0 for a flat
/// one.
double radius_ratio(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);

/// 2 r_in / R_circum: 1 for an equilateral triangle, 0 for a flat one.
double radius_ratio(const Vec3d& a, const Vec3d& b, const Vec3d& c);

/// Volume over that of a regular tetrahedron with the longest edge as its edge; signed.
///     6 sqrt(2) V / l_max^3
double relative_volume(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);

/// Smallest and largest of the six dihedral angles, degrees; (0, 180) for a flat
/// tetrahedron.
struct AngleRange {
    double lo, hi;
};
AngleRange dihedral_angles(const Vec3d& a,
                           const Vec3d& b,
                           const Vec3d& c,
                           const Vec3d& d);

/// Of the tetrahedra if the mesh has any, else of the triangles, else of the segments.
struct MeshQuality {
    Vec3d lo{0, 0, 0}, hi{0, 0, 0};  ///< bounding box of all vertices, m
    double volume = 0;               ///< signed sum over tetrahedra, m^3
    double area = 0;                 ///< boundary or triangles, m^2
    double min_edge = 0, mean_edge = 0, max_edge = 0;    ///< m
    double min_radius_ratio = 0, mean_radius_ratio = 0;  ///< 1 is best
    double min_dihedral = 0, max_dihedral = 0;           ///< degrees; tetrahedra only
    int worst_element = -1;                              ///< with min_radius_ratio
};

/// Indices must be in range and coordinates finite.
MeshQuality mesh_quality(const Mesh& mesh);

}  // namespace noli
