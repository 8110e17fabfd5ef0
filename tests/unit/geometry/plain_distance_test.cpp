// SPDX-License-Identifier: Apache-2.0
#include "geometry/plain_distance.hpp"

#include "geometry/closest_feature.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace noli {
namespace {

Vec3d random_point(std::mt19937& rng) {
    std::uniform_real_distribution<double> by(-1.0, 1.0);
    return {by(rng), by(rng), by(rng)};
}

/// Four points; in every other case nearly or exactly degenerate.
Stencil<4> random_pair(std::mt19937& rng, int trial) {
    Stencil<4> s;
    for (Vec3d& x : s.x)
        x = random_point(rng);
    const double flat = trial % 8 == 1 ? 0.0 : std::pow(10.0, -2.0 * (trial % 8));
    if (trial % 2 == 1) s.x[3] = s.x[1] + 0.7 * (s.x[2] - s.x[1]) + flat * s.x[3];
    if (trial % 4 == 3) s.x[1] = s.x[0] + (s.x[3] - s.x[2]) + flat * s.x[1];
    return s;
}

double size_of(const Stencil<4>& s) {
    double size = 0.0;
    for (int i = 1; i < 4; ++i)
        size = std::fmax(size, max_abs(s.x[i] - s.x[0]));
    return size;
}

TEST(PlainDistance, IsTheDistanceUpToItsStatedError) {
    std::mt19937 rng(4);
    for (int trial = 0; trial < 200000; ++trial) {
        const Stencil<4> s = random_pair(rng, trial);
        const double room = kPlainError * size_of(s);
        const double pt =
            std::sqrt(plain_point_triangle_sq(s.x[0], s.x[1], s.x[2], s.x[3]));
        EXPECT_NEAR(pt, std::sqrt(classify_point_triangle(s).d_sq), room) << trial;
        const double ee = std::sqrt(plain_edge_edge_sq(s.x[0], s.x[1], s.x[2], s.x[3]));
        EXPECT_NEAR(ee, std::sqrt(classify_edge_edge(s).d_sq), room) << trial;
    }
}

TEST(PlainDistance, OfPrimitivesWithoutExtentIsThatOfPoints) {
    const Vec3d p{1, 2, 3};
    const Vec3d a{1, 2, 5};
    EXPECT_EQ(plain_point_segment_sq(p, a, a), 4.0);
    EXPECT_EQ(plain_point_triangle_sq(p, a, a, a), 4.0);
    EXPECT_EQ(plain_edge_edge_sq(p, p, a, a), 4.0);
}

}  // namespace
}  // namespace noli
