// SPDX-License-Identifier: Apache-2.0
#include "energy/wall.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace noli {
namespace {

constexpr Wall kTilted{{0.6, 0.0, 0.8}, -0.5};

Vec3d at_distance(double d) {
    return (d + kTilted.offset) * kTilted.normal + Vec3d{-0.8, 3.0, 0.6};
}

TEST(HalfSpacePair, MeasuresTheSignedDistance) {
    EXPECT_NEAR(wall_distance(kTilted, at_distance(0.25)), 0.25, 1e-15);
    EXPECT_NEAR(wall_distance(kTilted, at_distance(-0.25)), -0.25, 1e-15);
}

TEST(HalfSpacePair, IsTheBarrierOfThePoint) {
    for (int r : {1, 2}) {
        const BarrierParams params{0.1, 7.0, r, 0.0};
        const Vec3d x = at_distance(0.05);
        // g = 1/4: 7 dhat^4 (3/4)^2 (ln 4)^r
        EXPECT_NEAR(wall_energy(x, kTilted, params),
                    7e-4 * 0.5625 * std::pow(std::log(4.0), r),
                    1e-15);
        const Vec3d g = wall_gradient(x, kTilted, params).g[0];
        EXPECT_LT(dot(g, kTilted.normal), 0.0);
        EXPECT_LE(norm(cross(g, kTilted.normal)), 1e-16);
        const StencilModes<1, kMaxWallRank> H = wall_hessian(x, kTilted, params);
        ASSERT_EQ(H.rank, 1);
        // kappa dhat^2 lambda_1(1/4), reference table of MATH 1.3
        EXPECT_NEAR(norm_sq(H.q[0][0]), 7e-2 * (r == 1 ? 15.1137 : 61.8259), 1e-6);
    }
}

TEST(HalfSpacePair, IsZeroBeyondAndInfiniteBehind) {
    const BarrierParams params{0.1, 7.0, 2, 0.0};
    EXPECT_EQ(wall_energy(at_distance(0.1001), kTilted, params), 0.0);
    EXPECT_EQ(norm(wall_gradient(at_distance(0.1001), kTilted, params).g[0]), 0.0);
    EXPECT_EQ(wall_hessian(at_distance(0.1001), kTilted, params).rank, 0);
    EXPECT_TRUE(std::isinf(wall_energy(at_distance(-0.02), kTilted, params)));
    EXPECT_TRUE(std::isinf(wall_energy({0, 0, 0}, {{0, 0, 1}, 0.0}, params)));
}

TEST(HalfSpacePair, IgnoresTheCap) {
    const BarrierParams capped{0.1, 7.0, 2, 1e-4};
    const BarrierParams plain{0.1, 7.0, 2, 0.0};
    const Vec3d x = at_distance(1e-5);
    EXPECT_EQ(norm(wall_hessian(x, kTilted, capped).q[0][0]),
              norm(wall_hessian(x, kTilted, plain).q[0][0]));
}

constexpr Wall kBall{{}, 0.0, WallShape::Sphere, {1.0, 2.0, 3.0}, 2.0};
constexpr Wall kPipe{{0.0, 0.6, 0.8}, 0.0, WallShape::Cylinder, {1.0, 2.0, 3.0}, 2.0};

TEST(CurvedWall, MeasuresTheDistanceFromInside) {
    EXPECT_NEAR(wall_distance(kBall, {1.0, 2.0, 4.5}), 0.5, 1e-15);
    EXPECT_NEAR(wall_distance(kBall, {1.0, -1.0, 3.0}), -1.0, 1e-15);
    EXPECT_EQ(wall_distance(kBall, kBall.center), 2.0);
    EXPECT_NEAR(wall_distance(kPipe, {1.5, 2.0, 3.0}), 1.5, 1e-15);
    EXPECT_NEAR(wall_distance(kPipe, kPipe.center + 100.0 * kPipe.normal), 2.0, 1e-13);
    EXPECT_NEAR(norm(wall_normal(kPipe, {1.5, 2.6, 3.8}) - Vec3d{-1, 0, 0}), 0.0, 1e-14);
}

TEST(CurvedWall, IsTheBarrierOfThePointAndCurves) {
    const BarrierParams params{0.1, 7.0, 2, 0.0};
    for (const Wall& wall : {kBall, kPipe}) {
        const Vec3d x{1.0 + 1.95, 2.0, 3.0};
        EXPECT_NEAR(wall_energy(x, wall, params),
                    7e-4 * 0.5625 * std::pow(std::log(4.0), 2),
                    1e-15);
        const Vec3d g = wall_gradient(x, wall, params).g[0];
        EXPECT_GT(g.x, 0.0);  // the force -g is inwards
        EXPECT_NEAR(norm(cross(g, Vec3d{1, 0, 0})), 0.0, 1e-14);
        const StencilModes<1, kMaxWallRank> H = wall_hessian(x, wall, params);
        ASSERT_EQ(H.rank, wall.shape == WallShape::Sphere ? 3 : 2);
        EXPECT_NEAR(norm_sq(H.q[0][0]), 7e-2 * 61.8259, 1e-6);
        for (int k = 1; k < H.rank; ++k) {
            EXPECT_NEAR(norm_sq(H.q[k][0]), norm(g) / 1.95, 1e-12);
            EXPECT_NEAR(dot(H.q[k][0], H.q[0][0]), 0.0, 1e-12);
            EXPECT_NEAR(dot(H.q[k][0], wall.normal), 0.0, 1e-12);
        }
    }
}

TEST(CurvedWall, IsZeroFarInsideAndInfiniteOutside) {
    const BarrierParams params{0.1, 7.0, 2, 0.0};
    EXPECT_EQ(wall_energy(kBall.center, kBall, params), 0.0);
    EXPECT_EQ(norm(wall_gradient(kBall.center, kBall, params).g[0]), 0.0);
    EXPECT_EQ(wall_hessian(kBall.center, kBall, params).rank, 0);
    EXPECT_TRUE(std::isinf(wall_energy({1.0, 2.0, 5.5}, kBall, params)));
    EXPECT_TRUE(std::isinf(wall_energy({3.1, 2.0, 3.0}, kPipe, params)));
}

}  // namespace
}  // namespace noli
