// SPDX-License-Identifier: Apache-2.0
#include "geometry/wall_motion.hpp"

#include <gtest/gtest.h>

#include <random>

namespace noli::test {
namespace {

TEST(AdvanceHalfSpace, KeepsTheFractionThatSlackLeaves) {
    EXPECT_NEAR(advance_half_space(0.5, -1.0, 0.8).t, 0.4, 1e-15);
    EXPECT_LE(advance_half_space(0.5, -1.0, 0.8).t, 0.4);
    EXPECT_EQ(advance_half_space(0.5, -0.1, 0.8).t, 1.0);
    EXPECT_EQ(advance_half_space(0.5, 3.0, 0.8).t, 1.0);
    EXPECT_EQ(advance_half_space(0.5, 0.0, 0.8, 0.25).t, 0.25);
    EXPECT_EQ(advance_half_space(0.0, -1.0, 0.8).reason, AdvanceEnd::InitiallyClosed);
    EXPECT_EQ(advance_half_space(-1.0, 1.0, 0.8).reason, AdvanceEnd::InitiallyClosed);
    EXPECT_EQ(advance_half_space(NAN, 1.0, 0.8).reason, AdvanceEnd::NotFinite);
    EXPECT_GT(advance_half_space(1e-300, -1.0, 0.8).t, 0.0);
}

const Wall kBall{{}, 0.0, WallShape::Sphere, {1.0, -2.0, 0.5}, 2.0};
const Wall kPipe{{0.6, 0.0, 0.8}, 0.0, WallShape::Cylinder, {1.0, -2.0, 0.5}, 2.0};

TEST(AdvanceWall, SolvesTheQuadraticOfACurvedWall) {
    // From the centre straight out: 80 % of the radius. Off the centre by 1.2 and across:
    // to where sqrt(1.2^2 + t^2) = 2 - 0.2 * 0.8.
    const Vec3d c = kBall.center;
    EXPECT_NEAR(advance_wall(kBall, c, {0, 3, 0}, 1.0, {}).t, 1.6 / 3.0, 1e-13);
    const Vec3d aside = c + Vec3d{1.2, 0, 0};
    const double t = std::sqrt(1.84 * 1.84 - 1.44);
    EXPECT_NEAR(advance_wall(kBall, aside, {0, 0, 2}, 1.0, {}).t, t / 2.0, 1e-13);
    // Through the inside to the other end: to 1.84 beyond the centre.
    EXPECT_NEAR(advance_wall(kBall, aside, {-4, 0, 0}, 1.0, {}).t, 3.04 / 4.0, 1e-13);
    // Along a cylinder's axis nothing is in the way.
    EXPECT_EQ(advance_wall(kPipe, aside, 1e6 * kPipe.normal, 1.0, {}).t, 1.0);
    EXPECT_NEAR(advance_wall(kPipe, c, {0, -3, 0}, 1.0, {}).t, 1.6 / 3.0, 1e-13);
}

TEST(AdvanceWall, KeepsTheFractionThatSlackLeaves) {
    std::mt19937 rng(5);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const auto any = [&] { return Vec3d{uniform(rng), uniform(rng), uniform(rng)}; };
    int limited = 0;
    for (const Wall& wall : {kBall, kPipe})
        for (int k = 0; k < 4000; ++k) {
            const double depth = std::pow(10.0, -6.0 * std::fabs(uniform(rng)));
            Vec3d out = across_axis(wall, any());
            out = (1.0 / norm(out)) * out;
            const Vec3d x = wall.center + (wall.radius - depth) * out
                          + (wall.shape == WallShape::Cylinder ? 5.0 : 0.0) * uniform(rng)
                                * wall.normal;
            const Vec3d p = std::pow(10.0, 4.0 * uniform(rng)) * any();
            const double before = wall_distance(wall, x);
            const AdvanceParams params{.min_separation = k % 3 == 0 ? 0.3 * before : 0.0};
            const Advance a = advance_wall(wall, x, p, 1.0, params);
            ASSERT_GT(a.t, 0.0);
            const double target = params.min_separation
                                + (1.0 - params.slack) * (before - params.min_separation);
            for (const double part : {0.25, 0.5, 0.9, 1.0})
                ASSERT_GE(wall_distance(wall, x + (part * a.t) * p), target)
                    << "sample " << k;
            if (a.reason == AdvanceEnd::Free) continue;
            ++limited;
            ASSERT_NEAR(wall_distance(wall, x + a.t * p), target, 1e-10 + 1e-6 * target);
        }
    EXPECT_GT(limited, 1000);
}

TEST(AdvanceWall, SaysWhyItEnds) {
    const Vec3d c = kBall.center;
    const Vec3d on = c + Vec3d{2.0, 0, 0};
    EXPECT_EQ(advance_wall(kBall, on, {-1, 0, 0}, 1.0, {}).reason,
              AdvanceEnd::InitiallyClosed);
    EXPECT_EQ(advance_wall(kBall, c, {NAN, 0, 0}, 1.0, {}).reason, AdvanceEnd::NotFinite);
    EXPECT_EQ(advance_wall(kBall, {INFINITY, 0, 0}, {1, 0, 0}, 1.0, {}).reason,
              AdvanceEnd::NotFinite);
    EXPECT_EQ(advance_wall(kBall, c, {0, 0, 0}, 0.5, {}).t, 0.5);
    const Vec3d near{std::nextafter(3.0, 0.0), -2.0, 0.5};
    ASSERT_GT(wall_distance(kBall, near), 0.0);
    EXPECT_EQ(advance_wall(kBall, near, {1, 0, 0}, 1.0, {}).reason,
              AdvanceEnd::BelowRounding);
    EXPECT_EQ(advance_wall(kBall, near, {-1, 0, 0}, 1.0, {}).reason, AdvanceEnd::Free);
}

}  // namespace
}  // namespace noli::test
