// SPDX-License-Identifier: Apache-2.0
#include "contact/intersections.hpp"

#include "contact_shapes.hpp"

namespace noli {
namespace {

using namespace contact_test;

template <class Exec>
Intersections intersections_of(Exec& exec, const Shape& s) {
    IntersectionCheck<Exec> check;
    check.set_mesh(exec, s.mesh);
    return check.run(exec, s.view());
}
Intersections intersections_of(const Shape& s) {
    SerialExec exec;
    return intersections_of(exec, s);
}

/// A triangle and one more edge or point given by its vertices.
Shape triangle_and(const std::vector<Vec3d>& more) {
    Shape s;
    s.x = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    s.x.insert(s.x.end(), more.begin(), more.end());
    s.mesh.triangles = {{{0, 1, 2}}};
    if (more.size() == 2)
        complete(s, {{{3, 4}}});
    else
        complete(s, {}, {3});
    return s;
}

TEST(Intersections, OnSoupsMatchBruteForce) {
    std::size_t total = 0;
    for (unsigned seed = 1; seed <= 8; ++seed) {
        const Shape s = soup(5 + 11 * int(seed), 0.4, seed);
        std::vector<std::pair<int, int>> expected;
        for (const Int2& e : s.mesh.edges)
            for (const Int3& t : s.mesh.triangles) {
                const auto at = [&](int v) { return s.x[std::size_t(v)]; };
                const bool own = e[0] / 3 == t[0] / 3;
                if (!own
                    && segment_intersects_triangle(
                        at(e[0]), at(e[1]), at(t[0]), at(t[1]), at(t[2])))
                    expected.emplace_back(e[0] * 1000 + e[1], t[0]);
            }
        std::vector<std::pair<int, int>> found;
        for (const EdgeTriangleIntersection& hit : intersections_of(s).edge_triangle)
            found.emplace_back(hit.edge[0] * 1000 + hit.edge[1], hit.triangle[0]);
        EXPECT_EQ(found, expected);
        total += found.size();
    }
    EXPECT_GT(total, 100U);
}

TEST(Intersections, FreeShapesHaveNoneAndOverlappingOnesHave) {
    EXPECT_EQ(intersections_of(two_spheres(0.01, 9)).size(), 0U);
    EXPECT_EQ(intersections_of(folded_sheet(9, 0.01)).size(), 0U);
    const Intersections found = intersections_of(two_spheres(-0.05, 9));
    EXPECT_GT(found.edge_triangle.size(), 0U);
    for (const EdgeTriangleIntersection& hit : found.edge_triangle) {
        EXPECT_NEAR(hit.place.x, 0.0, 0.1);
        EXPECT_LT(std::hypot(hit.place.y, hit.place.z), 0.5);
    }
}

TEST(Intersections, TouchingCountsWithoutTolerance) {
    const double tiny = 1e-300;
    EXPECT_EQ(intersections_of(triangle_and({{0.2, 0.2, 0.0}, {0.2, 0.2, 1.0}})).size(),
              1U);
    EXPECT_EQ(intersections_of(triangle_and({{0.2, 0.2, tiny}, {0.2, 0.2, 1.0}})).size(),
              0U);
    EXPECT_EQ(intersections_of(triangle_and({{0.5, 0.5, -1.0}, {0.5, 0.5, 1.0}})).size(),
              1U);
    EXPECT_EQ(intersections_of(triangle_and({{0.5, 0.5000000000000001, -1.0},
                                             {0.5, 0.5000000000000001, 1.0}}))
                  .size(),
              0U);
    // In the plane of the triangle: across it, inside, outside.
    EXPECT_EQ(intersections_of(triangle_and({{-1.0, 0.3, 0.0}, {2.0, 0.3, 0.0}})).size(),
              1U);
    EXPECT_EQ(intersections_of(triangle_and({{0.1, 0.1, 0.0}, {0.3, 0.3, 0.0}})).size(),
              1U);
    EXPECT_EQ(intersections_of(triangle_and({{0.6, 0.6, 0.0}, {2.0, 0.3, 0.0}})).size(),
              0U);
}

TEST(Intersections, PlaceIsWhereTheEdgePierces) {
    const Intersections found =
        intersections_of(triangle_and({{0.1, 0.2, -1.0}, {0.3, 0.2, 3.0}}));
    ASSERT_EQ(found.edge_triangle.size(), 1U);
    const EdgeTriangleIntersection& hit = found.edge_triangle[0];
    EXPECT_EQ(hit.edge, (Int2{{3, 4}}));
    EXPECT_EQ(hit.triangle, (Int3{{0, 1, 2}}));
    EXPECT_NEAR(norm(hit.place - Vec3d{0.15, 0.2, 0.0}), 0.0, 1e-15);
}

TEST(Intersections, NeighboursAreTestedBeyondTheirCommonVertex) {
    Shape s;  // two triangles with the common vertex 0
    s.x = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
    s.mesh.triangles = {{{0, 1, 2}}, {{0, 3, 4}}};
    complete(s);
    EXPECT_EQ(intersections_of(s).size(), 0U);
    s.x[3] = {0.3, 0.3, 0.0};  // edge 0-3 now lies in the first triangle
    EXPECT_GT(intersections_of(s).size(), 0U);
    s.x[3] = {2.0, 2.0, 0.0};  // and now crosses it
    EXPECT_GT(intersections_of(s).size(), 0U);
    s.x[3] = {2.0, 2.0, 1e-200};  // out of the plane: only vertex 0 is common
    EXPECT_EQ(intersections_of(s).size(), 0U);
}

TEST(Intersections, ATriangleFoldedOntoItsNeighbourIsFound) {
    Shape s;  // two triangles with the common edge 0-1
    s.x = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, -1, 0}};
    s.mesh.triangles = {{{0, 1, 2}}, {{1, 0, 3}}};
    complete(s);
    EXPECT_EQ(intersections_of(s).size(), 0U);
    s.x[3] = {0.2, 0.2, 0.0};
    EXPECT_GT(intersections_of(s).size(), 0U);
    s.x[3] = {0.2, 0.2, 1e-9};
    EXPECT_EQ(intersections_of(s).size(), 0U);
}

TEST(Intersections, ObstaclePointsInTrianglesAreFound) {
    const Intersections inside = intersections_of(triangle_and({{0.25, 0.25, 0.0}}));
    ASSERT_EQ(inside.vertex_triangle.size(), 1U);
    EXPECT_EQ(inside.vertex_triangle[0].vertex, 3);
    EXPECT_EQ(intersections_of(triangle_and({{0.25, 0.25, 1e-300}})).size(), 0U);
    EXPECT_EQ(intersections_of(triangle_and({{0.6, 0.6, 0.0}})).size(), 0U);
}

TEST(Intersections, VerticesOnOrBehindHalfSpacesAreFound) {
    Shape s;
    s.x = {{0, 0, 0}, {0, 1, 0}, {0, -2, 0}, {0, -3, 0}};
    s.mesh.walls = {{{0, 1, 0}, 0.0}};
    complete(s, {}, {0, 1, 2, 3});
    s.mesh.kinematic[3] = 1;
    const Intersections found = intersections_of(s);
    ASSERT_EQ(found.vertex_wall.size(), 2U);
    EXPECT_EQ(found.vertex_wall[0].vertex, 0);
    EXPECT_EQ(found.vertex_wall[1].vertex, 2);
    EXPECT_EQ(found.vertex_wall[1].distance, -2.0);
    s.mesh.wall_enabled = {0};
    EXPECT_EQ(intersections_of(s).size(), 0U);
}

TEST(Intersections, VerticesOnOrOutsideOfContainersAreFound) {
    Shape s;
    s.x = {{0, 0, 0}, {0, 2, 0}, {0, -2.5, 0}, {9, 0, 0}, {9, 0, 3}};
    s.mesh.walls = {{{}, 0.0, WallShape::Sphere, {0, 0, 0}, 2.0},
                    {{1, 0, 0}, 0.0, WallShape::Cylinder, {0, 0, 0}, 2.25}};
    complete(s, {}, {0, 1, 2, 3, 4});
    s.mesh.kinematic[4] = 1;
    const Intersections found = intersections_of(s);
    ASSERT_EQ(found.vertex_wall.size(), 4U);
    const std::vector<std::array<int, 2>> expected{{1, 0}, {2, 0}, {2, 1}, {3, 0}};
    for (std::size_t k = 0; k < expected.size(); ++k) {
        EXPECT_EQ(found.vertex_wall[k].vertex, expected[k][0]);
        EXPECT_EQ(found.vertex_wall[k].wall, expected[k][1]);
    }
    EXPECT_EQ(found.vertex_wall[1].distance, -0.5);
    EXPECT_EQ(found.vertex_wall[2].distance, -0.25);
    s.mesh.wall_enabled.assign(s.mesh.wall_enabled.size(), 0);
    EXPECT_EQ(intersections_of(s).size(), 0U);
}

TEST(Intersections, SkipKinematicAndDisabledPairs) {
    Shape s = two_spheres(-0.05, 7);
    EXPECT_GT(intersections_of(s).size(), 0U);
    std::fill(s.mesh.kinematic.begin(), s.mesh.kinematic.end(), std::uint8_t{1});
    EXPECT_EQ(intersections_of(s).size(), 0U);
    s.mesh.kinematic[0] = 0;  // the pole of the first sphere: far from the other
    EXPECT_EQ(intersections_of(s).size(), 0U);
    std::fill(s.mesh.kinematic.begin(), s.mesh.kinematic.end(), std::uint8_t{0});
    s.mesh.pair_enabled = {1, 0, 0, 1};
    EXPECT_EQ(intersections_of(s).size(), 0U);
}

TEST(Intersections, AreEqualForEveryExecutorAndThreadCount) {
    const Shape s = soup(250, 0.4, 77);
    const auto key = [](const Intersections& found) {
        std::vector<std::vector<double>> out;
        for (const auto& hit : found.edge_triangle)
            out.push_back({double(hit.edge[0]),
                           double(hit.edge[1]),
                           double(hit.triangle[0]),
                           hit.place.x});
        return out;
    };
    const auto expected = key(intersections_of(s));
    EXPECT_GT(expected.size(), 100U);
    on_all_executors(
        [&](auto& exec) { return key(intersections_of(exec, s)); },
        [&](const auto& found, const char* name) { EXPECT_EQ(found, expected) << name; });
}

TEST(Intersections, VerticesThatAreNotFiniteAreReported) {
    Shape s = triangle_and({{0.25, 0.25, std::nan("")}});
    EXPECT_EQ(intersections_of(s).not_finite, (std::vector<int>{3}));
    s.x[3].z = INFINITY;
    EXPECT_EQ(intersections_of(s).not_finite, (std::vector<int>{3}));
}

TEST(Intersections, NothingInAnEmptyMesh) {
    Shape s;
    complete(s);
    EXPECT_EQ(intersections_of(s).size(), 0U);
}

TEST(CountInverted, UsesTheExactSign) {
    const std::vector<Vec3d> x = {{0, 0, 0},
                                  {1, 0, 0},
                                  {0, 1, 0},
                                  {0.3, 0.3, 1e-290},
                                  {0.3, 0.3, 0.0},
                                  {0.3, 0.3, -1.0}};
    const std::vector<Int4> tets = {
        {{0, 1, 2, 3}}, {{0, 1, 2, 4}}, {{0, 1, 2, 5}}, {{0, 2, 1, 5}}};
    SerialExec exec;
    const InvertedTets found =
        count_inverted(exec, View<const Int4>{tets.data(), 4}, view_of(x));
    EXPECT_EQ(found.count, 2);
    EXPECT_EQ(found.first, 1);
    const InvertedTets none =
        count_inverted(exec, View<const Int4>{tets.data(), 1}, view_of(x));
    EXPECT_EQ(none.count, 0);
    EXPECT_EQ(none.first, -1);
}

}  // namespace
}  // namespace noli
