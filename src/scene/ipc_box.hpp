// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Bounding boxes of what an IPC script places.

#include "noli/scene.hpp"

#include "core/vec.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace noli {

/// Smallest axis-aligned box around what was added.
struct ScriptBox {
    static constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Vector3 lo{kInfinity, kInfinity, kInfinity};
    Vector3 hi{-kInfinity, -kInfinity, -kInfinity};

    void add(const Vec3d& p) {
        for (int k = 0; k < 3; ++k) {
            const auto i = static_cast<std::size_t>(k);
            lo[i] = std::min(lo[i], p[k]);
            hi[i] = std::max(hi[i], p[k]);
        }
    }
    void add(const Vector3& low, const Vector3& high) {
        add({low[0], low[1], low[2]});
        add({high[0], high[1], high[2]});
    }
    [[nodiscard]] Vector3 extent() const {
        return {hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]};
    }
    [[nodiscard]] double diagonal() const {
        const Vector3 e = extent();
        return std::sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]);
    }
    [[nodiscard]] double largest_extent() const {
        const Vector3 e = extent();
        return std::max({e[0], e[1], e[2]});
    }
};

/// The box of the copies of a box on a grid.
inline void add_copies(ScriptBox& box,
                       const ScriptBox& one,
                       const std::array<int, 3>& grid,
                       const Vector3& spacing) {
    Vector3 lo = one.lo;
    Vector3 hi = one.hi;
    for (std::size_t k = 0; k < 3; ++k) {
        const double reach = (grid[k] - 1) * spacing[k];
        lo[k] += std::min(0.0, reach);
        hi[k] += std::max(0.0, reach);
    }
    box.add(lo, hi);
}

}  // namespace noli
