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

    /// The next analyze() finds an order from its pattern alone.
    void forget_order() { order_.clear(); }

    /// False if a pivot is not a number. What a column takes off the columns after it is
    /// computed in parallel, a column of the matrix per task.
    template <class Exec>
    bool factorize(Exec& exec, const CoarseMatrix& matrix) {
        constexpr int kColumnsPerTask = 4;
        scatter(matrix);
        for (int k = 0; k < static_cast<int>(order_.size()); ++k) {
            if (!finish_column(matrix, k)) return false;
            const int count = num_below(k);
            exec.for_each(
                "linear/coarse_eliminate",
                count,
                [this, k, count](int i) {
                    // The first targets take the most work: every share gets some.
                    eliminate(k, i % 2 == 0 ? i / 2 : count - 1 - i / 2);
                },
                kColumnsPerTask);
        }
        return true;
    }

    /// In:   x (6 num_rows) right-hand side
    /// Out:  x (6 num_rows) solution
    void solve(std::span<double> x) const;

    /// 6x6 blocks below and on the diagonal of the factor.
    [[nodiscard]] std::size_t num_blocks() const { return row_.size(); }

  private:
    void find_order(const CoarseMatrix& matrix);
    void find_pattern(const CoarseMatrix& matrix);
    void scatter(const CoarseMatrix& matrix);
    [[nodiscard]] int num_below(int column) const;
    bool finish_column(const CoarseMatrix& matrix, int column);
    void eliminate(int column, int target);

    std::vector<int> order_;            ///< place -> row of the matrix
    std::vector<int> place_;            ///< row of the matrix -> place
    std::vector<int> col_begin_, row_;  ///< factor by columns, diagonal first, ascending
    std::vector<Block6> value_;         ///< diagonal blocks: inverse of their factor
    std::size_t blocks_of_order_ = 0;   ///< of the factor when the order was chosen
    mutable std::vector<double> work_;
};

}  // namespace noli
