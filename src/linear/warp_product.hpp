// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The matrix-free product y += H c of dense Hessian blocks per contact pair by segmented
/// warp reduction: the supplement's data-parallel solver, kept for comparison with
/// linear/low_rank.hpp. linear/dense_pairs.hpp stores the blocks, linear/dense_terms.hpp
/// has the product as an operator of the solver.
///
/// One thread owns one scalar entry of one block. All blocks of a buffer have one size,
/// so entry number i, counted over the whole buffer, is
///
///     block i / m^2,   row (i mod m^2) / m,   column i mod m.
///
/// A warp is 32 consecutive entries, so rows (m = 6, 9, 12) begin and end anywhere in
/// it:
///
///     m = 9        row 0              row 1              row 2              row 3
///     entry        0                  9                  18                 27   31
///     boundary     #  .  ...  .       #  .  ...  .       #  .  ...  .       #  . . .
///     interval     8  7  ...  0       8  7  ...  0       8  7  ...  0       4  3 .. 0
///
/// The next warp begins inside row 3: its lane 0 is a boundary although no row begins
/// there, and adds the rest of the row with a second atomic.
///
/// Source: supplement section 6, Algorithm 1, corrected. What is wrong in print, as the
/// tests of this file show by running it:
///  1. R_id <- thread_id x H_dims / m names a row outside the block for every thread but
///     the first. Right: (thread_id mod H_dims) / m.
///  2. `thread_id` is two numbers. H_id, C_id and e_id need the index in the grid;
///     "if thread_id == 0", B_id and l_id the index in the thread block. With the grid
///     index throughout, only the first thread block sets its shared `offset` and all
///     others read it uninitialised (right only if that happens to be a multiple of m);
///     with the block index throughout, every thread block multiplies the same blocks.
///  3. addToOutputArray(r) gets no address, and the only vertex that is computed, v_id,
///     is the column's. The sum of a row belongs to vertex R_id / 3, component R_id % 3.
///  4. Nothing guards threads past the last entry. Without a guard they load past the
///     buffers; if they return early, the interval of the last row still counts their
///     lanes, and shuffles read from lanes that have left, which is undefined. Here they
///     stay and hold 0, so that it does no harm to count them.
///  5. mark << (w_id + 1) shifts by 32 in lane 31: undefined in C++, harmless after the
///     clamp. (w_id is the lane, not the "warp index".)
/// The printed interval, its clamp and the loop are right for full warps. `offset`,
/// B_id, l_id, the shared variable and the barrier are not needed at all: the first
/// thread of a thread block is lane 0 of a warp and so a boundary by the second half of
/// the test, and for all others l_id == 0 says no more than column == 0.
///
/// Rows that straddle two warps are added by atomics, so on a GPU the last bits depend on
/// the order of arrival; linear/low_rank.hpp has no such freedom.

#include "core/vec.hpp"
#include "core/view.hpp"
#include "exec/warp.hpp"

#include <bit>
#include <cstdint>

namespace noli {

/// Blocks of kSize x kSize numbers on kSize / kDim vertices each, in any memory.
template <int kSize, int kDim = 3>
struct DenseBlockView {
    static_assert(kSize > 0 && kSize <= kWarpLanes && kSize % kDim == 0);
    static constexpr int kPoints = kSize / kDim;

    View<const double> values;  ///< per block kSize^2 numbers, row-major, N/m
    View<const int> vertices;   ///< per block kSize / kDim vertices

    [[nodiscard]] NOLI_HD int num_blocks() const { return vertices.size / kPoints; }
    [[nodiscard]] NOLI_HD std::uint32_t num_entries() const {
        return static_cast<std::uint32_t>(values.size);
    }
    /// Where component `i` of a block's local vector lies in a global one.
    [[nodiscard]] NOLI_HD int global_index(int block, int i) const {
        return kDim * vertices[kPoints * block + i / kDim] + i % kDim;
    }
};

/// The same numbers one by one, as the warp product reads them.
NOLI_HD inline View<const double> components(View<const Vec3d> v) {
    static_assert(sizeof(Vec3d) == 3 * sizeof(double));
    return {reinterpret_cast<const double*>(v.data), 3 * v.size};
}
NOLI_HD inline View<double> components(View<Vec3d> v) {
    return {reinterpret_cast<double*>(v.data), 3 * v.size};
}

/// The entries [begin, end) of a buffer; either end may lie inside a row.
struct EntryRange {
    std::uint32_t begin;
    std::uint32_t end;
};

/// What one thread works on.
struct WarpEntry {
    int block;
    int row;
    int col;
    bool valid;     ///< false past the end of the range: takes part, adds nothing
    bool boundary;  ///< first lane of a run of entries of one row
};

/// The work of the thread in `lane` of its warp with entry number `index`.
template <int kSize>
NOLI_HD inline WarpEntry warp_entry(std::uint32_t index, std::uint32_t end, int lane) {
    const auto within = static_cast<int>(index % (kSize * kSize));
    const int col = within % kSize;
    return {.block = static_cast<int>(index / (kSize * kSize)),
            .row = within / kSize,
            .col = col,
            .valid = index < end,
            .boundary = lane == 0 || col == 0};
}

/// H(row, col) c(col) of one entry; 0 past the end, where nothing may be read.
template <int kSize, int kDim>
NOLI_HD inline double entry_product(const WarpEntry& e,
                                    const DenseBlockView<kSize, kDim>& blocks,
                                    View<const double> c) {
    if (!e.valid) return 0.0;
    const int at = (e.block * kSize + e.row) * kSize + e.col;
    return blocks.values[at] * c[blocks.global_index(e.block, e.col)];
}

NOLI_HD inline std::uint32_t reverse_bits(std::uint32_t bits) {
#if defined(__CUDA_ARCH__)
    return __brev(bits);
#else
    std::uint32_t out = 0;
    for (int i = 0; i < 32; ++i)
        out |= ((bits >> i) & 1U) << (31 - i);
    return out;
#endif
}

/// 32 for 0.
NOLI_HD inline int leading_zeros(std::uint32_t bits) {
#if defined(__CUDA_ARCH__)
    return __clz(static_cast<int>(bits));
#else
    return std::countl_zero(bits);
#endif
}

/// Number of lanes after `lane` that belong to the same run; bit l of `boundaries` is set
/// where lane l is a boundary.
NOLI_HD inline int reduction_interval(std::uint32_t boundaries, int lane) {
    const int behind = kWarpLanes - 1 - lane;
    if (behind == 0) return 0;  // a shift by 32 is undefined
    const int run = leading_zeros(reverse_bits(boundaries) << (lane + 1));
    return run < behind ? run : behind;  // no boundary behind this lane: run is 32
}

/// One warp's part of y += H c: entries first, ..., first + 31, none at or past `end`.
///
/// The text of all 32 lanes at once, see exec/warp.hpp. In shuffle_down every lane sees
/// its neighbours' values from before the addition. The loop doubles the reach of every
/// sum: after the steps 1, 2, .., s a lane holds the sum of the next min(2 s, interval +
/// 1) entries.
template <int kSize, int kDim, class Warp>
NOLI_HD inline void warp_multiply_add(Warp warp,
                                      std::uint32_t first,
                                      std::uint32_t end,
                                      const DenseBlockView<kSize, kDim>& blocks,
                                      View<const double> c,
                                      View<double> y) {
    const auto entry = warp.each([&](int lane) {
        return warp_entry<kSize>(first + static_cast<std::uint32_t>(lane), end, lane);
    });
    const std::uint32_t boundaries =
        warp.ballot([&](int lane) { return warp.at(entry, lane).boundary; });
    const auto interval =
        warp.each([&](int lane) { return reduction_interval(boundaries, lane); });
    auto sum = warp.each(
        [&](int lane) { return entry_product(warp.at(entry, lane), blocks, c); });
    for (int step = 1; step < kSize; step *= 2) {
        const auto behind = warp.shuffle_down(sum, step);
        sum = warp.each([&](int lane) {
            const double own = warp.at(sum, lane);
            return warp.at(interval, lane) >= step ? own + warp.at(behind, lane) : own;
        });
    }
    warp.run([&](int lane) {
        const WarpEntry& e = warp.at(entry, lane);
        if (e.boundary && e.valid)
            warp.add(y[blocks.global_index(e.block, e.row)], warp.at(sum, lane));
    });
}

/// y += H c over the entries of `range`, as a grid of whole thread blocks would compute
/// it. threads_per_block must be a multiple of 32. Returns the number of additions to y
/// (atomics on a GPU).
template <int kSize, int kDim>
int simulate_warp_product(const DenseBlockView<kSize, kDim>& blocks,
                          EntryRange range,
                          int threads_per_block,
                          View<const double> c,
                          View<double> y) {
    NOLI_DCHECK(threads_per_block > 0 && threads_per_block % kWarpLanes == 0);
    NOLI_DCHECK(range.begin <= range.end && range.end <= blocks.num_entries());
    int num_writes = 0;
    const auto threads = static_cast<std::uint32_t>(threads_per_block);
    const std::uint32_t num_thread_blocks =
        (range.end - range.begin + threads - 1) / threads;
    for (std::uint32_t b = 0; b < num_thread_blocks; ++b)
        for (std::uint32_t thread = 0; thread < threads; thread += kWarpLanes)
            warp_multiply_add(SimulatedWarp{.num_writes = &num_writes},
                              range.begin + b * threads + thread,
                              range.end,
                              blocks,
                              c,
                              y);
    return num_writes;
}

}  // namespace noli
