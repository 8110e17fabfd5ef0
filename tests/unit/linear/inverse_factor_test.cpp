// SPDX-License-Identifier: Apache-2.0
#include "linear/inverse_factor.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <cmath>

namespace noli {
namespace {

TEST(InvertFactor, InvertsTheCholeskyFactor) {
    const Mat3d m = {4, 2, -1, 2, 5, 0.5, -1, 0.5, 3};
    InverseFactor f;
    ASSERT_TRUE(invert_factor(m, f));
    Eigen::Matrix3d c;
    for (int r = 0; r < 3; ++r)
        c.row(r) << f.c0[r], f.c1[r], f.c2[r];
    const Eigen::Matrix3d dense = Eigen::Map<const Eigen::Matrix3d>(m.a);
    EXPECT_LT((c * dense * c.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
    EXPECT_EQ(f.c1[0], 0.0);
    EXPECT_EQ(f.c0[3], 0.0);
}

TEST(InvertFactor, SaysWhenABlockIsNotPositive) {
    InverseFactor f;
    EXPECT_FALSE(invert_factor({1, 2, 0, 2, 1, 0, 0, 0, 1}, f));
    EXPECT_FALSE(invert_factor({1, 0, 0, 0, -1, 0, 0, 0, 1}, f));
    EXPECT_FALSE(invert_factor({-1, 0, 0, 0, -1, 0, 0, 0, -1}, f));
    EXPECT_FALSE(invert_factor({1, 0, 0, 0, std::nan(""), 0, 0, 0, 1}, f));
    EXPECT_TRUE(invert_factor(outer(Vec3d{1, 2, 3}, Vec3d{1, 2, 3}), f));  // singular
    EXPECT_TRUE(std::isfinite(f.c2[2]));
    EXPECT_TRUE(invert_factor(zero3(), f));
    EXPECT_EQ(f.c0[0], 0.0);
}

}  // namespace
}  // namespace noli
