// SPDX-License-Identifier: Apache-2.0
#include "contact/broad_phase.hpp"

#include "contact_shapes.hpp"

namespace noli {
namespace {

using namespace contact_test;

double vertex_triangle_distance(const Shape& s,
                                int v,
                                int t,
                                const std::vector<Vec3d>& x) {
    return std::sqrt(classify_point_triangle(vertex_triangle_stencil(s, v, t, x)).d_sq);
}
double edge_edge_distance(const Shape& s, int a, int b, const std::vector<Vec3d>& x) {
    return std::sqrt(classify_edge_edge(edge_edge_stencil(s, a, b, x)).d_sq);
}

/// Largest separation of the first kA points from the others on a coordinate axis, boxes
/// around both ends.
double box_separation(const Stencil<4>& s, const Stencil<4>& e, int first) {
    double apart = -INFINITY;
    for (int axis = 0; axis < 3; ++axis) {
        double lo[2] = {INFINITY, INFINITY};
        double hi[2] = {-INFINITY, -INFINITY};
        for (int i = 0; i < 4; ++i) {
            const int side = i < first ? 0 : 1;
            lo[side] = std::min({lo[side], s.x[i][axis], e.x[i][axis]});
            hi[side] = std::max({hi[side], s.x[i][axis], e.x[i][axis]});
        }
        apart = std::max({apart, lo[0] - hi[1], lo[1] - hi[0]});
    }
    return apart;
}

/// Candidates hold every pair that comes closer than inflation at one of `samples` times,
/// and no pair whose swept boxes are farther apart than that.
void expect_right_candidates(const Shape& s,
                             const std::vector<Vec3d>& p,
                             double alpha,
                             double inflation,
                             int samples) {
    CpuExec exec;
    const CandidateLists found = candidates_of(exec, s, p, alpha, inflation);
    std::vector<std::vector<Vec3d>> states;
    for (int k = 0; k < samples; ++k)
        states.push_back(moved(s, p, samples > 1 ? alpha * k / (samples - 1) : 0.0));
    const auto any_close = [&](auto distance, int a, int b) {
        return std::any_of(states.begin(), states.end(), [&](const auto& x) {
            return distance(s, a, b, x) < inflation;
        });
    };
    const auto close_vt = brute_vertex_triangle(
        s, [&](int v, int t) { return any_close(vertex_triangle_distance, v, t); });
    const auto close_ee = brute_edge_edge(
        s, [&](int a, int b) { return any_close(edge_edge_distance, a, b); });
    EXPECT_TRUE(is_subset(close_vt, found.vertex_triangle));
    EXPECT_TRUE(is_subset(close_ee, found.edge_edge));

    const std::vector<Vec3d>& end = states.back();
    const double slack = 1e-5 * (1.0 + inflation);
    const auto near_vt = brute_vertex_triangle(s, [&](int v, int t) {
        return box_separation(vertex_triangle_stencil(s, v, t, s.x),
                              vertex_triangle_stencil(s, v, t, end),
                              1)
             < inflation + slack;
    });
    const auto near_ee = brute_edge_edge(s, [&](int a, int b) {
        return box_separation(
                   edge_edge_stencil(s, a, b, s.x), edge_edge_stencil(s, a, b, end), 2)
             < inflation + slack;
    });
    EXPECT_TRUE(is_subset(found.vertex_triangle, near_vt));
    EXPECT_TRUE(is_subset(found.edge_edge, near_ee));
}

std::vector<Vec3d> random_motion(const Shape& s, double size, unsigned seed) {
    std::mt19937 rng(seed);
    std::vector<Vec3d> p;
    for (std::size_t i = 0; i < s.x.size(); ++i)
        p.push_back(random_vector(rng, size));
    return p;
}

TEST(Candidates, StaticQueryOnSoupsMatchesBruteForce) {
    unsigned seed = 10;
    for (const int n : {1, 2, 3, 5, 11, 33, 97})
        for (const double inflation : {0.0, 0.01, 0.2})
            expect_right_candidates(soup(n, 0.3, ++seed), {}, 0.0, inflation, 1);
}

TEST(Candidates, SweptQueryOnSoupsMatchesBruteForce) {
    unsigned seed = 20;
    for (const int n : {1, 2, 7, 33, 61})
        for (const double inflation : {0.001, 0.05}) {
            const Shape s = soup(n, 0.2, ++seed);
            expect_right_candidates(s, random_motion(s, 0.5, seed), 0.8, inflation, 21);
        }
}

TEST(Candidates, QueriesOnShapesMatchBruteForce) {
    const Shape spheres = two_spheres(0.01, 7);
    expect_right_candidates(spheres, {}, 0.0, 0.03, 1);
    std::vector<Vec3d> p = random_motion(spheres, 0.02, 31);
    for (std::size_t i = 0; i < p.size(); ++i)
        p[i] += Vec3d{spheres.mesh.body[i] == 0 ? 0.3 : -0.3, 1.0, 0.0};
    expect_right_candidates(spheres, p, 1.0, 0.01, 21);
    const Shape sheet = folded_sheet(6, 0.02);
    expect_right_candidates(sheet, {}, 0.0, 0.03, 1);
    expect_right_candidates(sheet, random_motion(sheet, 0.03, 32), 1.0, 0.01, 11);
}

TEST(Candidates, EmptyMeshHasNone) {
    Shape s;
    complete(s);
    SerialExec exec;
    EXPECT_EQ(candidates_of(exec, s, {}, 0.0, 1.0), CandidateLists{});
}

TEST(Candidates, AllPointsEqualGivesAllPairs) {
    Shape s = soup(45, 0.1, 5, 1);
    std::fill(s.x.begin(), s.x.end(), Vec3d{0.1, 0.2, 0.3});
    const auto all = [](int, int) { return true; };
    const auto check = [&](const CandidateLists& found, const char* name) {
        // 45 * 44 * 3 vertex-triangle pairs: far more than a group has slots.
        EXPECT_EQ(found.vertex_triangle, brute_vertex_triangle(s, all)) << name;
        EXPECT_EQ(found.edge_edge, brute_edge_edge(s, all)) << name;
    };
    on_all_executors([&](auto& exec) { return candidates_of(exec, s, {}, 0.0, 0.01); },
                     check);
}

TEST(Candidates, CommonMotionDropsOut) {
    const Shape s = two_spheres(0.02, 9);
    const std::vector<Vec3d> p(s.x.size(), Vec3d{5.0, -3.0, 2.0});
    CpuExec exec;
    const CandidateLists moving = candidates_of(exec, s, p, 1.0, 0.1);
    const CandidateLists still = candidates_of(exec, s, {}, 0.0, 0.1);
    EXPECT_GT(still.edge_edge.size(), 0U);
    EXPECT_EQ(moving.edge_edge, still.edge_edge);
    EXPECT_EQ(moving.vertex_triangle, still.vertex_triangle);
}

TEST(Candidates, DoNotDependOnTheAgeOfTheTrees) {
    const Shape s = soup(83, 0.3, 6);
    const std::vector<Vec3d> p = random_motion(s, 0.3, 7);
    std::vector<Vec3d> elsewhere = random_motion(s, 4.0, 8);
    CpuExec exec;
    const CandidateLists fresh = candidates_of(exec, s, p, 1.0, 0.02);
    EXPECT_GT(fresh.vertex_triangle.size(), 100U);
    EXPECT_EQ(candidates_of(exec, s, p, 1.0, 0.02, &elsewhere), fresh);
    EXPECT_EQ(candidates_of(exec, s, {}, 0.0, 0.02, &elsewhere),
              candidates_of(exec, s, {}, 0.0, 0.02));
}

TEST(Candidates, AreEqualForEveryExecutorAndThreadCount) {
    Shape s = soup(203, 0.25, 9);
    s.mesh.walls.push_back({{0.0, 1.0, 0.0}, -0.5});
    s.mesh.walls.push_back({{1.0, 0.0, 0.0}, -0.9});
    s.mesh.wall_enabled.assign(6, 1);
    const std::vector<Vec3d> p = random_motion(s, 0.2, 10);
    SerialExec serial;
    for (const std::vector<Vec3d>& motion : {p, std::vector<Vec3d>{}}) {
        const CandidateLists expected = candidates_of(serial, s, motion, 0.9, 0.02);
        EXPECT_GT(expected.vertex_wall.size(), 50U);
        on_all_executors(
            [&](auto& exec) { return candidates_of(exec, s, motion, 0.9, 0.02); },
            [&](const CandidateLists& found, const char* name) {
                EXPECT_EQ(found, expected) << name;
            });
    }
}

TEST(Candidates, SkipDisabledBodiesAndKinematicPairs) {
    Shape s = two_spheres(0.01, 6);
    CpuExec exec;
    const auto between = [&](const CandidateLists& found) {
        return std::count_if(
            found.edge_edge.begin(), found.edge_edge.end(), [&](const auto& pair) {
                const auto body = [&](int e) {
                    return s.mesh.body[std::size_t(s.mesh.edges[std::size_t(e)][0])];
                };
                return body(pair.first) != body(pair.second);
            });
    };
    const CandidateLists all = candidates_of(exec, s, {}, 0.0, 0.2);
    EXPECT_GT(between(all), 0);
    s.mesh.pair_enabled = {1, 0, 0, 1};
    const CandidateLists self_only = candidates_of(exec, s, {}, 0.0, 0.2);
    EXPECT_EQ(between(self_only), 0);
    EXPECT_GT(self_only.edge_edge.size(), 0U);

    s.mesh.pair_enabled = {1, 1, 1, 1};
    for (std::size_t i = 0; i < s.x.size(); ++i)
        s.mesh.kinematic[i] = s.mesh.body[i] == 1;
    const CandidateLists one_kinematic = candidates_of(exec, s, {}, 0.0, 0.2);
    EXPECT_EQ(between(one_kinematic), between(all));
    EXPECT_LT(one_kinematic.edge_edge.size(), all.edge_edge.size());
    std::fill(s.mesh.kinematic.begin(), s.mesh.kinematic.end(), std::uint8_t{1});
    EXPECT_EQ(candidates_of(exec, s, {}, 0.0, 0.2), CandidateLists{});
}

TEST(Candidates, FindPlanesThatAVertexReaches) {
    Shape s;
    s.x = {{0, 1, 0}, {0, 1, 1}, {1, 1, 0}, {0, 0.05, 0}, {0, 5, 0}};
    s.mesh.triangles = {{{0, 1, 2}}};
    s.mesh.walls = {{{0, 1, 0}, 0.0}, {{0, -1, 0}, -10.0}};
    complete(s, {}, {3, 4});
    std::vector<Vec3d> p(5, Vec3d{0, 0, 0});
    CpuExec exec;
    EXPECT_EQ(candidates_of(exec, s, {}, 0.0, 0.1).vertex_wall, (PairsOfIds{{3, 0}}));
    p[1] = {0, -1.0, 0};  // reaches plane 0 at the end
    p[4] = {0, 4.95, 0};  // comes within 0.05 of plane 1
    EXPECT_EQ(candidates_of(exec, s, p, 1.0, 0.1).vertex_wall,
              (PairsOfIds{{1, 0}, {3, 0}, {4, 1}}));
    EXPECT_EQ(candidates_of(exec, s, p, 0.5, 0.1).vertex_wall, (PairsOfIds{{3, 0}}));
    s.mesh.kinematic[3] = 1;
    EXPECT_EQ(candidates_of(exec, s, {}, 0.0, 0.1).vertex_wall, PairsOfIds{});
}

TEST(Candidates, FindCurvedWallsThatAVertexReaches) {
    Shape s;
    s.x = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1.95, 0}, {1, 1.2, 0}};
    s.mesh.triangles = {{{0, 1, 2}}};
    s.mesh.walls = {{{}, 0.0, WallShape::Sphere, {0, 0, 0}, 2.0},
                    {{1, 0, 0}, 0.0, WallShape::Cylinder, {0, 0, 0}, 3.0}};
    complete(s, {}, {3, 4});
    std::vector<Vec3d> p(5, Vec3d{0, 0, 0});
    CpuExec exec;
    EXPECT_EQ(candidates_of(exec, s, {}, 0.0, 0.1).vertex_wall, (PairsOfIds{{3, 0}}));
    p[1] = {0, 0, 0.95};    // comes within 0.05 of the sphere
    p[4] = {-1.0, 2.0, 0};  // leaves it, and the cylinder at the end
    EXPECT_EQ(candidates_of(exec, s, p, 1.0, 0.1).vertex_wall,
              (PairsOfIds{{1, 0}, {3, 0}, {4, 0}, {4, 1}}));
    EXPECT_EQ(candidates_of(exec, s, p, 0.2, 0.1).vertex_wall, (PairsOfIds{{3, 0}}));
}

TEST(Candidates, FindPointsAndSegmentsOfObstacles) {
    Shape s;
    s.x = {{0, 0, 0},
           {1, 0, 0},
           {0, 1, 0},
           {0.2, 0.2, 0.01},
           {0.5, 0.6, 0.01},
           {0.6, 0.5, -0.01}};
    s.mesh.triangles = {{{0, 1, 2}}};
    complete(s, {{{4, 5}}}, {3});
    CpuExec exec;
    const CandidateLists found = candidates_of(exec, s, {}, 0.0, 0.1);
    const auto& vt = found.vertex_triangle;
    EXPECT_TRUE(std::count(vt.begin(), vt.end(), std::pair(3, 0)) == 1);
    const Int2& last = s.mesh.edges.back();
    EXPECT_EQ(last, (Int2{{4, 5}}));
    EXPECT_FALSE(found.edge_edge.empty());
    for (const auto& pair : found.edge_edge)
        EXPECT_EQ(pair.second, int(s.mesh.edges.size()) - 1);
}

}  // namespace
}  // namespace noli
