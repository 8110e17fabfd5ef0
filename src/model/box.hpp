// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Bounding box of places that are added one by one.

#include "core/vec.hpp"

#include <algorithm>
#include <cmath>

namespace noli {

struct Box {
    Vec3d lo{HUGE_VAL, HUGE_VAL, HUGE_VAL}, hi{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};  ///< m

    void add(const Vec3d& p) {
        for (int k = 0; k < 3; ++k) {
            lo[k] = std::min(lo[k], p[k]);
            hi[k] = std::max(hi[k], p[k]);
        }
    }
    [[nodiscard]] bool is_empty() const { return !(lo.x <= hi.x); }
    [[nodiscard]] double diagonal() const { return norm(hi - lo); }
    [[nodiscard]] Vec3d center() const { return 0.5 * (lo + hi); }
};

}  // namespace noli
