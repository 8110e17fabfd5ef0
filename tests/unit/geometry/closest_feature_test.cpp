// SPDX-License-Identifier: Apache-2.0
#include "geometry/closest_feature.hpp"

#include "unit/geometry/oracle.hpp"

#include <gtest/gtest.h>

namespace noli::test {
namespace {

/// Distance of the named points or point and segment, evaluated in quad precision; the
/// whole primitives have the distance `whole`.
double named_feature_sq(const Stencil<4>& s, const ClosestFeature& f, double whole) {
    const auto x = [&](int i) { return quad(s.x[f.local[i]]); };
    if (f.kind == PairKind::PointPoint) return double(norm_sq(x(0) - x(1)));
    if (f.kind == PairKind::PointEdge) return double(point_segment_sq(x(0), x(1), x(2)));
    return whole;
}

ClosestFeature exact_point_triangle(const Stencil<4>& s) {
    return classify_point_triangle(s);
}
ClosestFeature exact_edge_edge(const Stencil<4>& s) {
    return classify_edge_edge(s);
}

bool point_triangle_touch(const Stencil<4>& s) {
    return point_on_triangle(s.x[0], s.x[1], s.x[2], s.x[3]);
}
bool edge_edge_touch(const Stencil<4>& s) {
    return segments_intersect_3d(s.x[0], s.x[1], s.x[2], s.x[3]);
}

/// Distances agree to 1e-9 relative, beyond `floor` times the size of the coordinates.
void expect_distance(
    double d_sq, double expected_sq, double size, double floor, const char* what) {
    const double d = std::sqrt(d_sq);
    const double expected = std::sqrt(expected_sq);
    ASSERT_NEAR(d, expected, 1e-9 * expected + floor * size) << what;
}

/// A few roundings of the coordinates.
constexpr double kFloor = 1e-15;

template <class Classify, class Oracle, class Touching>
void expect_least_distance(
    unsigned seed, bool degenerate, Classify classify, Oracle oracle, Touching touching) {
    Random random(seed);
    const int num_trials = degenerate ? 100000 : 30000;
    for (int trial = 0; trial < num_trials; ++trial) {
        SCOPED_TRACE(trial);
        const Stencil<4> s =
            degenerate ? degenerate_stencil(random) : random.stencil<4>();
        const ClosestFeature f = classify(s);
        const double expected = oracle(s);
        expect_distance(f.d_sq, expected, size_of(s), kFloor, "value");
        expect_distance(
            named_feature_sq(s, f, expected), expected, size_of(s), kFloor, "feature");
        if (f.d_sq == 0.0) {
            ASSERT_TRUE(touching(s));
        }
        if (testing::Test::HasFatalFailure()) return;
    }
}

TEST(ClosestFeature, PointTriangleIsTheLeastDistanceOfRandomInput) {
    expect_least_distance(
        1, false, exact_point_triangle, point_triangle_sq, point_triangle_touch);
}
TEST(ClosestFeature, PointTriangleIsTheLeastDistanceOfDegenerateInput) {
    expect_least_distance(
        2, true, exact_point_triangle, point_triangle_sq, point_triangle_touch);
}
TEST(ClosestFeature, EdgeEdgeIsTheLeastDistanceOfRandomInput) {
    expect_least_distance(3, false, exact_edge_edge, edge_edge_sq, edge_edge_touch);
}
TEST(ClosestFeature, EdgeEdgeIsTheLeastDistanceOfDegenerateInput) {
    expect_least_distance(4, true, exact_edge_edge, edge_edge_sq, edge_edge_touch);
}

// The search resolves squared distances to 1e-19 of the squared size only.
TEST(ClosestFeature, AgreesWithNumericalMinimisation) {
    Random random(5);
    for (int trial = 0; trial < 20000; ++trial) {
        SCOPED_TRACE(trial);
        const Stencil<4> s = trial % 2 ? degenerate_stencil(random) : random.stencil<4>();
        expect_distance(classify_point_triangle(s).d_sq,
                        point_triangle_sq_by_search(s),
                        size_of(s),
                        2e-9,
                        "PT");
        expect_distance(classify_edge_edge(s).d_sq,
                        edge_edge_sq_by_search(s),
                        size_of(s),
                        2e-9,
                        "EE");
        if (HasFatalFailure()) return;
    }
}

TEST(ClosestFeature, NearlyParallelEdgesKeepTheirDistance) {
    Random random(6);
    for (int trial = 0; trial < 50000; ++trial) {
        SCOPED_TRACE(trial);
        const Vec3d u = random.vec();
        const double angle = random.log_uniform(-17, -1);
        const double gap = random.log_uniform(-8, 0);
        const Vec3d a0 = random.vec();
        const Vec3d b0 = a0 + random.uniform(-1.2, 1.2) * u + gap * random.vec();
        const Vec3d v = random.log_uniform(-2, 2) * (u + angle * random.vec());
        const Stencil<4> s = {{a0, a0 + u, b0, b0 + v}};
        const ClosestFeature f = classify_edge_edge(s);
        expect_distance(f.d_sq, edge_edge_sq(s), size_of(s), kFloor, "value");
        if (HasFatalFailure()) return;
    }
}

TEST(ClosestFeature, NamesEachRegionOfATriangle) {
    const Vec3d a = {0, 0, 0}, b = {1, 0, 0}, c = {0, 1, 0};
    const auto at = [&](double x, double y) {
        return classify_point_triangle({{{x, y, 0.5}, a, b, c}});
    };
    const auto expect = [](const ClosestFeature& f, PairKind kind, Int4 local) {
        EXPECT_EQ(f.kind, kind);
        for (int i = 0; i < 4; ++i)
            EXPECT_EQ(f.local[i], local[i]) << i;
    };
    expect(at(0.2, 0.2), PairKind::PointTriangle, {{0, 1, 2, 3}});
    expect(at(0.5, -1.0), PairKind::PointEdge, {{0, 1, 2, -1}});
    expect(at(1.0, 1.0), PairKind::PointEdge, {{0, 2, 3, -1}});
    expect(at(-1.0, 0.5), PairKind::PointEdge, {{0, 3, 1, -1}});
    expect(at(-1.0, -1.0), PairKind::PointPoint, {{0, 1, -1, -1}});
    expect(at(3.0, 0.0), PairKind::PointPoint, {{0, 2, -1, -1}});
    expect(at(0.0, 3.0), PairKind::PointPoint, {{0, 3, -1, -1}});
}

TEST(ClosestFeature, NamesEachRegionOfTwoEdges) {
    const auto classify = [](Vec3d b0, Vec3d b1) {
        return classify_edge_edge({{{0, 0, 0}, {1, 0, 0}, b0, b1}});
    };
    const auto expect = [](const ClosestFeature& f, PairKind kind, Int4 local) {
        EXPECT_EQ(f.kind, kind);
        for (int i = 0; i < 4; ++i)
            EXPECT_EQ(f.local[i], local[i]) << i;
    };
    expect(classify({0.5, -1, 1}, {0.5, 1, 1}), PairKind::EdgeEdge, {{0, 1, 2, 3}});
    expect(classify({0.5, 1, 1}, {0.5, 2, 1}), PairKind::PointEdge, {{2, 0, 1, -1}});
    expect(classify({0.5, 2, 1}, {0.5, 1, 1}), PairKind::PointEdge, {{3, 0, 1, -1}});
    expect(classify({2, -1, 1}, {2, 1, 1}), PairKind::PointEdge, {{1, 2, 3, -1}});
    expect(classify({-2, -1, 1}, {-2, 1, 1}), PairKind::PointEdge, {{0, 2, 3, -1}});
    expect(classify({2, 1, 1}, {2, 2, 1}), PairKind::PointPoint, {{1, 2, -1, -1}});
    expect(classify({-2, 2, 1}, {-2, 1, 1}), PairKind::PointPoint, {{0, 3, -1, -1}});
}

TEST(ClosestFeature, ParallelOverlappingEdgesAreAPointAndAnEdge) {
    const ClosestFeature f =
        classify_edge_edge({{{0, 0, 0}, {1, 0, 0}, {0.5, 0.25, 0}, {1.5, 0.25, 0}}});
    EXPECT_EQ(f.kind, PairKind::PointEdge);
    EXPECT_EQ(f.d_sq, 0.0625);
}

TEST(ClosestFeature, GapOfOneUlpIsNotZero) {
    const double above = std::nextafter(0.25, 1.0);
    const Vec3d a = {1e3, 0, 0.25}, b = {1e3 + 1, 0.125, 0.25}, c = {1e3 + 0.5, 1, 0.25};
    const ClosestFeature f =
        classify_point_triangle({{{1e3 + 0.5, 0.375, above}, a, b, c}});
    EXPECT_EQ(f.kind, PairKind::PointTriangle);
    EXPECT_DOUBLE_EQ(std::sqrt(f.d_sq), above - 0.25);
}

TEST(ClosestFeature, TouchingIsZero) {
    EXPECT_EQ(
        classify_point_triangle({{{0.25, 0.25, 1}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}}})
            .d_sq,
        0.0);
    EXPECT_EQ(classify_edge_edge({{{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}}}).d_sq,
              0.0);
    EXPECT_EQ(classify_edge_edge({{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}}}).d_sq,
              0.0);
}

}  // namespace
}  // namespace noli::test
