// SPDX-License-Identifier: Apache-2.0
#include "geometry/aabb.hpp"

#include "unit/geometry/oracle.hpp"

#include <gtest/gtest.h>

namespace noli::test {
namespace {

void expect_vec(const Vec3d& a, const Vec3d& b) {
    EXPECT_EQ(a.x, b.x);
    EXPECT_EQ(a.y, b.y);
    EXPECT_EQ(a.z, b.z);
}

bool contains(const Aabb& box, const Vec3d& x) {
    return overlap(box, aabb_of_point(x));
}

TEST(Aabb, BoxOfPointsIsTight) {
    const Aabb box = aabb_of_points<3>({{{1, -2, 3}, {0, 5, 3}, {-1, 0, 4}}});
    expect_vec(box.lo, {-1, -2, 3});
    expect_vec(box.hi, {1, 5, 4});
    expect_vec(center(box), {0, 1.5, 3.5});
}

TEST(Aabb, EmptyBoxIsTheNeutralElementOfMerging) {
    const Aabb box = {{-1, 2, 3}, {4, 5, 6}};
    EXPECT_TRUE(is_empty(empty_aabb()));
    EXPECT_FALSE(is_empty(box));
    const Aabb same = merged(empty_aabb(), box);
    expect_vec(same.lo, box.lo);
    expect_vec(same.hi, box.hi);
    EXPECT_FALSE(overlap(empty_aabb(), box));
}

TEST(Aabb, TouchingBoxesOverlapAndPartedOnesDoNot) {
    const Aabb unit = {{0, 0, 0}, {1, 1, 1}};
    EXPECT_TRUE(overlap(unit, {{1, 1, 1}, {2, 2, 2}}));
    for (int axis = 0; axis < 3; ++axis) {
        Aabb other = unit;
        other.lo[axis] = std::nextafter(1.0, 2.0);
        other.hi[axis] = 3.0;
        EXPECT_FALSE(overlap(unit, other)) << axis;
        EXPECT_FALSE(overlap(other, unit)) << axis;
        EXPECT_TRUE(overlap(inflated(unit, 1e-12), other)) << axis;
    }
}

TEST(Aabb, DistanceIsThatOfTheNearestCorners) {
    const Aabb unit = {{0, 0, 0}, {1, 1, 1}};
    EXPECT_EQ(distance_sq(unit, {{3, 4, 5}, {6, 6, 6}}), 4.0 + 9.0 + 16.0);
    EXPECT_EQ(distance_sq({{3, 0.5, -5}, {6, 6, -2}}, unit), 4.0 + 4.0);
    EXPECT_EQ(distance_sq(unit, {{0.5, 0.5, 0.5}, {9, 9, 9}}), 0.0);
}

TEST(Aabb, SweptBoxHoldsEveryTime) {
    Random random(61);
    for (int trial = 0; trial < 1000; ++trial) {
        const Stencil<4> x = random.stencil<4>();
        const Stencil<4> p = random.stencil<4>();
        const double t = random.uniform(0, 2);
        const Aabb box = inflated(aabb_of_swept_points(x, p, t), 1e-14);
        for (int k = 0; k <= 4; ++k)
            for (int i = 0; i < 4; ++i)
                ASSERT_TRUE(contains(box, x.x[i] + (t * k / 4) * p.x[i]));
    }
}

}  // namespace
}  // namespace noli::test
