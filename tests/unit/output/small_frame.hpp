// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "output/frame.hpp"

#include <string>
#include <vector>

namespace noli {

/// A tetrahedron, an obstacle triangle, an obstacle segment and an obstacle point: one of
/// each.
struct SmallFrame {
    std::vector<std::array<int, 4>> tets{{0, 1, 2, 3}};
    // The tetrahedron's surface (vertex 4 is inside of it, unused) and the obstacle.
    std::vector<std::array<int, 3>> triangles{
        {5, 6, 7}, {0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    std::vector<std::array<int, 2>> segments{{8, 9}};
    std::vector<int> body{0, 0, 0, 0, 0, 1, 1, 1, 2, 2, 3};
    std::vector<std::string> names{"jelly", "my floor", "rod", "pin"};
    std::vector<Vector3> initial, positions, velocities, force;
    std::vector<double> von_mises{1.0 / 3.0};
    std::vector<std::array<double, 9>> stress{{1, 2, 3, 2, 4, 5, 3, 5, 6}};

    SmallFrame() {
        for (int i = 0; i < 11; ++i) {
            const double s = i / 7.0;
            initial.push_back({s, s * s, 1.0 - s});
            positions.push_back({s + 0.1, s * s - 1e-9, 1.0 - s / 3.0});
            velocities.push_back({-s, 1e-300 * s, 1e300});
            force.push_back({s, 0.0, -0.0});
        }
    }
    [[nodiscard]] FrameMesh mesh() const {
        return {tets, triangles, segments, body, names, initial};
    }
    [[nodiscard]] Frame frame() const {
        Frame f;
        f.step = 12;
        f.time = 0.1 * 12;
        f.positions = positions;
        f.velocities = velocities;
        f.contact_force = force;
        f.von_mises = von_mises;
        f.stress = stress;
        return f;
    }
};

}  // namespace noli
