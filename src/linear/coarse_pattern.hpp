// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Which rows are coupled to which aggregates, and which aggregates to each other: all of
/// the coarse space (coarse_space.hpp) that depends on the pattern of the operator alone.

#include "linear/coarse_cholesky.hpp"
#include "linear/coloured_operator.hpp"

#include <span>
#include <vector>

namespace noli {

/// The aggregates that the off-diagonal blocks of one triangle couple each row to.
struct RowCouplings {
    std::vector<int> begin;      ///< num_rows + 1: first coupling of each row
    std::vector<int> aggregate;  ///< per coupling, ascending in each row
    std::vector<int> row;        ///< per coupling
    std::vector<int> of_begin;   ///< num_aggregates + 1
    std::vector<int> of_row;     ///< rows of the couplings of each aggregate, ascending
    std::vector<int> of_place;   ///< per coupling: its place among those

    [[nodiscard]] std::size_t size() const { return aggregate.size(); }
};

class CoarsePattern {
  public:
    /// In:   of_vertex  per vertex: its aggregate, or -1
    ///       with_lower  whether `lower` is wanted; empty otherwise
    void update(const ColouredOperator& op,
                std::span<const int> of_vertex,
                int count,
                bool with_lower);

    std::vector<int> aggregate;         ///< per row, or -1
    std::vector<int> rows_begin, rows;  ///< rows of each aggregate
    RowCouplings upper, lower;

    /// Z'ᵀ L'ᵀ Z' by aggregates: columns ascending in each row.
    std::vector<int> begin, col;
    std::vector<int> place;  ///< upper coupling -> its place in that matrix
    /// Per block of the coarse matrix, lower triangle: places of (row, col) and of
    /// (col, row) in that matrix, or -1.
    std::vector<int> from;

    /// Sets the pattern of the coarse matrix, and `from`.
    void find_matrix(CoarseMatrix& matrix);

  private:
    void find_rows(const ColouredOperator& op, std::span<const int> of_vertex, int count);
    void find_couplings_of_aggregates();
    [[nodiscard]] int place_of(int a, int b) const;

    std::vector<int> found_;
};

}  // namespace noli
