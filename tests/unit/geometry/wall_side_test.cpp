// SPDX-License-Identifier: Apache-2.0
#include "geometry/wall_side.hpp"

#include <gtest/gtest.h>

#include <random>

namespace noli::test {
namespace {

using Long = long double;

/// Integers below 2^20 in all places: R^2 |a|^2 - |a x (x - c)|^2 without rounding.
long long cylinder_by_integers(const Wall& wall, const Vec3d& x) {
    const Vec3d y = x - wall.center;
    const Vec3d w = cross(wall.normal, y);
    const auto whole = [](double v) { return static_cast<long long>(v); };
    const long long r_sq = whole(wall.radius) * whole(wall.radius);
    return r_sq * whole(norm_sq(wall.normal)) - whole(norm_sq(w));
}

TEST(WallSide, OfASphereIsDecidedWhereDoublesCancel) {
    const Wall ball{{}, 0.0, WallShape::Sphere, {0, 0, 0}, 1.0};
    // 0.6^2 + 0.8^2: the doubles next to 0.6 and 0.8 make a little more or less than 1.
    const double a = 0.6;
    const double b = 0.8;
    const Long exact = 1.0L - Long(a) * a - Long(b) * b;  // 64 bits hold it
    ASSERT_NE(exact, 0.0L);
    EXPECT_EQ(wall_side(ball, {a, 0, b}), exact > 0 ? 1 : -1);
    EXPECT_EQ(wall_side(ball, {1, 0, 0}), 0);
    EXPECT_EQ(wall_side(ball, {1, 1e-30, 0}), -1);
    EXPECT_EQ(wall_side(ball, {std::nextafter(1.0, 0.0), 1e-30, 0}), 1);
    EXPECT_EQ(wall_side(ball, {0.5, 0, 0}), 1);
    EXPECT_EQ(wall_side(ball, {0.5, -9, 0}), -1);
}

TEST(WallSide, OfACylinderIsDecidedWhereDoublesCancel) {
    std::mt19937 rng(3);
    std::uniform_int_distribution<int> coordinate(-60, 60);
    std::uniform_int_distribution<int> part(-3, 3);
    const auto any = [&](auto& from) {
        return Vec3d{double(from(rng)), double(from(rng)), double(from(rng))};
    };
    int on = 0;
    for (int k = 0; k < 20000; ++k) {
        Wall pipe{any(part), 0.0, WallShape::Cylinder, any(coordinate), 0.0};
        if (norm_sq(pipe.normal) == 0.0) continue;
        const Vec3d x = any(coordinate);
        const Vec3d w = cross(pipe.normal, x - pipe.center);
        // A radius that puts the point on the wall or right beside it.
        pipe.radius = std::floor(norm(w) / norm(pipe.normal)) + part(rng) / 3;
        if (pipe.radius <= 0.0) continue;
        const long long expected = cylinder_by_integers(pipe, x);
        on += expected == 0 ? 1 : 0;
        ASSERT_EQ(detail::cylinder_side_exact(pipe, x),
                  expected > 0 ? 1 : (expected < 0 ? -1 : 0));
    }
    EXPECT_GT(on, 50);
    // A unit direction, where the tests above have whole ones.
    const Wall pipe{{0, 1, 0}, 0.0, WallShape::Cylinder, {0, 7, 0}, 5.0};
    EXPECT_EQ(wall_side(pipe, {3, -1e9, 4}), 0);
    EXPECT_EQ(wall_side(pipe, {3, 0.1, std::nextafter(4.0, 9.0)}), -1);
    EXPECT_EQ(wall_side(pipe, {3, 0.1, std::nextafter(4.0, 0.0)}), 1);
}

TEST(WallSide, OfAHalfSpaceIsThatOfItsPlane) {
    const Wall plane{{0, 1, 0}, 2.0};
    EXPECT_EQ(wall_side(plane, {5, 2, 7}), 0);
    EXPECT_EQ(wall_side(plane, {5, 3, 7}), 1);
    EXPECT_EQ(wall_side(plane, {5, 1, 7}), -1);
}

}  // namespace
}  // namespace noli::test
