// SPDX-License-Identifier: Apache-2.0
#include "linear/assemble.hpp"

#include "random_system.hpp"

namespace noli {
namespace {

using namespace test;

Eigen::MatrixXd to_dense(const SparseMatrix& a) {
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(a.num_rows, a.num_rows);
    for (int c = 0; c < a.num_rows; ++c)
        for (int k = a.col_begin[static_cast<std::size_t>(c)];
             k < a.col_begin[static_cast<std::size_t>(c) + 1];
             ++k) {
            const int r = a.row[static_cast<std::size_t>(k)];
            EXPECT_LE(r, c);
            EXPECT_EQ(dense(r, c), 0.0) << "stored twice";
            dense(r, c) = dense(c, r) = a.value[static_cast<std::size_t>(k)];
        }
    return dense;
}

TEST(AssembleSparse, MatchesDenseMatrixOfTheFreeUnknowns) {
    const RandomSystem s = random_system(53, 120, 60, 3);
    CpuExec exec;
    const auto loaded = load(exec, s);
    std::vector<std::uint8_t> fixed(53, 0);
    for (const std::size_t v : {0, 7, 8, 30, 52})
        fixed[v] = 1;
    const Numbering numbering = number_free_vertices(fixed);
    ASSERT_EQ(numbering.vertex.size(), 48u);
    const SparseMatrix sparse =
        assemble_sparse(exec, loaded.matrix, loaded.terms, numbering);
    const Eigen::MatrixXd got = to_dense(sparse);
    const Eigen::MatrixXd dense = dense_elements(s) + dense_terms(s);
    for (int i = 0; i < 48; ++i)
        for (int j = 0; j < 48; ++j) {
            const int vi = numbering.vertex[static_cast<std::size_t>(i)];
            const int vj = numbering.vertex[static_cast<std::size_t>(j)];
            const Eigen::Matrix3d difference =
                got.block<3, 3>(3 * i, 3 * j) - dense.block<3, 3>(3 * vi, 3 * vj);
            EXPECT_LT(difference.norm(), 1e-11) << i << " " << j;
        }
}

TEST(AssembleSparse, FollowsAnyNumbering) {
    const RandomSystem s = random_system(29, 60, 31, 4);
    SerialExec exec;
    const auto loaded = load(exec, s);
    Numbering numbering;
    numbering.rank.resize(29);
    numbering.vertex.resize(29);
    for (int v = 0; v < 29; ++v) {
        const int place = (v * 11 + 3) % 29;
        numbering.rank[static_cast<std::size_t>(v)] = place;
        numbering.vertex[static_cast<std::size_t>(place)] = v;
    }
    const Eigen::MatrixXd got =
        to_dense(assemble_sparse(exec, loaded.matrix, loaded.terms, numbering));
    const Eigen::MatrixXd dense = dense_elements(s) + dense_terms(s);
    for (int i = 0; i < 87; ++i)
        for (int j = 0; j < 87; ++j) {
            const int vi = numbering.vertex[static_cast<std::size_t>(i / 3)];
            const int vj = numbering.vertex[static_cast<std::size_t>(j / 3)];
            EXPECT_NEAR(got(i, j), dense(3 * vi + i % 3, 3 * vj + j % 3), 1e-11);
        }
}

TEST(AssembleSparse, RowsAreAscendingInEveryColumn) {
    const RandomSystem s = random_system(53, 120, 60, 5);
    SerialExec exec;
    const auto loaded = load(exec, s);
    const auto sparse =
        assemble_sparse(exec,
                        loaded.matrix,
                        loaded.terms,
                        number_free_vertices(std::vector<std::uint8_t>(53, 0)));
    for (std::size_t c = 0; c + 1 < sparse.col_begin.size(); ++c) {
        const auto begin = sparse.row.begin() + sparse.col_begin[c];
        const auto end = sparse.row.begin() + sparse.col_begin[c + 1];
        EXPECT_EQ(std::adjacent_find(begin, end, std::greater_equal<>()), end);
        ASSERT_NE(begin, end);
        EXPECT_EQ(*(end - 1), static_cast<int>(c));
    }
}

}  // namespace
}  // namespace noli
