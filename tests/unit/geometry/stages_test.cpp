// SPDX-License-Identifier: Apache-2.0
#include "geometry/stages.hpp"

#include "geometry/ccd.hpp"
#include "unit/geometry/oracle.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstdint>

namespace noli::test {
namespace {

/// Numbers as their bits, so that NaN equals NaN and 0 differs from -0.
template <std::size_t N>
std::array<std::uint64_t, N> bits_of(const std::array<double, N>& numbers) {
    std::array<std::uint64_t, N> out;
    for (std::size_t i = 0; i < N; ++i)
        out[i] = std::bit_cast<std::uint64_t>(numbers[i]);
    return out;
}

std::array<double, 6> numbers_of(const ClosestFeature& f) {
    return {double(f.kind),
            double(f.local[0]),
            double(f.local[1]),
            double(f.local[2]),
            double(f.local[3]),
            f.d_sq};
}
template <int S>
std::array<double, 4 + S> numbers_of(const PairGeometry<S>& g) {
    std::array<double, 4 + S> out{g.d, g.n.x, g.n.y, g.n.z};
    for (std::size_t i = 0; i < S; ++i)
        out[4 + i] = g.w[i];
    return out;
}
std::array<double, 4> numbers_of(const Advance& a) {
    return {a.t, double(a.iterations), double(a.capped), double(a.reason)};
}

/// Points move to where those of the reversed stencil are.
Stencil<4> reversal(const Stencil<4>& s) {
    Stencil<4> p;
    for (int i = 0; i < 4; ++i)
        p.x[i] = s.x[3 - i] - s.x[i];
    return p;
}

/// The numbers of F(stencil, stage).
template <auto F>
struct Body {
    Stencil<4> s;
    template <class Stage>
    auto operator()(Stage& stage) const {
        return numbers_of(F(s, stage));
    }
};
using PointTriangle = Body<[](const Stencil<4>& s, auto& stage) {
    return classify_point_triangle(s, stage);
}>;
using EdgeEdge =
    Body<[](const Stencil<4>& s, auto& stage) { return classify_edge_edge(s, stage); }>;
using PointEdgeGeometry = Body<[](const Stencil<4>& s, auto& stage) {
    return point_edge_geometry({{s.x[0], s.x[1], s.x[2]}}, stage);
}>;
using PointTriangleGeometry = Body<[](const Stencil<4>& s, auto& stage) {
    return point_triangle_geometry(s, stage);
}>;
using EdgeEdgeGeometry =
    Body<[](const Stencil<4>& s, auto& stage) { return edge_edge_geometry(s, stage); }>;
using PointTriangleAdvance = Body<[](const Stencil<4>& s, auto& stage) {
    return advance_point_triangle(s, reversal(s), 1.0, {}, stage);
}>;
using EdgeEdgeAdvance = Body<[](const Stencil<4>& s, auto& stage) {
    return advance_edge_edge(s, reversal(s), 1.0, {}, stage);
}>;

template <class>
class Stages : public testing::Test {};
using Bodies = testing::Types<PointTriangle,
                              EdgeEdge,
                              PointEdgeGeometry,
                              PointTriangleGeometry,
                              EdgeEdgeGeometry,
                              PointTriangleAdvance,
                              EdgeEdgeAdvance>;
TYPED_TEST_SUITE(Stages, Bodies);

TYPED_TEST(Stages, DoublesFirstHasTheBitsOfExactly) {
    Random random(91);
    int exact = 0;
    constexpr int kTrials = 20000;
    for (int trial = 0; trial < kTrials; ++trial) {
        SCOPED_TRACE(trial);
        const TypeParam body{degenerate_stencil(random)};
        Exactly exactly;
        InDoubles doubles;
        const auto truth = bits_of(body(exactly));
        const auto rough = bits_of(body(doubles));
        ASSERT_EQ(bits_of(evaluate<Doubles::First>(body)), truth);
        if (doubles.enough()) {
            ASSERT_EQ(rough, truth);
        }
        exact += !doubles.enough();
    }
    // Both ways were gone.
    EXPECT_GT(exact, kTrials / 100);
    EXPECT_LT(exact, kTrials - kTrials / 100);
}

TYPED_TEST(Stages, DoublesSufficeForNextToAllRandomPairs) {
    Random random(92);
    int exact = 0;
    constexpr int kTrials = 20000;
    for (int trial = 0; trial < kTrials; ++trial) {
        InDoubles doubles;
        TypeParam{random.stencil<4>()}(doubles);
        exact += !doubles.enough();
    }
    EXPECT_LT(exact, kTrials / 1000);
}

TEST(InDoubles, NotesWhatCancels) {
    const Stencil<4> ordinary{{{0.2, 0.3, 1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    InDoubles stage;
    classify_point_triangle(ordinary, stage);
    EXPECT_TRUE(stage.enough());

    const Vec3d a{0.1, 0.2, 0.3};
    const Vec3d b{1.1, 0.7, -0.4};
    InDoubles parallel;
    cross_of_edges(a, b, a, a + 0.3 * (b - a), parallel);
    EXPECT_FALSE(parallel.enough());

    InDoubles touching;
    classify_point_triangle({{{0.25, 0.25, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}},
                            touching);
    EXPECT_FALSE(touching.enough());
}

}  // namespace
}  // namespace noli::test
