// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Morton codes: points along a curve that keeps neighbours near.

#include "core/vec.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace noli {

/// Spreads the low 21 bits of v to every third bit.
NOLI_HD inline std::uint64_t spread_bits(std::uint64_t v) {
    v = (v | (v << 32)) & 0x001F00000000FFFFULL;
    v = (v | (v << 16)) & 0x001F0000FF0000FFULL;
    v = (v | (v << 8)) & 0x100F00F00F00F00FULL;
    v = (v | (v << 4)) & 0x10C30C30C30C30C3ULL;
    return (v | (v << 2)) & 0x1249249249249249ULL;
}

inline constexpr double kMortonCells = 2097152.0;  ///< per axis, 2^21

/// Number of a cell on one axis; outside of the grid the nearest cell, 0 for NaN.
NOLI_HD inline std::uint64_t morton_cell(double c) {
    return static_cast<std::uint64_t>(std::fmin(std::fmax(c, 0.0), kMortonCells - 1.0));
}

/// 63-bit Morton code of a point with coordinates in [0, kMortonCells).
NOLI_HD inline std::uint64_t morton_code(const Vec3d& cell) {
    return spread_bits(morton_cell(cell.x)) | (spread_bits(morton_cell(cell.y)) << 1)
         | (spread_bits(morton_cell(cell.z)) << 2);
}

/// Cube that points lie in, cut into kMortonCells^3 cells.
struct MortonGrid {
    Vec3d origin;
    double cells_per_metre;

    [[nodiscard]] NOLI_HD std::uint64_t code(const Vec3d& x) const {
        return morton_code(cells_per_metre * (x - origin));
    }
};

/// The points' numbers along the curve; equal codes keep their order.
inline std::vector<int> morton_order(std::span<const Vec3d> points) {
    std::vector<int> order(points.size());
    if (points.empty()) return order;
    Vec3d low = points[0];
    Vec3d high = points[0];
    for (const Vec3d& x : points)
        for (int k = 0; k < 3; ++k) {
            low[k] = std::fmin(low[k], x[k]);
            high[k] = std::fmax(high[k], x[k]);
        }
    const Vec3d size = high - low;
    const double extent = std::fmax(size.x, std::fmax(size.y, size.z));
    const MortonGrid grid{low, extent > 0.0 ? kMortonCells / extent : 0.0};
    std::vector<std::uint64_t> code(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
        code[i] = grid.code(points[i]);
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&code](int a, int b) {
        return code[static_cast<std::size_t>(a)] < code[static_cast<std::size_t>(b)];
    });
    return order;
}

}  // namespace noli
