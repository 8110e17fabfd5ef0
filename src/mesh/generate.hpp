// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Meshes from a few numbers. Lengths in m; every body is centred at the origin with y
/// up, and the same parameters always give the same mesh.
///
/// Solids have positive tetrahedra and one closed manifold surface; no vertex is unused.
/// Curved ones take `edge_length`, the wished length of an edge. Errors: InvalidScene,
/// naming the parameter, when it is not finite, out of range, or asks for more than
/// kMaxGeneratedElements.

#include "noli/result.hpp"

#include "mesh/mesh.hpp"

#include <cstdint>

namespace noli {

/// Above this a generator refuses: surely a slip of the pen.
inline constexpr double kMaxGeneratedElements = 2e7;

/// How a box cell becomes tetrahedra: five (mirrored from cell to cell, rounder elements)
/// or six (all cells alike).
enum class CellSplit { Five, Six };

struct BoxParams {
    Vec3d size{1, 1, 1};         ///< extents, m, > 0
    int nx = 4, ny = 4, nz = 4;  ///< cells per axis, >= 1
    CellSplit split = CellSplit::Five;
};

/// A thin sheet lying in the xz plane.
struct SlabParams {
    double width = 1.0, depth = 1.0;   ///< along x and z, m, > 0
    double thickness = 0.05;           ///< along y, m, > 0
    int nx = 16, nz = 16, layers = 1;  ///< cells, >= 1
    CellSplit split = CellSplit::Five;
};

struct SphereParams {
    double radius = 0.5;       ///< m, > 0
    double edge_length = 0.1;  ///< m, in (0, radius]
};

/// A ring around the y axis.
struct TorusParams {
    double major_radius = 0.4, minor_radius = 0.15;  ///< m, 0 < minor < major
    double edge_length = 0.075;                      ///< m, in (0, minor_radius]
};

/// A cylinder along y with sharp rims.
struct CylinderParams {
    double radius = 0.25, height = 1.0;  ///< m, > 0
    double edge_length = 0.1;            ///< m, in (0, radius]
};

/// A rounded stone: an ellipsoid with smooth random bumps.
struct PebbleParams {
    Vec3d radii{0.5, 0.35, 0.4};  ///< m, > 0
    double bumpiness = 0.15;  ///< height of the bumps relative to the radii, in [0, 0.3]
    std::uint32_t seed = 1;   ///< which stone
    double edge_length = 0.08;  ///< m, in (0, smallest radius]
};

/// A puffy star in the xy plane.
struct StarParams {
    double radius = 0.5;        ///< to the tips, m, > 0
    double thickness = 0.3;     ///< along z at the middle, m, in (0, 2 radius]
    int arms = 5;               ///< in 3..8
    double notch = 0.5;         ///< depth of the notches between the arms relative to the
                                ///< radius, in [0, 0.7]
    double edge_length = 0.07;  ///< m, in (0, thickness / 2]
};

/// A tube along the torus knot (p, q) around the y axis; (2, 3) is the trefoil.
struct KnotParams {
    int p = 2, q = 3;     ///< coprime, p in 1..5 turns around the axis, q in 1..7
    double radius = 0.5;  ///< of the ring that the tube winds about at 0.4 of it, m, > 0
    double tube_radius =
        0.07;  ///< m, > 0, small enough that the tube does not touch itself
    double edge_length = 0.035;  ///< m, in (0, tube_radius]
};

Result<Mesh> make_box(const BoxParams& params = {});
Result<Mesh> make_slab(const SlabParams& params = {});
Result<Mesh> make_sphere(const SphereParams& params = {});
Result<Mesh> make_torus(const TorusParams& params = {});
Result<Mesh> make_cylinder(const CylinderParams& params = {});
Result<Mesh> make_pebble(const PebbleParams& params = {});
Result<Mesh> make_star(const StarParams& params = {});
Result<Mesh> make_knot(const KnotParams& params = {});

// Surfaces for obstacles: triangles only. Closed ones turn outwards; open sheets as said
// at each.

/// A rectangle in the xz plane, turned upwards.
struct PlaneSurfaceParams {
    double width = 1.0, depth = 1.0;  ///< along x and z, m, > 0
    int nx = 1, nz = 1;               ///< cells, >= 1
};
struct BoxSurfaceParams {
    Vec3d size{1, 1, 1};         ///< extents, m, > 0
    int nx = 1, ny = 1, nz = 1;  ///< cells per axis, >= 1
};
struct SphereSurfaceParams {
    double radius = 0.5;       ///< m, > 0
    double edge_length = 0.1;  ///< m, > 0
};
/// A cylinder along y: closed by flat ends, or an open sheet, or a pipe with a wall.
struct TubeSurfaceParams {
    double radius = 0.25, height = 1.0;  ///< outer, m, > 0
    double edge_length = 0.1;            ///< m, > 0
    bool capped = true;                  ///< flat ends; must be false with a wall
    double wall = 0.0;  ///< thickness of a pipe's wall, m, in [0, radius); 0: a sheet
                        ///< turned outwards
};
/// A cone along y, open at both ends, with a spout below; bottom_radius 0 without spout
/// is a cone with a tip.
struct FunnelSurfaceParams {
    double top_radius = 0.5, bottom_radius = 0.1;  ///< inner, m, > 0 and >= 0
    double height = 0.5,
           spout_height = 0.1;  ///< of the cone and the spout, m, > 0 and >= 0
    double wall = 0.0;          ///< thickness, m, >= 0; 0: a sheet turned outwards
    double edge_length = 0.1;   ///< m, > 0
};
/// The part of a sphere below a horizontal plane, open above.
struct BowlSurfaceParams {
    double radius = 0.5;  ///< outer, m, > 0
    double angle =
        90.0;  ///< from the bottom to the rim, degrees, in (0, 170]; 90 is half a sphere
    double wall = 0.0;  ///< thickness, m, in [0, radius); 0: a sheet turned outwards
    double edge_length = 0.1;  ///< m, > 0
};

Result<Mesh> make_plane_surface(const PlaneSurfaceParams& params = {});
Result<Mesh> make_box_surface(const BoxSurfaceParams& params = {});
Result<Mesh> make_sphere_surface(const SphereSurfaceParams& params = {});
Result<Mesh> make_tube_surface(const TubeSurfaceParams& params = {});
Result<Mesh> make_funnel_surface(const FunnelSurfaceParams& params = {});
Result<Mesh> make_bowl_surface(const BowlSurfaceParams& params = {});

}  // namespace noli
