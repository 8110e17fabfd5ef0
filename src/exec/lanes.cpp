// SPDX-License-Identifier: Apache-2.0
#include "exec/lanes.hpp"

#include <cstdlib>

namespace noli {

namespace {

LaneDispatch detect() {
    int limit = 8;
    if (const char* asked = std::getenv("NOLI_SIMD")) limit = std::atoi(asked);
#if defined(__x86_64__)
    if (limit >= 8 && __builtin_cpu_supports("avx512f")
        && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
        return LaneDispatch::Width8;
    if (limit >= 4 && __builtin_cpu_supports("avx2")) return LaneDispatch::Width4;
#endif
    return LaneDispatch::Width2;
}

}  // namespace

LaneDispatch lane_dispatch() {
    static const LaneDispatch dispatch = detect();
    return dispatch;
}

}  // namespace noli
