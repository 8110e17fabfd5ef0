// SPDX-License-Identifier: Apache-2.0
#include "geometry/ray.hpp"

#include <gtest/gtest.h>

#include <random>
#include <utility>

namespace noli {
namespace {

const Vec3d kA{1, -1, -1};
const Vec3d kB{1, 2, -1};
const Vec3d kC{1, -1, 2};  // (b - a) x (c - a) points along +x

TEST(CrossRay, LeavesThroughAFrontAndEntersThroughABack) {
    const Vec3d p{0, 0.1, 0.2};
    const RayCrossing out = cross_ray(p, kA, kB, kC);
    EXPECT_TRUE(out.is_clear);
    EXPECT_EQ(out.turns, 1);
    EXPECT_EQ(cross_ray(p, kB, kA, kC).turns, -1);
    EXPECT_EQ(cross_ray({2, 0.1, 0.2}, kA, kB, kC).turns, 0);   // behind
    EXPECT_EQ(cross_ray({0, 1.9, 1.9}, kA, kB, kC).turns, 0);   // beside, within the box
    EXPECT_EQ(cross_ray({0, -1.1, 0.0}, kA, kB, kC).turns, 0);  // beside
}

TEST(CrossRay, SaysWhereItMeetsABorderOrTheTriangleItself) {
    EXPECT_FALSE(cross_ray({0, -1, 0}, kA, kB, kC).is_clear);   // an edge
    EXPECT_FALSE(cross_ray({0, -1, -1}, kA, kB, kC).is_clear);  // a corner
    EXPECT_FALSE(cross_ray({1, 0, 0}, kA, kB, kC).is_clear);    // starts on it
    EXPECT_FALSE(cross_ray({0, 0, 0}, {1, 0, -1}, {2, 0, -1}, {1.5, 0, 1}).is_clear);
}

TEST(CrossRay, CountsAPointInARandomTetrahedronOnce) {
    std::mt19937 dice(5);
    std::uniform_real_distribution<double> u(-1, 1);
    const auto point = [&] { return Vec3d{u(dice), u(dice), u(dice)}; };
    int inside = 0;
    for (int k = 0; k < 4000; ++k) {
        Vec3d t[4] = {point(), point(), point(), point()};
        if (orient3d_sign(t[0], t[1], t[2], t[3]) < 0) std::swap(t[2], t[3]);
        const Vec3d p = point();
        // Inside: on the inner side of all four faces, which are listed to face outwards.
        constexpr int kFaces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
        bool expected = true;
        int turns = 0;
        for (const auto& f : kFaces) {
            expected = expected && orient3d_sign(t[f[0]], t[f[1]], t[f[2]], p) < 0;
            const RayCrossing found = cross_ray(p, t[f[0]], t[f[1]], t[f[2]]);
            EXPECT_TRUE(found.is_clear);
            turns += found.turns;
        }
        EXPECT_EQ(turns, expected ? 1 : 0) << k;
        inside += expected ? 1 : 0;
    }
    EXPECT_GT(inside, 50);
}

}  // namespace
}  // namespace noli
