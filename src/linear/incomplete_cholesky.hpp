// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Block incomplete Cholesky factor without fill, M D Mᵀ with unit lower triangular M, of the block
/// matrix plus the low-rank terms, contact couplings included. CPU only.
///
/// Contact stiffness is a local difficulty that block Jacobi does not see and this factor does:
/// 3 to 10 times fewer iterations on real scenes.
///
/// * Order. Unknowns are cut into blocks of consecutive ones, blocks are coloured so that coupled
///   blocks differ, and rows are sorted by colour. Rows of one block are swept in order, blocks of one colour
///   in parallel: nearly the convergence of the natural order, with as few barriers as colours.
///   Nothing depends on the number of threads.
/// * Shift. The matrix is no M-matrix, so pivots may fail. Then all diagonal blocks are scaled by
///   1 + shift and the factorisation starts again. Repairing only the failed pivots
///   lets the other entries of their rows explode.
/// * Precision. Factorised in double; M stored in float; D in double, because a contact's pivot
///   block spans more magnitudes than a float inverse can hold. The sweeps run in float.
///
/// Source: block multicolour ordering after [Iwashita2012]; measured on the project's systems.

#include "linear/assemble.hpp"
#include "linear/block_jacobi.hpp"

#include <atomic>
#include <cstdint>
#include <utility>
#include <vector>

namespace noli {

/// What the factorisation remembers from one solve to the next. Part of a checkpoint if a resumed
/// run must repeat the same bits; value-initialise it to forget.
struct ShiftMemory {
    double shift = 0.0;  ///< that made the last factorisation succeed; 0: none yet
    int successes = 0;   ///< factorisations in a row that needed no larger shift
};

/// Rows in colour order and the blocks of rows that run in parallel.
struct ColouredRows {
    Numbering numbering;
    std::vector<int> block_begin;   ///< num_blocks + 1: first row of each block
    std::vector<int> colour_begin;  ///< num_colours + 1: first block of each colour
};

/// Cuts the free vertices into blocks of `rows_per_block` and colours them greedily.
ColouredRows colour_rows(const OperatorView& op,
                         View<const int> touched_index,
                         View<const std::uint8_t> fixed,
                         int rows_per_block);

class IncompleteCholesky {
  public:
    /// Factorises. Returns false when no shift up to 1e3 helps or a number is not finite; the
    /// preconditioner is not usable then.
    ///
    /// In:   fixed  (num_rows): non-zero where the unknown is held at 0
    template <class Exec>
    bool build(Exec& exec,
               const BlockMatrix<Exec>& matrix,
               const LowRankTerms<Exec>& terms,
               View<const std::uint8_t> fixed) {
        static_assert(!Exec::kIsDevice, "the incomplete factorisation runs on the CPU");
        OperatorCopy copy;
        const OperatorView op = view_operator(exec, matrix, terms, copy);
        const auto loop = [&exec](int n, const auto& f) {
            exec.for_each("linear/ic_rows", n, [&f](int i) { f(i); });
        };
        const std::vector<int> touched = detail::touched_of_vertex(op);
        if (pattern_changed(op, fixed)) {
            rows_ = colour_rows(op, detail::const_view(touched), fixed, kRowsPerBlock);
            merge_pattern(loop, op, detail::const_view(touched), rows_.numbering, merged_);
            transpose_pattern();
        }
        merge_values(loop, op, detail::const_view(touched), rows_.numbering, merged_);
        if (!find_factor(exec)) return false;
        loop(num_rows(), [this](int i) { transpose_row(i); });
        return true;
    }

    /// z = (M D Mᵀ)⁻¹ r, 0 at fixed vertices; returns r.z.
    template <class Exec>
    double apply(Exec& exec, View<const Vec3d> r, View<Vec3d> z) {
        const int num_colours = static_cast<int>(rows_.colour_begin.size()) - 1;
        for (int c = 0; c < num_colours; ++c)
            for_blocks(exec, c, [this, r](int b) { return forward_block(b, r), true; });
        for (int c = num_colours - 1; c >= 0; --c)
            for_blocks(exec, c, [this](int b) { return backward_block(b), true; });
        return exec.sum("linear/ic_result", z.size, [this, r, z](int v) {
            z[v] = result(v);
            return dot(r[v], z[v]);
        });
    }

    ShiftMemory& memory() { return memory_; }
    [[nodiscard]] int num_rows() const { return static_cast<int>(rows_.numbering.vertex.size()); }
    [[nodiscard]] int num_colours() const {
        return static_cast<int>(rows_.colour_begin.size()) - 1;
    }

  private:
    static inline int kRowsPerBlock = getenv("RPB")?atoi(getenv("RPB")):64;
    static inline double kFirstShift = getenv("FS")?atof(getenv("FS")):1e-2;
    static constexpr double kLargestShift = 1e3;
    static constexpr int kSuccessesBeforeSmaller = 8;

    /// f(block) for all blocks of a colour; true when all of them return true.
    template <class Exec, class F>
    bool for_blocks(Exec& exec, int colour, const F& f) {
        const auto c = static_cast<std::size_t>(colour);
        const int first = rows_.colour_begin[c];
        std::atomic<bool> ok = true;
        constexpr int kBlocksPerTask = 4;
        exec.for_each(
            "linear/ic_blocks",
            rows_.colour_begin[c + 1] - first,
            [&](int b) {
                if (!f(first + b)) ok = false;
            },
            kBlocksPerTask);
        return ok;
    }

    template <class Exec>
    bool try_factor(Exec& exec, double shift) {
        for (int c = 0; c < num_colours(); ++c)
            if (!for_blocks(exec, c, [this, shift](int b) { return factor_block(b, shift); }))
                return false;
        return true;
    }

    template <class Exec>
    bool find_factor(Exec& exec) {
        double shift = memory_.shift > 0.0 ? memory_.shift : kFirstShift;
        if (memory_.successes >= kSuccessesBeforeSmaller) shift *= 0.5;
        memory_.successes = memory_.successes >= kSuccessesBeforeSmaller ? 0 : memory_.successes + 1;
        while (!try_factor(exec, shift)) {
            memory_.successes = 0;
            shift *= 2.0;
            if (shift > kLargestShift) {
                memory_.shift = 0.0;
                return false;
            }
        }
        memory_.shift = shift;
        return true;
    }

    bool pattern_changed(const OperatorView& op, View<const std::uint8_t> fixed);
    void transpose_pattern();
    bool factor_block(int block, double shift);
    void transpose_row(int row);
    void forward_block(int block, View<const Vec3d> r);
    void backward_block(int block);
    [[nodiscard]] Vec3d result(int vertex) const;

    ColouredRows rows_;
    MergedBlocks merged_;  ///< the operator in row order; off-diagonal entry p of row i is p - i
    std::vector<float> lower_;  ///< M, column-major 3x3 blocks in the order of merged_
    std::vector<SymMat3d> pivot_inverse_;          ///< D⁻¹
    std::vector<int> upper_begin_, upper_row_;     ///< columns of M, below the diagonal
    std::vector<int> upper_source_;                ///< off-diagonal entry of each
    std::vector<float> upper_;                     ///< Mᵀ, column-major 3x3 blocks
    std::vector<float> y_;                         ///< 4 per row: the fourth is never used
    ShiftMemory memory_;

    // The pattern that rows_ and merged_ were built for.
    std::vector<int> seen_row_begin_, seen_col_;
    std::vector<Int4> seen_terms_;
    std::vector<std::uint8_t> seen_fixed_;
};

}  // namespace noli
