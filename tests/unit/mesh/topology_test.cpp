// SPDX-License-Identifier: Apache-2.0
#include "mesh/topology.hpp"

#include "mesh/generate.hpp"
#include "mesh/quality.hpp"
#include "unit/mesh/test_files.hpp"

#include <numeric>
#include <random>

namespace noli {
namespace {

/// Volume inside a closed surface by the divergence theorem.
double enclosed(const Mesh& mesh, const std::vector<Int3>& surface) {
    double sum = 0;
    for (const Int3& t : surface)
        sum += dot(mesh.x[static_cast<std::size_t>(t[0])],
                   cross(mesh.x[static_cast<std::size_t>(t[1])],
                         mesh.x[static_cast<std::size_t>(t[2])]))
             / 6.0;
    return sum;
}

TEST(BoundaryTriangles, OfOneTetrahedronPointOutwards) {
    const Mesh tet = test::corner_tet();
    const auto surface = boundary_triangles(tet.tets);
    EXPECT_EQ(surface, (std::vector<Int3>{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}));
    EXPECT_NEAR(enclosed(tet, surface), 1.0 / 6.0, 1e-16);
}

TEST(BoundaryTriangles, EncloseTheVolumeOfTheTetrahedra) {
    for (const Mesh& mesh :
         {make_box().value(), make_torus().value(), make_pebble().value()}) {
        const auto volumes = tet_volumes(mesh);
        const double volume = std::accumulate(volumes.begin(), volumes.end(), 0.0);
        EXPECT_NEAR(
            enclosed(mesh, boundary_triangles(mesh.tets)), volume, 1e-12 * volume);
    }
}

TEST(BoundaryTriangles, KeepTheOrderOfTheTetrahedra) {
    Mesh mesh = make_box({.nx = 2, .ny = 1, .nz = 1}).value();
    const auto before = boundary_triangles(mesh.tets);
    EXPECT_EQ(before.size(), 20U);  // 10 squares
    mesh.tets.push_back({100, 101, 102, 103});
    auto after = boundary_triangles(mesh.tets);
    ASSERT_EQ(after.size(), 24U);
    after.resize(20);
    EXPECT_EQ(after, before);
}

TEST(UniqueEdges, OfTrianglesAndTetrahedraAreSorted) {
    EXPECT_EQ(unique_edges(std::vector<Int3>{{2, 1, 0}, {3, 1, 2}}),
              (std::vector<Int2>{{0, 1}, {0, 2}, {1, 2}, {1, 3}, {2, 3}}));
    EXPECT_EQ(unique_edges(std::vector<Int4>{{3, 2, 1, 0}}).size(), 6U);
    const Mesh ball = make_sphere_surface().value();  // Euler: V - E + F = 2
    EXPECT_EQ(ball.x.size() + ball.triangles.size(),
              unique_edges(ball.triangles).size() + 2);
}

TEST(UsedVertices, AreSortedAndUnique) {
    EXPECT_EQ(used_vertices(std::vector<Int3>{{7, 3, 5}, {5, 3, 9}}),
              (std::vector<int>{3, 5, 7, 9}));
    EXPECT_EQ(used_vertices(std::vector<Int2>{{4, 4}}), (std::vector<int>{4}));
}

TEST(FirstEqualVertex, MatchesBruteForceWithSignedZeros) {
    std::mt19937 random(3);
    std::vector<Vec3d> x;
    for (int i = 0; i < 300; ++i) {
        const auto digit = [&] {
            return (random() % 2 == 0 ? -1.0 : 1.0) * (random() % 3);
        };
        x.push_back({digit(), digit(), digit()});
    }
    const auto first = first_equal_vertex(x);
    for (std::size_t i = 0; i < x.size(); ++i) {
        std::size_t j = 0;
        while (!(x[j].x == x[i].x && x[j].y == x[i].y && x[j].z == x[i].z))
            ++j;
        EXPECT_EQ(first[i], static_cast<int>(j));
    }
}

TEST(ConnectedComponents, AreNumberedBySmallestVertex) {
    const Mesh mesh{std::vector<Vec3d>(9), {{8, 2, 3, 4}}, {{5, 1, 6}}, {{6, 0}}};
    const Components parts = connected_components(mesh);
    EXPECT_EQ(parts.count, 3);
    EXPECT_EQ(parts.of_vertex, (std::vector<int>{0, 0, 1, 1, 1, 0, 0, 2, 1}));
}

TEST(RadiusRatio, IsOneForRegularShapesAndSignedLikeTheVolume) {
    const Vec3d a{1, 1, 1}, b{1, -1, -1}, c{-1, 1, -1}, d{-1, -1, 1};
    EXPECT_NEAR(radius_ratio(a, c, b, d), 1.0, 1e-14);
    EXPECT_NEAR(radius_ratio(a, b, c, d), -1.0, 1e-14);
    EXPECT_NEAR(relative_volume(a, c, b, d), 1.0, 1e-14);
    EXPECT_NEAR(radius_ratio(a, b, c), 1.0, 1e-14);
    EXPECT_EQ(radius_ratio(a, a, a, a), 0.0);
    EXPECT_EQ(radius_ratio(a, a, a), 0.0);
    const AngleRange angles = dihedral_angles(a, c, b, d);
    EXPECT_NEAR(angles.lo, std::acos(1.0 / 3.0) * 180.0 / 3.141592653589793, 1e-10);
    EXPECT_NEAR(angles.hi, angles.lo, 1e-10);
}

TEST(RadiusRatio, MatchesInsphereAndCircumsphereOfTheCornerTetrahedron) {
    const auto x = test::corner_tet().x;
    const double r = 1.0 / (3.0 + std::sqrt(3.0)), R = std::sqrt(3.0) / 2.0;  // by hand
    EXPECT_NEAR(radius_ratio(x[0], x[1], x[2], x[3]), 3.0 * r / R, 1e-14);
    EXPECT_NEAR(radius_ratio(x[0], x[1], x[2]),
                2.0 * (1.0 - std::sqrt(0.5)) / std::sqrt(0.5),
                1e-14);
    EXPECT_NEAR(dihedral_angles(x[0], x[1], x[2], x[3]).hi, 90.0, 1e-12);
    EXPECT_NEAR(dihedral_angles(x[0], x[1], x[2], x[3]).lo, 54.735610317245346, 1e-10);
}

TEST(MeshQuality, NamesTheWorstElementAndTheBox) {
    Mesh mesh = make_box({.size = {2, 1, 1}, .nx = 2, .ny = 1, .nz = 1}).value();
    mesh.x[static_cast<std::size_t>(mesh.tets[6][0])].x += 0.2;
    const MeshQuality q = mesh_quality(mesh);
    ASSERT_GE(q.worst_element, 0);
    const Int4 t = mesh.tets[static_cast<std::size_t>(q.worst_element)];
    EXPECT_EQ(radius_ratio(mesh.x[static_cast<std::size_t>(t[0])],
                           mesh.x[static_cast<std::size_t>(t[1])],
                           mesh.x[static_cast<std::size_t>(t[2])],
                           mesh.x[static_cast<std::size_t>(t[3])]),
              q.min_radius_ratio);
    EXPECT_EQ(q.lo.y, -0.5);
    EXPECT_EQ(q.hi.z, 0.5);
    EXPECT_LE(q.min_edge, q.mean_edge);
    EXPECT_LE(q.mean_edge, q.max_edge);
}

}  // namespace
}  // namespace noli
