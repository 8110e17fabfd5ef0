// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Element loops in SIMD packs, with the width chosen at run time.
///
/// A lane kernel is a function object with `template <class T> void operator()(Lane<T>
/// lane)`. `T` is a pack of 8, 4 or 2 doubles, or double itself for the last elements and
/// on the GPU. `lane.first` is the index of its first element; lane j of a pack is
/// element first + j. The three widths are compiled into one binary (function attributes,
/// never per-file flags) and give bitwise equal results, because packs do the same
/// operations in the same order and fused multiply-add contraction is off.

#include "core/device.hpp"

namespace noli {

template <class T>
struct Lane {
    using Scalar = T;
    int first;
};

#if !defined(__CUDACC__)
}  // namespace noli
#include "core/pack.hpp"
namespace noli {

inline constexpr int kLaneBlock =
    64;  ///< elements per task; a multiple of every pack width

enum class LaneDispatch { Width2, Width4, Width8 };

/// The widest packs that this processor runs; NOLI_SIMD=2|4|8 in the environment asks for
/// less.
LaneDispatch lane_dispatch();

namespace detail {

template <int W, class F>
inline __attribute__((always_inline)) void run_packs(int begin, int end, const F& f) {
    int i = begin;
    for (; i + W <= end; i += W)
        f(Lane<Pack<W>>{i});
    for (; i < end; ++i)
        f(Lane<double>{i});
}

template <class F>
__attribute__((flatten)) void run_packs_2(int begin, int end, const F& f) {
    run_packs<2>(begin, end, f);
}
#if defined(__x86_64__)
template <class F>
__attribute__((target("avx2"), flatten)) void run_packs_4(int begin,
                                                          int end,
                                                          const F& f) {
    run_packs<4>(begin, end, f);
}
template <class F>
__attribute__((target("avx512f,avx512dq,avx512vl,prefer-vector-width=512"), flatten)) void
run_packs_8(int begin, int end, const F& f) {
    run_packs<8>(begin, end, f);
}
#endif

template <class F>
__attribute__((flatten)) void call_with_packs_2(const F& f) {
    f(Lane<Pack<2>>{0});
}
#if defined(__x86_64__)
template <class F>
__attribute__((target("avx2"), flatten)) void call_with_packs_4(const F& f) {
    f(Lane<Pack<4>>{0});
}
template <class F>
__attribute__((target("avx512f,avx512dq,avx512vl,prefer-vector-width=512"), flatten)) void
call_with_packs_8(const F& f) {
    f(Lane<Pack<8>>{0});
}
#endif

}  // namespace detail

template <class F>
void run_lane_block(LaneDispatch dispatch, int begin, int end, const F& f) {
#if defined(__x86_64__)
    if (dispatch == LaneDispatch::Width8) return detail::run_packs_8(begin, end, f);
    if (dispatch == LaneDispatch::Width4) return detail::run_packs_4(begin, end, f);
#endif
    detail::run_packs_2(begin, end, f);
}

/// f(Lane<Pack<W>>{0}) once: for kernels that go through several packs themselves.
template <class F>
void call_with_packs(LaneDispatch dispatch, const F& f) {
#if defined(__x86_64__)
    if (dispatch == LaneDispatch::Width8) return detail::call_with_packs_8(f);
    if (dispatch == LaneDispatch::Width4) return detail::call_with_packs_4(f);
#endif
    detail::call_with_packs_2(f);
}
#endif

}  // namespace noli
