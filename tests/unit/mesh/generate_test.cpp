// SPDX-License-Identifier: Apache-2.0
#include "mesh/generate.hpp"

#include "mesh/check.hpp"
#include "mesh/implicit.hpp"
#include "mesh/topology.hpp"
#include "unit/mesh/test_files.hpp"

#include <limits>
#include <map>
#include <numbers>

namespace noli {
namespace {

constexpr double kPi = std::numbers::pi;

Mesh fine(Result<Mesh> result) {
    if (!result) {
        ADD_FAILURE() << result.error().where << ": " << result.error().message;
        return {};
    }
    return std::move(result.value());
}

/// What every solid promises. euler: V - E + F of its surface.
MeshQuality expect_solid(const Mesh& mesh,
                         double min_dihedral,
                         double min_ratio,
                         int euler = 2) {
    const MeshReport report =
        check_mesh(mesh, MeshRole::Solid, {.duplicate_vertices_are_errors = true});
    for (const auto* issues : {&report.errors, &report.warnings})
        for (const MeshIssue& issue : *issues)
            ADD_FAILURE() << issue.message;
    EXPECT_GE(report.quality.min_dihedral, min_dihedral);
    EXPECT_GE(report.quality.min_radius_ratio, min_ratio);
    EXPECT_EQ(connected_components(mesh).count, 1);
    const auto surface = boundary_triangles(mesh.tets);
    const auto edges = unique_edges(surface);
    EXPECT_EQ(2 * edges.size(),
              3 * surface.size());  // closed: every edge has two triangles
    EXPECT_EQ(static_cast<long>(used_vertices(surface).size())
                  - static_cast<long>(edges.size()) + static_cast<long>(surface.size()),
              euler);
    return report.quality;
}

TEST(Box, FillsItsExtentsWithEitherSplit) {
    for (const CellSplit split : {CellSplit::Five, CellSplit::Six})
        for (const int n : {1, 2, 3}) {
            const Mesh mesh = fine(make_box({{2, 3, 4}, 2 * n, 3 * n, 4 * n, split}));
            const bool five = split == CellSplit::Five;
            const MeshQuality q = expect_solid(mesh, five ? 54.7 : 44.9, 0.71);
            EXPECT_EQ(mesh.tets.size(),
                      static_cast<std::size_t>((five ? 5 : 6) * 24 * n * n * n));
            EXPECT_NEAR(q.volume, 24.0, 1e-12);
            EXPECT_EQ(q.lo.x, -1.0);
            EXPECT_EQ(q.hi.y, 1.5);
            EXPECT_EQ(q.hi.z, 2.0);
        }
}

TEST(Slab, LiesInTheXzPlane) {
    const Mesh mesh = fine(make_slab(
        {.width = 1, .depth = 2, .thickness = 0.1, .nx = 10, .nz = 20, .layers = 2}));
    const MeshQuality q =
        expect_solid(mesh, 35.2, 0.5);  // atan(sqrt(2) / 2) in cells half as high as wide
    EXPECT_NEAR(q.volume, 0.2, 1e-13);
    EXPECT_NEAR(q.hi.y, 0.05, 1e-16);
    EXPECT_EQ(mesh.x.size(), 11U * 21U * 3U);
}

TEST(Sphere, IsRoundAndWellShapedAtAnyResolution) {
    for (const double edge : {0.5, 0.3, 0.2, 0.13, 0.1, 0.06}) {
        const Mesh mesh = fine(make_sphere({.radius = 0.5, .edge_length = edge}));
        const MeshQuality q = expect_solid(mesh, 25, 0.4);
        EXPECT_NEAR(q.mean_edge, edge, 0.15 * edge) << edge;
        for (const int v : used_vertices(boundary_triangles(mesh.tets)))
            EXPECT_NEAR(norm(mesh.x[static_cast<std::size_t>(v)]), 0.5, 1e-9);
        if (edge <= 0.1) {
            EXPECT_NEAR(q.volume, kPi / 6.0, 0.02);
        }
    }
}

TEST(Torus, HasOneHole) {
    for (const double edge : {0.15, 0.075, 0.03}) {
        const MeshQuality q = expect_solid(
            fine(make_torus(
                {.major_radius = 0.4, .minor_radius = 0.15, .edge_length = edge})),
            25,
            0.5,
            0);
        if (edge < 0.05) {
            EXPECT_NEAR(q.volume, 2.0 * kPi * kPi * 0.4 * 0.15 * 0.15, 0.004);
        }
    }
}

TEST(Cylinder, KeepsItsFlatEnds) {
    for (const double edge : {0.25, 0.1, 0.04}) {
        const MeshQuality q = expect_solid(
            fine(make_cylinder({.radius = 0.25, .height = 1, .edge_length = edge})),
            25,
            0.5);
        EXPECT_EQ(q.lo.y, -0.5);
        EXPECT_EQ(q.hi.y, 0.5);
        if (edge < 0.05) {
            EXPECT_NEAR(q.volume, kPi * 0.0625, 0.003);
        }
    }
}

TEST(Pebble, IsWellShapedForManySeeds) {
    for (std::uint32_t seed = 0; seed < 8; ++seed)
        expect_solid(
            fine(make_pebble({.bumpiness = 0.3, .seed = seed, .edge_length = 0.1})),
            20,
            0.3);
    EXPECT_FALSE(
        test::same_points(make_pebble({.seed = 1, .edge_length = 0.2}).value().x,
                          make_pebble({.seed = 2, .edge_length = 0.2}).value().x));
}

TEST(Star, IsWellShapedForAnyNumberOfArms) {
    for (const int arms : {3, 5, 8})
        expect_solid(fine(make_star({.arms = arms})), 15, 0.2);
}

TEST(Knot, IsAClosedTube) {
    const MeshQuality q = expect_solid(fine(make_knot()), 25, 0.5, 0);
    EXPECT_GT(q.volume, 0.09);
    expect_solid(
        fine(make_knot({.p = 3, .q = 5, .tube_radius = 0.04, .edge_length = 0.03})),
        25,
        0.5,
        0);
    expect_solid(
        fine(make_knot({.p = 1, .q = 1, .tube_radius = 0.1, .edge_length = 0.1})),
        25,
        0.4,
        0);
}

TEST(Tetrahedralized, KeepsTheTopologyOfAnImplicitBody) {
    const ImplicitBody ring{
        [](const Vec3d& x) { return 0.2 - std::hypot(std::hypot(x.x, x.y) - 0.5, x.z); },
        {-0.7, -0.7, -0.2},
        {0.7, 0.7, 0.2}};
    for (const double edge : {0.15, 0.1, 0.07})
        expect_solid(tetrahedralized(ring, edge), 20, 0.3, 0);
    EXPECT_TRUE(
        tetrahedralized({[](const Vec3d&) { return -1.0; }, {0, 0, 0}, {1, 1, 1}}, 0.2)
            .tets.empty());
}

TEST(Generators, GiveTheSameMeshEveryTime) {
    test::expect_same(make_pebble().value(), make_pebble().value());
    test::expect_same(make_star().value(), make_star().value());
    test::expect_same(make_knot().value(), make_knot().value());
    test::expect_same(make_sphere_surface().value(), make_sphere_surface().value());
}

/// Checks a surface; closed ones must enclose a positive volume.
double expect_surface(const Mesh& mesh, bool closed) {
    const MeshReport report =
        check_mesh(mesh,
                   MeshRole::Surface,
                   {.duplicate_vertices_are_errors = true, .poor_below = 0.1});
    for (const auto* issues : {&report.errors, &report.warnings})
        for (const MeshIssue& issue : *issues)
            ADD_FAILURE() << issue.message;
    std::map<std::pair<int, int>, int> uses;
    double volume = 0;
    for (const Int3& t : mesh.triangles) {
        for (int k = 0; k < 3; ++k)
            ++uses[std::minmax(t[k], t[(k + 1) % 3])];
        const auto at = [&](int k) { return mesh.x[static_cast<std::size_t>(t[k])]; };
        volume += dot(at(0), cross(at(1), at(2))) / 6.0;
    }
    const bool has_rim = std::any_of(
        uses.begin(), uses.end(), [](const auto& use) { return use.second == 1; });
    EXPECT_EQ(has_rim, !closed);
    return volume;
}

TEST(Surfaces, ClosedOnesEncloseTheirVolume) {
    EXPECT_NEAR(
        expect_surface(fine(make_box_surface({{1, 2, 3}, 2, 1, 3})), true), 6.0, 1e-13);
    EXPECT_NEAR(
        expect_surface(fine(make_sphere_surface({0.5, 0.05})), true), kPi / 6.0, 0.005);
    EXPECT_NEAR(expect_surface(fine(make_tube_surface({.edge_length = 0.05})), true),
                kPi / 16.0,
                0.003);
    EXPECT_NEAR(
        expect_surface(
            fine(make_tube_surface({.edge_length = 0.05, .capped = false, .wall = 0.05})),
            true),
        kPi * (0.0625 - 0.04),
        0.003);
    EXPECT_GT(expect_surface(fine(make_funnel_surface({.wall = 0.03})), true), 0.0);
    EXPECT_NEAR(
        expect_surface(fine(make_bowl_surface({.wall = 0.1, .edge_length = 0.05})), true),
        kPi * 2.0 / 3.0 * (0.125 - 0.064),
        0.003);
}

TEST(Surfaces, OpenOnesHaveARim) {
    const Mesh plane = fine(make_plane_surface({2, 1, 3, 2}));
    expect_surface(plane, false);
    for (const Int3& t : plane.triangles) {
        const auto at = [&](int k) { return plane.x[static_cast<std::size_t>(t[k])]; };
        EXPECT_GT(cross(at(1) - at(0), at(2) - at(0)).y, 0.0);
    }
    expect_surface(fine(make_tube_surface({.capped = false})), false);
    expect_surface(fine(make_funnel_surface()), false);
    expect_surface(fine(make_funnel_surface({.bottom_radius = 0, .spout_height = 0})),
                   false);
    expect_surface(fine(make_bowl_surface()), false);
    expect_surface(fine(make_bowl_surface({.angle = 150})), false);
}

TEST(Surfaces, OfAnySizeAreAlike) {
    for (const double scale : {1e-6, 1e3}) {
        expect_surface(fine(make_plane_surface({scale, scale, 4, 4})), false);
        expect_surface(fine(make_box_surface({{scale, scale, scale}, 4, 4, 4})), true);
        expect_surface(fine(make_sphere_surface({scale, 0.2 * scale})), true);
        expect_solid(fine(make_sphere({scale, 0.3 * scale})), 25, 0.4);
    }
}

TEST(Generators, RefuseImpossibleParametersByName) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    struct Case {
        Result<Mesh> result;
        const char *where, *message;
    };
    const Case cases[] = {
        {make_box({.size = {1, -1, 1}}), "\"box\"", "size is -1, expected more than 0"},
        {make_box({.nx = 0}), "\"box\"", "nx is 0, expected 1 to"},
        {make_box({.nx = 1000000, .ny = 1000000}),
         "\"box\"",
         "lower the number of cells"},
        {make_slab({.thickness = 0}), "\"slab\"", "thickness is 0"},
        {make_sphere({.radius = nan}), "\"sphere\"", "radius is nan"},
        {make_sphere({.edge_length = 0.6}),
         "\"sphere\"",
         "edge_length is 0.6, expected more than 0 and at most 0.5"},
        {make_sphere({.edge_length = 1e-6}), "\"sphere\"", "raise edge_length"},
        {make_torus({.minor_radius = 0.5}), "\"torus\"", "minor_radius"},
        {make_cylinder({.height = -1}), "\"cylinder\"", "height"},
        {make_pebble({.bumpiness = 2}),
         "\"pebble\"",
         "bumpiness is 2, expected 0 to 0.3"},
        {make_star({.arms = 1}), "\"star\"", "arms is 1, expected 3 to 8"},
        {make_knot({.p = 2, .q = 4}), "\"knot\"", "common divisor"},
        {make_knot({.tube_radius = 0.3}),
         "\"knot\"",
         "tube_radius is 0.3, expected more than 0 and at most 0.1"},
        {make_tube_surface({.wall = 0.1}), "\"tube surface\"", "capped"},
        {make_funnel_surface({.bottom_radius = 0}), "\"funnel surface\"", "spout"},
        {make_bowl_surface({.angle = 190}), "\"bowl surface\"", "angle"},
        {make_sphere_surface({.edge_length = 0}), "\"sphere surface\"", "edge_length"},
        {make_plane_surface({.nx = -3}), "\"plane surface\"", "nx is -3"},
        {make_box_surface({.size = {0, 1, 1}}), "\"box surface\"", "size is 0"},
    };
    for (const Case& c : cases) {
        ASSERT_FALSE(c.result) << c.where << c.message;
        EXPECT_EQ(c.result.error().code, Error::Code::InvalidScene);
        EXPECT_NE(c.result.error().where.find(c.where), std::string::npos)
            << c.result.error().where;
        EXPECT_NE(c.result.error().message.find(c.message), std::string::npos)
            << c.result.error().message;
    }
}

}  // namespace
}  // namespace noli
