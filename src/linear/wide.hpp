// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Four doubles at a time, for loops that are compiled once for AVX2 and once without
/// (exec/avx2.hpp).

#include "exec/avx2.hpp"
#include "linear/inverse_factor.hpp"

namespace noli::detail {

typedef double Wide __attribute__((vector_size(32), aligned(8), may_alias));

inline __attribute__((always_inline)) Wide& wide(double* v) {
    return *reinterpret_cast<Wide*>(v);
}
inline __attribute__((always_inline)) const Wide& wide(const double* v) {
    return *reinterpret_cast<const Wide*>(v);
}

/// Four numbers of either precision.
inline __attribute__((always_inline)) Wide load_wide(const double* v) {
    return wide(v);
}
inline __attribute__((always_inline)) Wide load_wide(const float* v) {
    // Spelled out, because this becomes one instruction and a conversion of a vector of
    // floats three.
    return Wide{static_cast<double>(v[0]),
                static_cast<double>(v[1]),
                static_cast<double>(v[2]),
                static_cast<double>(v[3])};
}

/// v with 0 in lane 3.
inline __attribute__((always_inline)) Wide three_lanes(const Wide& v) {
    typedef long long Bits __attribute__((vector_size(32), aligned(8), may_alias));
    return reinterpret_cast<Wide>(reinterpret_cast<Bits>(v) & Bits{-1, -1, -1, 0});
}

/// Lanes added in a fixed order; lane 3 is 0.
inline __attribute__((always_inline)) double add_lanes(const Wide& v) {
    return v[0] + v[1] + v[2];
}

/// C⁻¹ v, lane 3 is 0
inline __attribute__((always_inline)) Wide apply_factor(const InverseFactor& f,
                                                        const Vec3d& v) {
    return v.x * wide(f.c0) + v.y * wide(f.c1) + v.z * wide(f.c2);
}

}  // namespace noli::detail
