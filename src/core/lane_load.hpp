// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Between arrays of doubles and lanes: gathers and scatters of one pack.

#include "core/vec.hpp"

#include <type_traits>

namespace noli {

/// Doubles in one T: 1 for double, W for a pack.
template <class T>
inline constexpr int kLaneWidth = static_cast<int>(sizeof(T) / sizeof(double));

/// {f(0), ..., f(W-1)} as one T.
template <class T, class F>
NOLI_HD inline T load_lanes(const F& f) {
    if constexpr (std::is_same_v<T, double>) {
        return f(0);
    } else {
        T out;
        for (int j = 0; j < kLaneWidth<T>; ++j)
            out.set(j, f(j));
        return out;
    }
}

/// Lane j of a T.
template <class T>
NOLI_HD inline double lane_of(const T& values, int j) {
    if constexpr (std::is_same_v<T, double>) {
        (void)j;
        return values;
    } else {
        return values[j];
    }
}

template <class T, class F>
NOLI_HD inline Vec3<T> load_vec3_lanes(const F& f) {
    return {load_lanes<T>([&](int j) { return f(j).x; }),
            load_lanes<T>([&](int j) { return f(j).y; }),
            load_lanes<T>([&](int j) { return f(j).z; })};
}

}  // namespace noli
