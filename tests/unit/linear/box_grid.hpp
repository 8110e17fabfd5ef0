// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Boxes of tetrahedra on a grid, for the tests of aggregates and coarse spaces.

#include "core/vec.hpp"

#include <vector>

namespace noli::test {

struct TetGrid {
    std::vector<Vec3d> x;
    std::vector<Int4> tets;
};

/// Appends a box of `cells` cubes of side `h`, each cut into six tetrahedra.
inline void add_box(TetGrid& grid, const Int3& cells, const Vec3d& corner, double h) {
    const int first = static_cast<int>(grid.x.size());
    const auto vertex = [&](int i, int j, int k) {
        return first + i + (cells[0] + 1) * (j + (cells[1] + 1) * k);
    };
    for (int k = 0; k <= cells[2]; ++k)
        for (int j = 0; j <= cells[1]; ++j)
            for (int i = 0; i <= cells[0]; ++i)
                grid.x.push_back(corner + Vec3d{h * i, h * j, h * k});
    constexpr int kAxes[6][3] = {
        {0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    for (int k = 0; k < cells[2]; ++k)
        for (int j = 0; j < cells[1]; ++j)
            for (int i = 0; i < cells[0]; ++i)
                for (const auto& axes : kAxes) {
                    // From corner to corner along the axes, one after the other.
                    int at[3] = {i, j, k};
                    Int4 tet{};
                    tet[0] = vertex(at[0], at[1], at[2]);
                    for (int step = 0; step < 3; ++step) {
                        ++at[axes[step]];
                        tet[step + 1] = vertex(at[0], at[1], at[2]);
                    }
                    grid.tets.push_back(tet);
                }
}

}  // namespace noli::test
