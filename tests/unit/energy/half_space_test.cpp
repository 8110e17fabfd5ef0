// SPDX-License-Identifier: Apache-2.0
#include "energy/half_space.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace noli {
namespace {

constexpr BarrierPlane kTilted{{0.6, 0.0, 0.8}, -0.5};

Vec3d at_distance(double d) {
    return (d + kTilted.offset) * kTilted.normal + Vec3d{-0.8, 3.0, 0.6};
}

TEST(HalfSpacePair, MeasuresTheSignedDistance) {
    EXPECT_NEAR(half_space_distance(at_distance(0.25), kTilted), 0.25, 1e-15);
    EXPECT_NEAR(half_space_distance(at_distance(-0.25), kTilted), -0.25, 1e-15);
}

TEST(HalfSpacePair, IsTheBarrierOfThePoint) {
    for (int r : {1, 2}) {
        const BarrierParams params{0.1, 7.0, r, 0.0};
        const Vec3d x = at_distance(0.05);
        // g = 1/4: 7 dhat^4 (3/4)^2 (ln 4)^r
        EXPECT_NEAR(half_space_energy(x, kTilted, params),
                    7e-4 * 0.5625 * std::pow(std::log(4.0), r),
                    1e-15);
        const Vec3d g = half_space_gradient(x, kTilted, params).g[0];
        EXPECT_LT(dot(g, kTilted.normal), 0.0);
        EXPECT_LE(norm(cross(g, kTilted.normal)), 1e-16);
        const StencilModes<1, 1> H = half_space_hessian(x, kTilted, params);
        ASSERT_EQ(H.rank, 1);
        // kappa dhat^2 lambda_1(1/4), reference table of MATH 1.3
        EXPECT_NEAR(norm_sq(H.q[0][0]), 7e-2 * (r == 1 ? 15.1137 : 61.8259), 1e-6);
    }
}

TEST(HalfSpacePair, IsZeroBeyondAndInfiniteBehind) {
    const BarrierParams params{0.1, 7.0, 2, 0.0};
    EXPECT_EQ(half_space_energy(at_distance(0.1001), kTilted, params), 0.0);
    EXPECT_EQ(norm(half_space_gradient(at_distance(0.1001), kTilted, params).g[0]), 0.0);
    EXPECT_EQ(half_space_hessian(at_distance(0.1001), kTilted, params).rank, 0);
    EXPECT_TRUE(std::isinf(half_space_energy(at_distance(-0.02), kTilted, params)));
    EXPECT_TRUE(std::isinf(half_space_energy({0, 0, 0}, {{0, 0, 1}, 0.0}, params)));
}

TEST(HalfSpacePair, IgnoresTheCap) {
    const BarrierParams capped{0.1, 7.0, 2, 1e-4};
    const BarrierParams plain{0.1, 7.0, 2, 0.0};
    const Vec3d x = at_distance(1e-5);
    EXPECT_EQ(norm(half_space_hessian(x, kTilted, capped).q[0][0]),
              norm(half_space_hessian(x, kTilted, plain).q[0][0]));
}

}  // namespace
}  // namespace noli
