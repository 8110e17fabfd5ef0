// SPDX-License-Identifier: Apache-2.0
#include "linear/block_matrix.hpp"

#include "random_system.hpp"

#include <tbb/global_control.h>

namespace noli {
namespace {

using namespace test;

template <class Exec>
class BlockMatrixOn : public testing::Test {
  public:
    Exec exec;

    std::vector<Vec3d> product(const BlockMatrix<Exec>& matrix,
                               const std::vector<Vec3d>& x) {
        std::vector<Vec3d> y(x.size());
        matrix.multiply(exec, view_of(x), view_of(y));
        return y;
    }
};
using Executors = testing::Types<SerialExec, CpuExec, ShuffledExec>;
TYPED_TEST_SUITE(BlockMatrixOn, Executors);

TYPED_TEST(BlockMatrixOn, MultiplyMatchesDenseMatrix) {
    for (const int n : {9, 33, 101, 130}) {
        const RandomSystem s = random_system(n, 3 * n, 0, n);
        const auto loaded = load(this->exec, s);
        const auto x = random_vector(n, 7);
        const Eigen::VectorXd expected = dense_elements(s) * to_eigen(x);
        const Eigen::VectorXd y = to_eigen(this->product(loaded.matrix, x));
        EXPECT_LT((y - expected).norm(), 1e-13 * expected.norm()) << n;
    }
}

TYPED_TEST(BlockMatrixOn, QuadraticFormAndDiagonalMatchDenseMatrix) {
    const RandomSystem s = random_system(71, 150, 0, 4);
    const auto loaded = load(this->exec, s);
    const Eigen::MatrixXd dense = dense_elements(s);
    const auto x = random_vector(71, 8);
    const double expected = to_eigen(x).dot(dense * to_eigen(x));
    EXPECT_NEAR(
        loaded.matrix.quadratic_form(this->exec, view_of(x)), expected, 1e-12 * expected);

    std::vector<Mat3d> blocks(71);
    loaded.matrix.diagonal_blocks(this->exec, view_of(blocks));
    for (int i = 0; i < 71; ++i)
        for (int k = 0; k < 9; ++k)
            EXPECT_NEAR(blocks[static_cast<std::size_t>(i)].a[k],
                        dense(3 * i + k / 3, 3 * i + k % 3),
                        1e-12);
}

TYPED_TEST(BlockMatrixOn, AxpyAddsScaledMatrix) {
    RandomSystem s = random_system(40, 90, 0, 5);
    auto a = load(this->exec, s);
    for (double& h : s.element_blocks)
        h *= -0.5;
    const auto b = load(this->exec, s);
    const auto x = random_vector(40, 9);
    const Eigen::VectorXd expected = to_eigen(this->product(a.matrix, x))
                                   + 0.25 * to_eigen(this->product(b.matrix, x));
    a.matrix.axpy(this->exec, 0.25, b.matrix);
    EXPECT_LT((to_eigen(this->product(a.matrix, x)) - expected).norm(),
              1e-13 * expected.norm());
}

TYPED_TEST(BlockMatrixOn, SetUpperWritesBothTriangles) {
    const std::vector<Int2> couplings = {{{0, 1}}};
    BlockMatrix<TypeParam> matrix;
    matrix.set_pattern(this->exec, build_block_pattern(2, std::span(couplings)));
    const std::vector<Mat3d> upper = {
        identity3(), {1, 2, 3, 4, 5, 6, 7, 8, 9}, {2, 0, 0, 0, 2, 0, 0, 0, 2}};
    matrix.set_upper(this->exec, view_of(upper));
    const auto y = this->product(matrix, {{1, 0, 0}, {0, 1, 0}});
    EXPECT_TRUE(same_bits(y, {{1 + 2, 5, 8}, {1, 2 + 2, 3}}));
}

/// Bits of an assembly, a product and a quadratic form.
template <class Exec>
std::vector<Vec3d> fingerprint(const RandomSystem& s) {
    Exec exec;
    const auto loaded = load(exec, s);
    const auto x = random_vector(s.num_vertices, 11);
    std::vector<Vec3d> y(x.size());
    loaded.matrix.multiply(exec, view_of(x), view_of(y));
    const double form = loaded.matrix.quadratic_form(exec, view_of(x));
    y.push_back({form, 0, 0});
    return y;
}

TEST(BlockMatrix, HasTheSameBitsOnEveryExecutorAndThreadCount) {
    const RandomSystem s = random_system(1999, 7001, 0, 6);
    const auto reference = fingerprint<SerialExec>(s);
    EXPECT_TRUE(same_bits(fingerprint<ShuffledExec>(s), reference));
    for (const std::size_t threads : {1, 2, 3, 4}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                        threads);
        EXPECT_TRUE(same_bits(fingerprint<CpuExec>(s), reference)) << threads;
    }
}

/// A product of a small system, and of one whose blocks are fetched ahead.
class RowProducts : public testing::TestWithParam<int> {};

TEST_P(RowProducts, HaveTheSameBitsForEveryWidth) {
    const int n = GetParam();
    const RandomSystem s = random_system(n, 4 * n, 0, 12);
    SerialExec exec;
    const auto loaded = load(exec, s);
    EXPECT_EQ(loaded.matrix.num_blocks() > detail::kStreamedBlocks, n > 1000);
    const auto x = random_vector(s.num_vertices, 13);
    std::vector<Vec3d> expected;
    for (int i = 0; i < n; ++i)
        expected.push_back(detail::block_row_product(loaded.matrix.values(),
                                                     loaded.matrix.col(),
                                                     view_of(x),
                                                     loaded.matrix.row_begin()[i],
                                                     loaded.matrix.row_begin()[i + 1]));
    const LaneDispatch widest = lane_dispatch();
    for (const LaneDispatch width :
         {LaneDispatch::Width2, LaneDispatch::Width4, LaneDispatch::Width8}) {
        if (width > widest) continue;
        std::vector<Vec3d> y(x.size());
        const detail::BlockProductKernel kernel{loaded.matrix.row_begin(),
                                                loaded.matrix.col(),
                                                loaded.matrix.values(),
                                                view_of(x),
                                                view_of(y)};
        for (int first = 0; first < n; first += kLaneBlock)
            run_lane_block(width, first, std::min(n, first + kLaneBlock), kernel);
        EXPECT_TRUE(same_bits(y, expected));
    }
}

INSTANTIATE_TEST_SUITE_P(BlockMatrix, RowProducts, testing::Values(203, 9500));

}  // namespace
}  // namespace noli
