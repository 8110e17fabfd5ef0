// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Functions of the host that are compiled twice, for AVX2 and for any x86-64, with equal
/// results; which one runs is decided at run time.

#include "exec/lanes.hpp"

#if !defined(__CUDACC__)
namespace noli::detail {

#if defined(__x86_64__)
template <class F>
__attribute__((target("avx2"), flatten)) auto call_with_avx2(const F& f) {
    return f();
}
#endif

/// f(), compiled for AVX2 with all that it calls where the machine has it. The bits are
/// the same without.
template <class F>
auto with_avx2(const F& f) {
#if defined(__x86_64__)
    if (lane_dispatch() != LaneDispatch::Width2) return call_with_avx2(f);
#endif
    return f();
}

}  // namespace noli::detail
#endif
