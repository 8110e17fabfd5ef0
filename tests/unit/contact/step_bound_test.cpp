// SPDX-License-Identifier: Apache-2.0
#include "contact/step_bound.hpp"

#include "contact/intersections.hpp"
#include "contact_shapes.hpp"

namespace noli {
namespace {

using namespace contact_test;

template <class Exec>
StepBound bound_of(Exec& exec,
                   const Shape& s,
                   const std::vector<Vec3d>& p,
                   double inflation,
                   const AdvanceParams& params = {}) {
    DeviceCollisionMesh<Exec> mesh;
    mesh.upload(exec, s.mesh);
    BroadPhase<Exec> broad_phase;
    Candidates<Exec> candidates;
    find_candidates(
        exec, mesh, broad_phase, {s.view(), view_of(p), 1.0}, inflation, candidates);
    StepBoundWork<Exec> work;
    return step_bound(exec, mesh, candidates, s.view(), view_of(p), 1.0, params, work);
}

/// Smallest bound over all pairs of the mesh, each advanced to the full end.
double brute_bound(const Shape& s,
                   const std::vector<Vec3d>& p,
                   const AdvanceParams& params) {
    double alpha = 1.0;
    const auto all = [](int, int) { return true; };
    for (const auto& [v, t] : brute_vertex_triangle(s, all))
        alpha = std::min(alpha,
                         advance_point_triangle(vertex_triangle_stencil(s, v, t, s.x),
                                                vertex_triangle_stencil(s, v, t, p),
                                                1.0,
                                                params)
                             .t);
    for (const auto& [a, b] : brute_edge_edge(s, all))
        alpha = std::min(alpha,
                         advance_edge_edge(edge_edge_stencil(s, a, b, s.x),
                                           edge_edge_stencil(s, a, b, p),
                                           1.0,
                                           params)
                             .t);
    return alpha;
}

/// Motion that drives the two bodies of a shape into each other, with some noise.
std::vector<Vec3d> collision_motion(const Shape& s, unsigned seed) {
    std::mt19937 rng(seed);
    std::vector<Vec3d> p;
    for (std::size_t i = 0; i < s.x.size(); ++i) {
        const Vec3d drive{s.mesh.body[i] == 0 ? 0.5 : -0.5, 0.0, 0.0};
        p.push_back(drive + random_vector(rng, 0.02));
    }
    return p;
}

std::size_t intersections_of(const Shape& s, const std::vector<Vec3d>& x) {
    SerialExec exec;
    IntersectionCheck<SerialExec> check;
    check.set_mesh(exec, s.mesh);
    return check.run(exec, view_of(x)).size();
}

TEST(StepBound, MatchesBruteForceOnCollidingShapes) {
    for (unsigned seed = 1; seed <= 6; ++seed) {
        const Shape s = two_spheres(0.02 * seed, 5 + int(seed) % 3);
        const std::vector<Vec3d> p = collision_motion(s, seed);
        const AdvanceParams params{0.8, seed % 2 == 0 ? 1e-3 : 0.0, 256};
        SerialExec exec;
        const StepBound bound = bound_of(exec, s, p, 0.05, params);
        const double expected = brute_bound(s, p, params);
        ASSERT_LT(expected, 1.0);
        EXPECT_NEAR(bound.alpha, expected, 1e-9);
        EXPECT_NE(bound.limit, StepBound::Limit::None);
        EXPECT_EQ(bound.reason, AdvanceEnd::GapUsed);
        EXPECT_FALSE(bound.capped);
    }
}

TEST(StepBound, KeepsEveryGapOpenAndTheStateFreeOfIntersections) {
    for (unsigned seed = 11; seed <= 16; ++seed) {
        const Shape s = two_spheres(0.01, 9);
        std::vector<Vec3d> p = collision_motion(s, seed);
        ASSERT_EQ(intersections_of(s, s.x), 0U);
        ASSERT_GT(intersections_of(s, moved(s, p, 1.0)), 0U);
        SerialExec exec;
        const StepBound bound = bound_of(exec, s, p, 0.02);
        EXPECT_GT(bound.alpha, 0.0);
        const std::vector<Vec3d> x = moved(s, p, bound.alpha);
        EXPECT_EQ(intersections_of(s, x), 0U);
        brute_vertex_triangle(s, [&](int v, int t) {
            const double before =
                classify_point_triangle(vertex_triangle_stencil(s, v, t, s.x)).d_sq;
            const double after =
                classify_point_triangle(vertex_triangle_stencil(s, v, t, x)).d_sq;
            EXPECT_GE(std::sqrt(after),
                      std::min(0.2 * std::sqrt(before), 0.02) * (1.0 - 1e-9));
            return false;
        });
    }
}

TEST(StepBound, RepeatedStepsNeverIntersect) {
    const Shape start = two_spheres(0.05, 8);
    Shape s = start;
    std::mt19937 rng(99);
    SerialExec exec;
    for (int step = 0; step < 25; ++step) {
        std::vector<Vec3d> p;
        for (std::size_t i = 0; i < s.x.size(); ++i)
            p.push_back(Vec3d{s.mesh.body[i] == 0 ? 0.05 : -0.05, 0.0, 0.0}
                        + random_vector(rng, 0.05));
        const StepBound bound = bound_of(exec, s, p, 0.01);
        ASSERT_GT(bound.alpha, 0.0);
        s.x = moved(s, p, bound.alpha);
        ASSERT_EQ(intersections_of(s, s.x), 0U) << "step " << step;
    }
}

TEST(StepBound, NamesTheLimitingPair) {
    Shape s;
    s.x = {{0, 0, 0},
           {1, 0, 0},
           {0, 1, 0},
           {0.2, 0.2, 0.5},
           {9, 0, 0},
           {9, 1, 0},
           {9.5, 0.5, -1},
           {9.5, 0.5, 1}};
    s.mesh.triangles = {{{0, 1, 2}}};
    s.mesh.walls = {{{0, 0, 1}, -20.0}};
    complete(s, {{{4, 5}}, {{6, 7}}}, {3});
    SerialExec exec;
    std::vector<Vec3d> p(8, Vec3d{0, 0, 0});
    const StepBound still = bound_of(exec, s, p, 0.01);
    EXPECT_EQ(still.limit, StepBound::Limit::None);
    EXPECT_EQ(still.alpha, 1.0);
    EXPECT_EQ(still.vertices, (Int4{{-1, -1, -1, -1}}));

    p[3] = {0, 0, -1.0};
    const StepBound point = bound_of(exec, s, p, 0.01);
    EXPECT_EQ(point.limit, StepBound::Limit::VertexTriangle);
    EXPECT_EQ(point.vertices, (Int4{{3, 0, 1, 2}}));
    EXPECT_NEAR(point.alpha, 0.4, 1e-6);

    p[6] = p[7] = {-2.0, 0, 0};
    const StepBound edge = bound_of(exec, s, p, 0.01);
    EXPECT_EQ(edge.limit, StepBound::Limit::EdgeEdge);
    EXPECT_EQ(edge.vertices, (Int4{{4, 5, 6, 7}}));
    EXPECT_NEAR(edge.alpha, 0.2, 1e-6);

    p[1] = {0, 0, -200.0};
    const StepBound plane = bound_of(exec, s, p, 0.01);
    EXPECT_EQ(plane.limit, StepBound::Limit::Wall);
    EXPECT_EQ(plane.vertices, (Int4{{1, 0, -1, -1}}));
    EXPECT_NEAR(plane.alpha, 0.8 * 20.0 / 200.0, 1e-12);
}

TEST(StepBound, NamesACurvedWall) {
    Shape s;
    s.x = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, 0.2, 0.5}};
    s.mesh.triangles = {{{0, 1, 2}}};
    s.mesh.walls = {{{0, 0, 1}, -20.0},
                    {{}, 0.0, WallShape::Sphere, {0, 0, 0}, 6.0},
                    {{1, 0, 0}, 0.0, WallShape::Cylinder, {0, 0, 0}, 5.0}};
    complete(s, {}, {3});
    SerialExec exec;
    std::vector<Vec3d> p(4, Vec3d{0, 0, 0});
    p[1] = {20.0, 0, 0};
    const StepBound ball = bound_of(exec, s, p, 0.01);
    EXPECT_EQ(ball.limit, StepBound::Limit::Wall);
    EXPECT_EQ(ball.vertices, (Int4{{1, 1, -1, -1}}));
    EXPECT_NEAR(ball.alpha, 0.8 * 5.0 / 20.0, 1e-12);
    p[1] = {-1.0, 20.0, 0};
    const StepBound pipe = bound_of(exec, s, p, 0.01);
    EXPECT_EQ(pipe.vertices, (Int4{{1, 2, -1, -1}}));
    EXPECT_NEAR(pipe.alpha, 0.8 * 5.0 / 20.0, 1e-12);
}

TEST(StepBound, ZeroComesWithAPairAndAReason) {
    Shape s;
    s.x = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, 0.2, 0.0}};
    s.mesh.triangles = {{{0, 1, 2}}};
    complete(s, {}, {3});
    SerialExec exec;
    std::vector<Vec3d> p(4, Vec3d{0, 0, 0});
    p[3] = {0, 0, -1.0};
    const StepBound touching = bound_of(exec, s, p, 0.01);
    EXPECT_EQ(touching.alpha, 0.0);
    EXPECT_EQ(touching.limit, StepBound::Limit::VertexTriangle);
    EXPECT_EQ(touching.reason, AdvanceEnd::InitiallyClosed);
    EXPECT_EQ(touching.vertices, (Int4{{3, 0, 1, 2}}));

    s.x[3].z = 0.3;
    p[3].z = std::nan("");
    const StepBound nan = bound_of(exec, s, p, 0.01);
    EXPECT_EQ(nan.alpha, 0.0);
    EXPECT_EQ(nan.limit, StepBound::Limit::NotFinite);
    EXPECT_EQ(nan.reason, AdvanceEnd::NotFinite);
    EXPECT_EQ(nan.vertices, (Int4{{3, -1, -1, -1}}));
}

TEST(StepBound, SaysThatAnIterationCapShortensIt) {
    Shape s;
    s.x = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0.2}, {0.9, 0.9, 0.3}};
    s.mesh.triangles = {{{0, 1, 2}}};
    complete(s, {}, {3});
    std::mt19937 rng(8);
    SerialExec exec;
    int shortened = 0;
    for (int trial = 0; trial < 200; ++trial) {
        std::vector<Vec3d> p;
        for (int i = 0; i < 4; ++i)
            p.push_back(random_vector(rng, 1.0));
        const StepBound full = bound_of(exec, s, p, 0.01);
        const StepBound capped = bound_of(exec, s, p, 0.01, {0.8, 0.0, 1});
        EXPECT_FALSE(full.capped);
        EXPECT_LE(capped.alpha, full.alpha);
        EXPECT_GT(capped.alpha, 0.0);
        EXPECT_EQ(capped.capped, capped.reason == AdvanceEnd::IterationCap);
        shortened += capped.capped && capped.alpha < full.alpha ? 1 : 0;
    }
    EXPECT_GT(shortened, 10);
}

TEST(StepBound, TiesAreDecidedAlikeEverywhere) {
    Shape s;  // 150 points above one triangle, 73 of them with the same smallest bound
    s.x = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    s.mesh.triangles = {{{0, 1, 2}}};
    std::vector<int> points;
    for (int i = 0; i < 150; ++i) {
        points.push_back(int(s.x.size()));
        s.x.push_back({0.2, 0.2, i < 77 ? 0.75 : 0.5});
    }
    complete(s, {}, points);
    std::vector<Vec3d> p(s.x.size(), Vec3d{0, 0, 0});
    for (const int i : points)
        p[std::size_t(i)] = {0, 0, -1.0};
    SerialExec serial;
    const StepBound expected = bound_of(serial, s, p, 0.01);
    EXPECT_EQ(s.x[std::size_t(expected.vertices[0])].z, 0.5);
    EXPECT_NEAR(expected.alpha, 0.4, 1e-6);
    on_all_executors([&](auto& exec) { return bound_of(exec, s, p, 0.01); },
                     [&](const StepBound& bound, const char* name) {
                         EXPECT_EQ(bound.alpha, expected.alpha) << name;
                         EXPECT_EQ(bound.vertices, expected.vertices) << name;
                     });
}

TEST(StepBound, IsEqualForEveryExecutorAndThreadCount) {
    const Shape s = two_spheres(0.01, 12);
    const std::vector<Vec3d> p = collision_motion(s, 5);
    SerialExec serial;
    const StepBound expected = bound_of(serial, s, p, 0.02);
    ASSERT_NE(expected.limit, StepBound::Limit::None);
    on_all_executors([&](auto& exec) { return bound_of(exec, s, p, 0.02); },
                     [&](const StepBound& bound, const char* name) {
                         EXPECT_EQ(bound.alpha, expected.alpha) << name;
                         EXPECT_EQ(bound.vertices, expected.vertices) << name;
                         EXPECT_EQ(bound.limit, expected.limit) << name;
                     });
}

}  // namespace
}  // namespace noli
