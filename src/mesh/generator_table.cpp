// SPDX-License-Identifier: Apache-2.0
#include "mesh/generate.hpp"
#include "mesh/source.hpp"

#include <initializer_list>

namespace noli {

namespace {

using Kind = GeneratorParameter::Kind;
using Parameters = std::vector<GeneratorParameter>;

constexpr double kMost =
    1e6;  // of a length in metres or of a count: beyond it lies a slip of the pen
constexpr double kMostSeed = 2e9;  // fits into int
constexpr const char* kEdgeDoc = "Wished length of an edge.";
constexpr const char* kWallDoc = "Thickness of the wall; 0 makes an open sheet.";

GeneratorParameter length(const char* name,
                          std::vector<double> fallback,
                          const char* doc) {
    return {name, Kind::Length, std::move(fallback), 0, kMost, doc};
}
GeneratorParameter length_or_zero(const char* name, double fallback, const char* doc) {
    return {name, Kind::LengthOrZero, {fallback}, 0, kMost, doc};
}
GeneratorParameter count(const char* name,
                         std::initializer_list<int> fallback,
                         double at_least,
                         double at_most,
                         const char* doc) {
    return {
        name, Kind::Count, {fallback.begin(), fallback.end()}, at_least, at_most, doc};
}
GeneratorParameter number(
    const char* name, double fallback, double at_least, double at_most, const char* doc) {
    return {name, Kind::Number, {fallback}, at_least, at_most, doc};
}
GeneratorParameter split() {
    return count("tets_per_cell",
                 {5},
                 5,
                 6,
                 "Tetrahedra per cell: 5 (rounder) or 6 (all cells alike).");
}

double real(const GeneratorValues& v, const char* name, std::size_t k = 0) {
    return v.at(name).at(k);
}
int whole(const GeneratorValues& v, const char* name, std::size_t k = 0) {
    return static_cast<int>(v.at(name).at(k));
}
Vec3d triple(const GeneratorValues& v, const char* name) {
    return {real(v, name, 0), real(v, name, 1), real(v, name, 2)};
}
std::vector<double> list(const Vec3d& v) {
    return {v.x, v.y, v.z};
}
CellSplit split_of(const GeneratorValues& v) {
    return whole(v, "tets_per_cell") == 6 ? CellSplit::Six : CellSplit::Five;
}

GeneratorEntry box_entry() {
    const BoxParams d;
    return {"box",
            "Box.",
            {length("size", list(d.size), "Extents along x, y, z."),
             count("cells", {d.nx, d.ny, d.nz}, 1, kMost, "Cells along x, y, z."),
             split()},
            [](const GeneratorValues& v) {
                return make_box({triple(v, "size"),
                                 whole(v, "cells", 0),
                                 whole(v, "cells", 1),
                                 whole(v, "cells", 2),
                                 split_of(v)});
            }};
}

GeneratorEntry slab_entry() {
    const SlabParams d;
    return {"slab",
            "Mat: a thin sheet in the xz plane.",
            {length("width", {d.width}, "Extent along x."),
             length("depth", {d.depth}, "Extent along z."),
             length("thickness", {d.thickness}, "Extent along y."),
             count("cells", {d.nx, d.nz}, 1, kMost, "Cells along x and z."),
             count("layers", {d.layers}, 1, kMost, "Cells along y."),
             split()},
            [](const GeneratorValues& v) {
                return make_slab({real(v, "width"),
                                  real(v, "depth"),
                                  real(v, "thickness"),
                                  whole(v, "cells", 0),
                                  whole(v, "cells", 1),
                                  whole(v, "layers"),
                                  split_of(v)});
            }};
}

GeneratorEntry sphere_entry() {
    const SphereParams d;
    return {"sphere",
            "Ball.",
            {length("radius", {d.radius}, "Radius."),
             length("edge_length", {d.edge_length}, kEdgeDoc)},
            [](const GeneratorValues& v) {
                return make_sphere({real(v, "radius"), real(v, "edge_length")});
            }};
}

GeneratorEntry torus_entry() {
    const TorusParams d;
    return {
        "torus",
        "Ring around the y axis.",
        {length("major_radius",
                {d.major_radius},
                "From the axis to the middle of the tube."),
         length("minor_radius", {d.minor_radius}, "Of the tube, less than major_radius."),
         length("edge_length", {d.edge_length}, kEdgeDoc)},
        [](const GeneratorValues& v) {
            return make_torus({real(v, "major_radius"),
                               real(v, "minor_radius"),
                               real(v, "edge_length")});
        }};
}

GeneratorEntry cylinder_entry() {
    const CylinderParams d;
    return {"cylinder",
            "Cylinder along y.",
            {length("radius", {d.radius}, "Radius."),
             length("height", {d.height}, "Extent along y."),
             length("edge_length", {d.edge_length}, kEdgeDoc)},
            [](const GeneratorValues& v) {
                return make_cylinder(
                    {real(v, "radius"), real(v, "height"), real(v, "edge_length")});
            }};
}

GeneratorEntry pebble_entry() {
    const PebbleParams d;
    return {"pebble",
            "Rounded stone: an ellipsoid with smooth random bumps.",
            {length("radii", list(d.radii), "Half axes along x, y, z."),
             number("bumpiness",
                    d.bumpiness,
                    0,
                    0.3,
                    "Height of the bumps relative to the radii."),
             count("seed", {static_cast<int>(d.seed)}, 0, kMostSeed, "Which stone."),
             length("edge_length", {d.edge_length}, kEdgeDoc)},
            [](const GeneratorValues& v) {
                return make_pebble({triple(v, "radii"),
                                    real(v, "bumpiness"),
                                    static_cast<std::uint32_t>(whole(v, "seed")),
                                    real(v, "edge_length")});
            }};
}

GeneratorEntry star_entry() {
    const StarParams d;
    return {
        "star",
        "Puffy star in the xy plane.",
        {length("radius", {d.radius}, "To the tips."),
         length("thickness", {d.thickness}, "Extent along z at the middle."),
         count("arms", {d.arms}, 3, 8, "Number of tips."),
         number("notch", d.notch, 0, 0.7, "Depth of the notches relative to the radius."),
         length("edge_length", {d.edge_length}, kEdgeDoc)},
        [](const GeneratorValues& v) {
            return make_star({real(v, "radius"),
                              real(v, "thickness"),
                              whole(v, "arms"),
                              real(v, "notch"),
                              real(v, "edge_length")});
        }};
}

GeneratorEntry knot_entry() {
    const KnotParams d;
    return {
        "knot",
        "Tube along a torus knot around the y axis; the default is the trefoil.",
        {count("p", {d.p}, 1, 5, "Turns around the axis; coprime to q."),
         count("q", {d.q}, 1, 7, "Turns around the ring."),
         length("radius", {d.radius}, "Of the ring that the tube winds about."),
         length(
             "tube_radius", {d.tube_radius}, "Of the tube, which must not touch itself."),
         length("edge_length", {d.edge_length}, kEdgeDoc)},
        [](const GeneratorValues& v) {
            return make_knot({whole(v, "p"),
                              whole(v, "q"),
                              real(v, "radius"),
                              real(v, "tube_radius"),
                              real(v, "edge_length")});
        }};
}

GeneratorEntry plane_surface_entry() {
    const PlaneSurfaceParams d;
    return {"plane_surface",
            "Obstacle: a rectangle in the xz plane, turned upwards.",
            {length("width", {d.width}, "Extent along x."),
             length("depth", {d.depth}, "Extent along z."),
             count("cells", {d.nx, d.nz}, 1, kMost, "Cells along x and z.")},
            [](const GeneratorValues& v) {
                return make_plane_surface({real(v, "width"),
                                           real(v, "depth"),
                                           whole(v, "cells", 0),
                                           whole(v, "cells", 1)});
            }};
}

GeneratorEntry box_surface_entry() {
    const BoxSurfaceParams d;
    return {"box_surface",
            "Obstacle: the surface of a box.",
            {length("size", list(d.size), "Extents along x, y, z."),
             count("cells", {d.nx, d.ny, d.nz}, 1, kMost, "Cells along x, y, z.")},
            [](const GeneratorValues& v) {
                return make_box_surface({triple(v, "size"),
                                         whole(v, "cells", 0),
                                         whole(v, "cells", 1),
                                         whole(v, "cells", 2)});
            }};
}

GeneratorEntry sphere_surface_entry() {
    const SphereSurfaceParams d;
    return {"sphere_surface",
            "Obstacle: the surface of a ball.",
            {length("radius", {d.radius}, "Radius."),
             length("edge_length", {d.edge_length}, kEdgeDoc)},
            [](const GeneratorValues& v) {
                return make_sphere_surface({real(v, "radius"), real(v, "edge_length")});
            }};
}

GeneratorEntry tube_surface_entry() {
    const TubeSurfaceParams d;
    return {
        "tube_surface",
        "Obstacle: a cylinder along y, closed, or an open sheet, or a pipe with a wall.",
        {length("radius", {d.radius}, "Outer radius."),
         length("height", {d.height}, "Extent along y."),
         length("edge_length", {d.edge_length}, kEdgeDoc),
         {"capped",
          Kind::Flag,
          {d.capped ? 1.0 : 0.0},
          0,
          1,
          "Whether flat ends close it; not with a wall."},
         length_or_zero("wall", d.wall, kWallDoc)},
        [](const GeneratorValues& v) {
            return make_tube_surface({real(v, "radius"),
                                      real(v, "height"),
                                      real(v, "edge_length"),
                                      whole(v, "capped") != 0,
                                      real(v, "wall")});
        }};
}

GeneratorEntry funnel_surface_entry() {
    const FunnelSurfaceParams d;
    return {"funnel_surface",
            "Obstacle: a cone along y, open at both ends, with a spout below.",
            {length("top_radius", {d.top_radius}, "Inner radius above."),
             length_or_zero("bottom_radius",
                            d.bottom_radius,
                            "Inner radius below; 0 closes it with a tip."),
             length("height", {d.height}, "Of the cone."),
             length_or_zero("spout_height", d.spout_height, "Of the spout."),
             length_or_zero("wall", d.wall, kWallDoc),
             length("edge_length", {d.edge_length}, kEdgeDoc)},
            [](const GeneratorValues& v) {
                return make_funnel_surface({real(v, "top_radius"),
                                            real(v, "bottom_radius"),
                                            real(v, "height"),
                                            real(v, "spout_height"),
                                            real(v, "wall"),
                                            real(v, "edge_length")});
            }};
}

GeneratorEntry bowl_surface_entry() {
    const BowlSurfaceParams d;
    return {"bowl_surface",
            "Obstacle: the part of a sphere below a horizontal plane, open above.",
            {length("radius", {d.radius}, "Outer radius."),
             number("angle_deg",
                    d.angle,
                    1,
                    170,
                    "From the bottom to the rim, in degrees; 90 is half a sphere."),
             length_or_zero("wall", d.wall, kWallDoc),
             length("edge_length", {d.edge_length}, kEdgeDoc)},
            [](const GeneratorValues& v) {
                return make_bowl_surface({real(v, "radius"),
                                          real(v, "angle_deg"),
                                          real(v, "wall"),
                                          real(v, "edge_length")});
            }};
}

}  // namespace

const std::vector<GeneratorEntry>& generator_table() {
    static const std::vector<GeneratorEntry> table{box_entry(),
                                                   slab_entry(),
                                                   sphere_entry(),
                                                   torus_entry(),
                                                   cylinder_entry(),
                                                   pebble_entry(),
                                                   star_entry(),
                                                   knot_entry(),
                                                   plane_surface_entry(),
                                                   box_surface_entry(),
                                                   sphere_surface_entry(),
                                                   tube_surface_entry(),
                                                   funnel_surface_entry(),
                                                   bowl_surface_entry()};
    return table;
}

const GeneratorEntry* find_generator(const std::string& name) {
    for (const GeneratorEntry& entry : generator_table())
        if (name == entry.name) return &entry;
    return nullptr;
}

}  // namespace noli
