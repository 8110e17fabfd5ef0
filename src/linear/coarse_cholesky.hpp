// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Sparse Cholesky factorisation of a symmetric matrix of 6x6 blocks: the coarse matrix
/// of rigid motions, some hundred to some thousand blocks. Host only.
///
/// Rows are eliminated in the order of least degree of a pattern seen before: contacts
/// change it all the time, but not by much. A direction without stiffness (the
/// rotation of an aggregate that is one vertex) is left out: its pivot counts as
/// infinite.

#include <span>
#include <vector>

namespace noli {

/// Row-major.
struct Block6 {
    double a[36];
};

/// Lower triangle by rows: columns ascending, the diagonal block last. Of the diagonal
/// blocks all 36 numbers are set.
struct CoarseMatrix {
    std::vector<int> row_begin;  ///< num_rows + 1
    std::vector<int> col;
    std::vector<Block6> value;

    [[nodiscard]] int num_rows() const { return static_cast<int>(row_begin.size()) - 1; }
};

class CoarseCholesky {
  public:
    /// Finds the pattern of the factor, and an order if there is none or the one in use
    /// has become poor; call when the pattern of the matrix changed.
    void analyze(const CoarseMatrix& matrix);

    /// False if a pivot is not a number.
    bool factorize(const CoarseMatrix& matrix);

    /// In:   x (6 num_rows) right-hand side
    /// Out:  x (6 num_rows) solution
    void solve(std::span<double> x) const;

    /// 6x6 blocks below and on the diagonal of the factor.
    [[nodiscard]] std::size_t num_blocks() const { return row_.size(); }

  private:
    void find_order(const CoarseMatrix& matrix);
    void find_pattern(const CoarseMatrix& matrix);
    void scatter(const CoarseMatrix& matrix);
    void eliminate(int column);

    std::vector<int> order_;            ///< place -> row of the matrix
    std::vector<int> place_;            ///< row of the matrix -> place
    std::vector<int> col_begin_, row_;  ///< factor by columns, diagonal first, ascending
    std::vector<Block6> value_;         ///< diagonal blocks: inverse of their factor
    std::size_t blocks_of_order_ = 0;   ///< of the factor when the order was chosen
    mutable std::vector<double> work_;
};

}  // namespace noli
