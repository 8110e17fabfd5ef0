// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The whole operator in an order that a triangular sweep can run through in parallel
/// (row_colours.hpp): a sweep visits the colours one after the other, and the groups of a
/// colour in parallel. CPU only.
///
/// Loops of the set-up, which read and write what belongs to the neighbours of a row,
/// visit the rows in the order that they were cut in.

#include "linear/assemble.hpp"
#include "linear/row_colours.hpp"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <vector>

namespace noli {

/// Pattern of block matrix + low-rank terms in colour order, by rows of the lower
/// triangle and by rows of the upper one. Kept as long as the pattern stands.
class ColouredOperator {
  public:
    explicit ColouredOperator(const RowCut& cut) : cut_(cut) {}

    /// The order of the vertices that blocks are cut from. Neighbours should be near:
    /// then few blocks are coupled, and few colours do.
    void set_order(std::span<const int> order) {
        order_.assign(order.begin(), order.end());
        seen_row_begin_.clear();
    }

    /// Brings the pattern up to date. Returns false when it was.
    template <class Exec>
    bool update_pattern(Exec& exec,
                        const OperatorView& op,
                        View<const std::uint8_t> fixed) {
        static_assert(!Exec::kIsDevice, "sweeps run on the CPU");
        const bool new_matrix = matrix_changed(op, fixed);
        if (new_matrix) blocks_ = cut_rows(op, fixed, order_, cut_);
        if (!terms_changed(op) && !new_matrix) return false;
        touched_ = detail::touched_of_vertex(op);
        rows_ = colour_rows(op, blocks_);
        merge_pattern(loop_on(exec),
                      op,
                      detail::const_view(touched_),
                      rows_.numbering,
                      merging_,
                      lower_);
        transpose(exec);
        return true;
    }

    /// Sets lower().value to the blocks of the operator.
    template <class Exec>
    void update_values(Exec& exec, const OperatorView& op) {
        merge_values(
            loop_on(exec), op, detail::const_view(touched_), rows_.numbering, lower_);
    }

    /// f(group) for all groups of a colour, in parallel; true when all of them return
    /// true.
    template <class Exec, class F>
    bool for_groups(Exec& exec, int colour, const F& f) const {
        const auto c = static_cast<std::size_t>(colour);
        const int first = rows_.colour_begin[c];
        std::atomic<bool> ok = true;
        constexpr int kGroupsPerTask = 1;
        exec.for_each(
            "linear/coloured_groups",
            rows_.colour_begin[c + 1] - first,
            [&](int g) {
                if (!f(first + g)) ok.store(false, std::memory_order_relaxed);
            },
            kGroupsPerTask);
        return ok;
    }

    /// First group of each colour, and the end. A sweep that goes through the rows of a
    /// group backwards goes through the groups of a thread backwards too: so it meets
    /// memory without jumps.
    [[nodiscard]] View<const int> groups_of_colours() const {
        return detail::const_view(rows_.colour_begin);
    }

    /// f(row) for all rows, in parallel.
    template <class Exec, class F>
    void for_rows(Exec& exec, const F& f) const {
        exec.for_each("linear/coloured_rows", num_rows(), [&f](int i) { f(i); });
    }

    /// The same for an f that reads or writes at the neighbours of its row. f(row,
    /// ahead): `ahead` is a row that is visited soon.
    template <class Exec, class F>
    void for_rows_nearby(Exec& exec, const F& f) const {
        constexpr int kRowsAhead = 3;
        const int last = num_rows() - 1;
        const int* row = rows_.nearby.data();
        exec.for_each("linear/nearby_rows", num_rows(), [&f, row, last](int k) {
            f(row[k], row[std::min(k + kRowsAhead, last)]);
        });
    }

    [[nodiscard]] int num_rows() const {
        return static_cast<int>(rows_.numbering.vertex.size());
    }
    [[nodiscard]] int num_groups() const {
        return static_cast<int>(rows_.group_begin.size()) - 1;
    }
    [[nodiscard]] int num_colours() const {
        return static_cast<int>(rows_.colour_begin.size()) - 1;
    }
    /// Off-diagonal blocks of one triangle.
    [[nodiscard]] std::size_t num_off_diagonal() const { return upper_col.size(); }
    [[nodiscard]] const ColouredRows& rows() const { return rows_; }
    [[nodiscard]] const Numbering& numbering() const { return rows_.numbering; }

    /// Lower triangle. Off-diagonal entry p of row i has number p - i: each row before it
    /// has one diagonal block.
    [[nodiscard]] const MergedBlocks& lower() const { return lower_; }
    [[nodiscard]] View<const int> touched() const { return detail::const_view(touched_); }

    [[nodiscard]] int first_upper(int row) const {
        return upper_begin[static_cast<std::size_t>(num_rows() - 1 - row)];
    }
    [[nodiscard]] int end_upper(int row) const { return first_upper(row - 1); }

    /// Upper triangle by rows, no diagonal, the last row first: a backward sweep reads
    /// its blocks in the order of memory.
    std::vector<int>
        upper_begin;             ///< num_rows + 1, of row num_rows - 1, num_rows - 2 ...
    std::vector<int> upper_col;  ///< ascending in each row
    std::vector<int> upper_place;  ///< number of a lower entry -> place of its transpose

  private:
    template <class Exec>
    auto loop_on(Exec& exec) const {
        return [this, &exec](int, const auto& f) {
            for_rows_nearby(exec, [&f](int row, int) { f(row); });
        };
    }

    bool matrix_changed(const OperatorView& op, View<const std::uint8_t> fixed);
    bool terms_changed(const OperatorView& op);

    /// The upper triangle from the lower one, parts of it in parallel.
    template <class Exec>
    void transpose(Exec& exec) {
        const auto for_parts = [&exec](const auto& f) {
            exec.for_each("linear/transpose", kParts, f, 1);
        };
        upper_col.resize(lower_.col.size() - static_cast<std::size_t>(num_rows()));
        upper_place.resize(upper_col.size());
        upper_begin.resize(static_cast<std::size_t>(num_rows()) + 1);
        place_.resize(kParts * static_cast<std::size_t>(num_rows()));
        for_parts([this](int part) { count_columns(part); });
        upper_begin[0] = 0;
        for_parts([this](int part) { sum_counts(part); });
        std::partial_sum(upper_begin.begin(), upper_begin.end(), upper_begin.begin());
        for_parts([this](int part) { find_places(part); });
        for_parts([this](int part) { fill_upper(part); });
    }
    static constexpr int kParts = 8;
    [[nodiscard]] int first_row(int part) const {
        return static_cast<int>(static_cast<std::int64_t>(num_rows()) * part / kParts);
    }
    /// Place of the first entry that a part of the rows has in an upper row.
    int& place_of(int part, int upper_row) {
        const auto n = static_cast<std::size_t>(num_rows());
        return place_[static_cast<std::size_t>(part) * n
                      + static_cast<std::size_t>(upper_row)];
    }
    void count_columns(int part);
    void sum_counts(int part);
    void find_places(int part);
    void fill_upper(int part);

    RowCut cut_;
    std::vector<int> order_;
    RowBlocksOfMatrix blocks_;
    ColouredRows rows_;
    MergedBlocks lower_;
    MergeWork merging_;
    std::vector<int> place_;    ///< of transpose: per part and row
    std::vector<int> touched_;  ///< per vertex: its index among the touched ones, or -1

    // The pattern that all of this was built for.
    std::vector<int> seen_row_begin_, seen_col_;
    std::vector<Int4> seen_terms_;
    std::vector<std::uint8_t> seen_fixed_;
};

}  // namespace noli
