// SPDX-License-Identifier: Apache-2.0
#pragma once
/// One row of a block-sparse product, the innermost loop of every linear solve.
///
/// The nine numbers of a row-major block meet the pattern (x y z x y z x y z) in nine
/// running sums, and only the end of the row adds them in threes. So a block costs one
/// 8-wide product and a scalar one with AVX-512, two 4-wide with AVX2, and the order of
/// the additions, and with it every bit of the result, is the same for all widths.

#include "core/vec.hpp"
#include "core/view.hpp"
#include "exec/lanes.hpp"

namespace noli::detail {

/// Sum over blocks k in [begin, end) of values[k] x[col[k]], plain loops.
NOLI_HD inline Vec3d block_row_product(View<const Mat3d> values,
                                       View<const int> col,
                                       View<const Vec3d> x,
                                       int begin,
                                       int end) {
    double acc[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
    for (int k = begin; k < end; ++k) {
        const double* a = values[k].a;
        const Vec3d& v = x[col[k]];
        for (int r = 0; r < 9; r += 3) {
            acc[r] += a[r] * v.x;
            acc[r + 1] += a[r + 1] * v.y;
            acc[r + 2] += a[r + 2] * v.z;
        }
    }
    return {acc[0] + acc[1] + acc[2], acc[3] + acc[4] + acc[5], acc[6] + acc[7] + acc[8]};
}

#if defined(__x86_64__) && !defined(__CUDACC__)

/// Matrices of more blocks are asked for ahead: they come from the last-level cache or
/// from memory, and what fetches them by itself stops at the end of each page of 4096
/// bytes, so this looks farther. In the cache of a core it only costs.
inline constexpr int kStreamedBlocks = 100000;
inline constexpr int kBlocksAhead = 64;

template <bool kStreamed>
__attribute__((always_inline)) inline void fetch_ahead(const Mat3d* block) {
    if constexpr (kStreamed) __builtin_prefetch(block + kBlocksAhead);
}

typedef double Double4 __attribute__((vector_size(32), aligned(8), may_alias));
typedef double Double8 __attribute__((vector_size(64), aligned(8), may_alias));

/// block_row_product in AVX2 registers: call only from code compiled for AVX2.
template <bool kStreamed>
__attribute__((always_inline)) inline Vec3d block_row_product_4(const Mat3d* values,
                                                                const int* col,
                                                                const Vec3d* x,
                                                                int count) {
    Double4 acc0{};
    Double4 acc1{};
    double acc2 = 0.0;
    for (int k = 0; k < count; ++k) {
        const double* a = values[k].a;
        const Vec3d v = x[col[k]];
        fetch_ahead<kStreamed>(values + k);
        acc0 += *reinterpret_cast<const Double4*>(a) * Double4{v.x, v.y, v.z, v.x};
        acc1 += *reinterpret_cast<const Double4*>(a + 4) * Double4{v.y, v.z, v.x, v.y};
        acc2 += a[8] * v.z;
    }
    return {acc0[0] + acc0[1] + acc0[2],
            acc0[3] + acc1[0] + acc1[1],
            acc1[2] + acc1[3] + acc2};
}

/// block_row_product in AVX-512 registers: call only from code compiled for AVX-512.
template <bool kStreamed>
__attribute__((always_inline)) inline Vec3d block_row_product_8(const Mat3d* values,
                                                                const int* col,
                                                                const Vec3d* x,
                                                                int count) {
    Double8 acc{};
    double acc8 = 0.0;
    for (int k = 0; k < count; ++k) {
        const double* a = values[k].a;
        const Vec3d v = x[col[k]];
        fetch_ahead<kStreamed>(values + k);
        const Double8 pattern{v.x, v.y, v.z, v.x, v.y, v.z, v.x, v.y};
        acc += *reinterpret_cast<const Double8*>(a) * pattern;
        acc8 += a[8] * v.z;
    }
    return {acc[0] + acc[1] + acc[2], acc[3] + acc[4] + acc[5], acc[6] + acc[7] + acc8};
}

#endif

/// Lane kernel y[i] = sum_k A_ik x_k: the executor's choice of pack width only selects
/// the instruction set here; rows are computed one after the other.
struct BlockProductKernel {
    View<const int> row_begin, col;
    View<const Mat3d> values;
    View<const Vec3d> x;
    View<Vec3d> y;

    NOLI_HD void operator()(Lane<double> lane) const {
        const int i = lane.first;
        y[i] = block_row_product(values, col, x, row_begin[i], row_begin[i + 1]);
    }
#if !defined(__CUDACC__)
    template <int W>
    void operator()(Lane<Pack<W>> lane) const {
        const bool streamed = values.size > kStreamedBlocks;
        for (int i = lane.first; i < lane.first + W; ++i)
            y[i] = streamed ? row<W, true>(i) : row<W, false>(i);
    }

    template <int W, bool kStreamed>
    [[nodiscard]] __attribute__((always_inline)) Vec3d row(int i) const {
        const int begin = row_begin[i];
        const int end = row_begin[i + 1];
#if defined(__x86_64__)
        const Mat3d* block = values.data + begin;
        const int* at = col.data + begin;
        if constexpr (W == 8)
            return block_row_product_8<kStreamed>(block, at, x.data, end - begin);
        if constexpr (W == 4)
            return block_row_product_4<kStreamed>(block, at, x.data, end - begin);
#endif
        return block_row_product(values, col, x, begin, end);
    }
#endif
};

}  // namespace noli::detail
