// SPDX-License-Identifier: Apache-2.0
#include "geometry/pair_geometry.hpp"

#include "geometry/closest_feature.hpp"
#include "unit/geometry/oracle.hpp"

#include <gtest/gtest.h>

namespace noli::test {
namespace {

template <int S>
Vec3d weighted_sum(const Stencil<S>& s, const PairGeometry<S>& g) {
    Vec3d r = {0, 0, 0};
    for (int i = 0; i < S; ++i)
        r += g.w[i] * s.x[i];
    return r;
}

/// r = sum w x = d n, weights sum to 0, and w_i n is the derivative of d.
template <int S, class Geometry, class DistanceSq>
void expect_consistent(Stencil<S> s,
                       Geometry geometry,
                       DistanceSq distance_sq,
                       double tolerance) {
    const PairGeometry<S> g = geometry(s);
    const Vec3d r = weighted_sum(s, g);
    ASSERT_NEAR(norm(g.n), 1.0, 1e-14);
    ASSERT_NEAR(norm(r - g.d * g.n), 0.0, tolerance);
    ASSERT_NEAR(distance_sq(s), g.d * g.d, 1e-12 * g.d * g.d);
    double sum = 0;
    for (double w : g.w)
        sum += w;
    ASSERT_NEAR(sum, 0.0, 1e-12);
    const double h = 1e-6;
    for (int i = 0; i < S; ++i) {
        for (int c = 0; c < 3; ++c) {
            const double kept = s.x[i][c];
            s.x[i][c] = kept + h;
            const double above = std::sqrt(distance_sq(s));
            s.x[i][c] = kept - h;
            const double below = std::sqrt(distance_sq(s));
            s.x[i][c] = kept;
            ASSERT_NEAR((above - below) / (2 * h), g.w[i] * g.n[c], 1e-6)
                << i << "," << c;
        }
    }
}

/// Random stencils whose distance is not small and whose edges and areas are not either,
/// so that central differences are good to 1e-6.
template <int S, class Geometry, class DistanceSq>
void run_consistency(unsigned seed, Geometry geometry, DistanceSq distance_sq) {
    Random random(seed);
    int tested = 0;
    while (tested < 2000) {
        const Stencil<S> s = random.stencil<S>();
        const PairGeometry<S> g = geometry(s);
        double largest_weight = 0;
        for (double w : g.w)
            largest_weight = std::max(largest_weight, std::fabs(w));
        if (g.d < 0.05 || largest_weight > 3.0) continue;
        expect_consistent<S>(s, geometry, distance_sq, 1e-13);
        if (testing::Test::HasFatalFailure()) return;
        ++tested;
    }
}

PairGeometry<3> exact_point_edge(const Stencil<3>& s) {
    return point_edge_geometry(s);
}
PairGeometry<4> exact_point_triangle(const Stencil<4>& s) {
    return point_triangle_geometry(s);
}
PairGeometry<4> exact_edge_edge(const Stencil<4>& s) {
    return edge_edge_geometry(s);
}

TEST(PairGeometry, PointPointWeightsAreTheGradient) {
    run_consistency<2>(51, point_point_geometry, point_point_distance_sq);
}
TEST(PairGeometry, PointEdgeWeightsAreTheGradient) {
    run_consistency<3>(52, exact_point_edge, point_edge_distance_sq);
}
TEST(PairGeometry, PointTriangleWeightsAreTheGradient) {
    run_consistency<4>(53, exact_point_triangle, point_triangle_distance_sq);
}
TEST(PairGeometry, EdgeEdgeWeightsAreTheGradient) {
    run_consistency<4>(54, exact_edge_edge, edge_edge_distance_sq);
}

TEST(PairGeometry, ClosestPointsOfHandMadePairs) {
    const auto pe = point_edge_geometry({{{0.25, 2, 0}, {0, 0, 0}, {1, 0, 0}}});
    EXPECT_DOUBLE_EQ(pe.d, 2.0);
    EXPECT_DOUBLE_EQ(pe.w[1], -0.75);
    EXPECT_DOUBLE_EQ(pe.w[2], -0.25);
    EXPECT_DOUBLE_EQ(pe.n.y, 1.0);
    const auto pt =
        point_triangle_geometry({{{0.25, 0.5, -3}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}});
    EXPECT_DOUBLE_EQ(pt.d, 3.0);
    EXPECT_DOUBLE_EQ(pt.w[1], -0.25);
    EXPECT_DOUBLE_EQ(pt.w[2], -0.25);
    EXPECT_DOUBLE_EQ(pt.w[3], -0.5);
    EXPECT_DOUBLE_EQ(pt.n.z, -1.0);
    const auto ee =
        edge_edge_geometry({{{0, 0, 0}, {1, 0, 0}, {0.25, -1, 4}, {0.25, 3, 4}}});
    EXPECT_DOUBLE_EQ(ee.d, 4.0);
    EXPECT_DOUBLE_EQ(ee.w[0], 0.75);
    EXPECT_DOUBLE_EQ(ee.w[1], 0.25);
    EXPECT_DOUBLE_EQ(ee.w[2], -0.75);
    EXPECT_DOUBLE_EQ(ee.w[3], -0.25);
    EXPECT_DOUBLE_EQ(ee.n.z, -1.0);
}

TEST(PairGeometry, SwappingTheSidesFlipsTheNormal) {
    Random random(55);
    for (int trial = 0; trial < 1000; ++trial) {
        const Stencil<4> s = random.stencil<4>();
        const auto ab = edge_edge_geometry(s);
        const auto ba = edge_edge_geometry({{s.x[2], s.x[3], s.x[0], s.x[1]}});
        ASSERT_NEAR(norm(ab.n + ba.n), 0.0, 1e-9);
        const auto up = point_triangle_geometry(s);
        const auto down = point_triangle_geometry({{s.x[0], s.x[1], s.x[3], s.x[2]}});
        ASSERT_NEAR(norm(up.n - down.n), 0.0, 1e-9);  // winding does not matter
    }
}

// The reason for cross products: at d = 1e-12 of the edge length r / |r| has lost its
// direction.
TEST(PairGeometry, NormalIsAccurateWhenTheGapIsTiny) {
    Random random(56);
    for (int trial = 0; trial < 2000; ++trial) {
        const Stencil<4> triangle = random.stencil<4>();
        const Vec3d a = triangle.x[1], b = triangle.x[2], c = triangle.x[3];
        const Vec3d N = cross(b - a, c - a);
        if (norm(N) < 0.1) continue;
        const double u = random.uniform(0.1, 0.4), v = random.uniform(0.1, 0.4);
        const double gap = random.log_uniform(-14, -9);
        const Vec3d p = a + u * (b - a) + v * (c - a) + gap * normalized(N);
        const Stencil<4> s = {{p, a, b, c}};
        const auto g = point_triangle_geometry(s);
        ASSERT_NEAR(std::fabs(dot(g.n, normalized(N))), 1.0, 1e-13);
        ASSERT_NEAR(norm(cross(g.n, normalized(N))), 0.0, 1e-13);
        const double exact = std::sqrt(point_triangle_sq(s));
        ASSERT_NEAR(g.d, exact, 1e-9 * exact);
    }
}

TEST(PairGeometry, DegenerateKindsGiveZerosAndNoNaN) {
    const Vec3d o = {0, 0, 0}, e = {1, 0, 0};
    const auto pp = point_point_geometry({{o, o}});
    EXPECT_EQ(norm(pp.n), 0.0);
    const auto pe = point_edge_geometry({{e, o, o}});
    EXPECT_EQ(norm(pe.n), 0.0);
    EXPECT_EQ(pe.d, 0.0);
    const auto pt = point_triangle_geometry({{{0, 1, 0}, o, e, 2.0 * e}});
    EXPECT_EQ(norm(pt.n), 0.0);
    EXPECT_EQ(pt.d, 0.0);
    const auto ee = edge_edge_geometry({{o, e, {0, 1, 0}, {1, 1, 0}}});
    EXPECT_EQ(norm(ee.n), 0.0);
    EXPECT_EQ(ee.d, 0.0);
    for (double w : ee.w)
        EXPECT_EQ(w, w);
}

TEST(PairGeometry, EdgeCrossSquaredIsTheMollifierArgument) {
    EXPECT_DOUBLE_EQ(edge_cross_sq({{{0, 0, 0}, {2, 0, 0}, {5, 5, 5}, {5, 8, 5}}}), 36.0);
    EXPECT_EQ(edge_cross_sq({{{0, 0, 0}, {2, 0, 0}, {5, 5, 5}, {9, 5, 5}}}), 0.0);
}

}  // namespace
}  // namespace noli::test
