// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The preconditioner of SweepCg as a dense matrix.

#include "linear/coloured_operator.hpp"
#include "random_system.hpp"

namespace noli::test {

/// The whole operator as a dense matrix in the solver's row order.
inline Eigen::MatrixXd in_row_order(const RandomSystem& s, const Numbering& numbering) {
    const Eigen::MatrixXd dense = dense_elements(s) + dense_terms(s);
    const auto n = static_cast<int>(numbering.vertex.size());
    Eigen::MatrixXd out(3 * n, 3 * n);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            out.block<3, 3>(3 * i, 3 * j) =
                dense.block<3, 3>(3 * numbering.vertex[static_cast<std::size_t>(i)],
                                  3 * numbering.vertex[static_cast<std::size_t>(j)]);
    return out;
}

/// (D + L) D^-1 (D + L^T) of a matrix of 3x3 blocks.
inline Eigen::MatrixXd gauss_seidel_matrix(const Eigen::MatrixXd& a) {
    Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(a.rows(), a.cols());
    Eigen::MatrixXd inverse = lower;
    for (Eigen::Index i = 0; i < a.rows(); i += 3) {
        lower.block(i, 0, 3, i + 3) = a.block(i, 0, 3, i + 3);
        inverse.block<3, 3>(i, i) = a.block<3, 3>(i, i).inverse();
    }
    return lower * inverse * lower.transpose();
}

}  // namespace noli::test
