// SPDX-License-Identifier: Apache-2.0
#include "core/morton.hpp"

#include <gtest/gtest.h>

#include <random>

namespace noli {
namespace {

std::vector<Vec3d> random_points(int n, unsigned seed) {
    std::mt19937 rng(seed);
    std::uniform_real_distribution<double> coordinate(-3.0, 5.0);
    std::vector<Vec3d> points(static_cast<std::size_t>(n));
    for (Vec3d& x : points)
        x = {coordinate(rng), 0.3 * coordinate(rng), coordinate(rng)};
    return points;
}

bool is_permutation(std::vector<int> order) {
    std::sort(order.begin(), order.end());
    for (std::size_t i = 0; i < order.size(); ++i)
        if (order[i] != static_cast<int>(i)) return false;
    return true;
}

TEST(MortonOrder, IsAPermutation) {
    for (const int n : {0, 1, 2, 3, 100, 5000}) {
        const std::vector<int> order = morton_order(random_points(n, 4));
        EXPECT_EQ(order.size(), static_cast<std::size_t>(n));
        EXPECT_TRUE(is_permutation(order));
    }
}

TEST(MortonOrder, KeepsTheOrderOfEqualPoints) {
    std::vector<Vec3d> points = random_points(40, 7);
    const std::vector<Vec3d> once = points;
    for (int copy = 0; copy < 4; ++copy)
        points.insert(points.end(), once.begin(), once.end());
    const std::vector<int> order = morton_order(points);
    ASSERT_TRUE(is_permutation(order));
    for (std::size_t i = 0; i < order.size(); i += 5)
        for (std::size_t k = 1; k < 5; ++k)
            EXPECT_EQ(order[i + k], order[i + k - 1] + 40);
    EXPECT_EQ(morton_order(std::vector<Vec3d>(5, Vec3d{2, 2, 2})),
              (std::vector<int>{0, 1, 2, 3, 4}));
}

TEST(MortonOrder, VisitsTheEightCornersWithXFirst) {
    std::vector<Vec3d> corners;
    for (int c = 7; c >= 0; --c)
        corners.push_back({static_cast<double>(c & 1),
                           static_cast<double>((c >> 1) & 1),
                           static_cast<double>(c >> 2)});
    EXPECT_EQ(morton_order(corners), (std::vector<int>{7, 6, 5, 4, 3, 2, 1, 0}));
}

TEST(MortonOrder, VisitsOneOctantAfterTheOther) {
    std::vector<Vec3d> points = random_points(3000, 5);
    for (Vec3d& x : points)
        x = {(x.x + 3.0) / 8.0, (x.y + 0.9) / 2.4, (x.z + 3.0) / 8.0};
    points.push_back({0, 0, 0});
    points.push_back({1, 1, 1});  // the grid's cube is the unit cube
    int last = 0;
    for (const int i : morton_order(points)) {
        const Vec3d& x = points[static_cast<std::size_t>(i)];
        const int octant =
            (x.x >= 0.5 ? 1 : 0) + (x.y >= 0.5 ? 2 : 0) + (x.z >= 0.5 ? 4 : 0);
        EXPECT_GE(octant, last);
        last = octant;
    }
    EXPECT_EQ(last, 7);
}

TEST(MortonCode, InterleavesTheBitsOfTheCell) {
    std::mt19937 rng(3);
    std::uniform_int_distribution<std::uint64_t> cell(0, (1u << 21) - 1);
    for (int trial = 0; trial < 200; ++trial) {
        const std::uint64_t c[3] = {cell(rng), cell(rng), cell(rng)};
        std::uint64_t expected = 0;
        for (int bit = 0; bit < 21; ++bit)
            for (int k = 0; k < 3; ++k)
                expected |= ((c[k] >> bit) & 1) << (3 * bit + k);
        EXPECT_EQ(morton_code({static_cast<double>(c[0]) + 0.5,
                               static_cast<double>(c[1]) + 0.5,
                               static_cast<double>(c[2]) + 0.5}),
                  expected);
    }
}

TEST(MortonCode, TakesTheNearestCellOutsideOfTheGridAndTheFirstForNaN) {
    EXPECT_EQ(morton_cell(-4.0), 0u);
    EXPECT_EQ(morton_cell(1e300), (1u << 21) - 1);
    EXPECT_EQ(morton_cell(std::nan("")), 0u);
}

}  // namespace
}  // namespace noli
