// SPDX-License-Identifier: Apache-2.0
#include "linear/incomplete_cholesky.hpp"

#include "random_system.hpp"

namespace noli {
namespace {

using namespace test;

TEST(IncompleteCholesky, IsTheExactFactorOfTheShiftedMatrixWithoutFill) {
    // A chain of vertices has no fill, so the factor is exact but for the shift and
    // float.
    constexpr int kVertices = 30;
    std::vector<Int2> couplings;
    for (int i = 0; i + 1 < kVertices; ++i)
        couplings.push_back({{i, i + 1}});
    SerialExec exec;
    BlockMatrix<SerialExec> matrix;
    LowRankTerms<SerialExec> terms;
    const BlockPattern pattern = build_block_pattern(kVertices, std::span(couplings));
    matrix.set_pattern(exec, pattern);
    terms.resize(0, 0);
    terms.build_incidence(exec, kVertices);
    std::vector<Mat3d> upper;
    for (std::size_t u = 0; u < pattern.upper.size(); ++u) {
        const Mat3d diagonal = {5, 1, 0, 1, 6, 0.5, 0, 0.5, 4};
        const Mat3d coupling = {-1, 0.5, 0, 0.1, -2, 0, 0.3, 0, -1};
        upper.push_back(pattern.upper[u] == pattern.lower[u] ? diagonal : coupling);
    }
    matrix.set_upper(exec, view_of(upper));

    IncompleteCholesky factor;
    const std::vector<std::uint8_t> fixed(kVertices, 0);
    ASSERT_TRUE(factor.build(exec, matrix, terms, view_of(fixed)));
    const double shift = factor.memory().shift;
    EXPECT_GT(shift, 0.0);
    const auto z = random_vector(kVertices, 1);
    std::vector<Vec3d> r(z.size());
    matrix.multiply(exec, view_of(z), view_of(r));
    std::vector<Mat3d> blocks(z.size());
    matrix.diagonal_blocks(exec, view_of(blocks));
    for (std::size_t i = 0; i < z.size(); ++i)
        r[i] += shift * (blocks[i] * z[i]);
    std::vector<Vec3d> got(z.size());
    const double product = factor.apply(exec, view_of(std::as_const(r)), view_of(got));
    EXPECT_LT((to_eigen(got) - to_eigen(z)).norm(), 1e-5 * to_eigen(z).norm());
    EXPECT_NEAR(product, to_eigen(r).dot(to_eigen(got)), 1e-12 * product);
}

TEST(IncompleteCholesky, IsSymmetricPositiveAndZeroAtFixedVertices) {
    const RandomSystem s = random_system(203, 700, 60, 9);
    CpuExec exec;
    auto loaded = load(exec, s);
    std::vector<std::uint8_t> fixed(203, 0);
    fixed[9] = fixed[100] = 1;
    IncompleteCholesky factor;
    ASSERT_TRUE(factor.build(exec, loaded.matrix, loaded.terms, view_of(fixed)));
    const auto a = random_vector(203, 1);
    const auto b = random_vector(203, 2);
    std::vector<Vec3d> pa(203);
    std::vector<Vec3d> pb(203);
    EXPECT_GT(factor.apply(exec, view_of(a), view_of(pa)), 0.0);
    EXPECT_GT(factor.apply(exec, view_of(b), view_of(pb)), 0.0);
    const double scale = to_eigen(a).norm() * to_eigen(pb).norm();
    EXPECT_NEAR(
        to_eigen(a).dot(to_eigen(pb)), to_eigen(b).dot(to_eigen(pa)), 1e-5 * scale);
    EXPECT_EQ(norm(pa[9]) + norm(pa[100]), 0.0);
}

TEST(IncompleteCholesky, RefusesAnIndefiniteMatrix) {
    RandomSystem s = random_system(60, 150, 0, 9);
    s.diagonal[20] = -1e6;
    CpuExec exec;
    auto loaded = load(exec, s);
    const std::vector<std::uint8_t> fixed(60, 0);
    IncompleteCholesky factor;
    EXPECT_FALSE(factor.build(exec, loaded.matrix, loaded.terms, view_of(fixed)));
    EXPECT_EQ(factor.memory().shift, 0.0);
}

TEST(IncompleteCholesky, StartsFromTheRememberedShift) {
    const RandomSystem s = random_system(203, 700, 60, 9);
    CpuExec exec;
    auto loaded = load(exec, s);
    const std::vector<std::uint8_t> fixed(203, 0);
    IncompleteCholesky first;
    ASSERT_TRUE(first.build(exec, loaded.matrix, loaded.terms, view_of(fixed)));
    ASSERT_TRUE(first.build(exec, loaded.matrix, loaded.terms, view_of(fixed)));
    const auto r = random_vector(203, 1);
    std::vector<Vec3d> z(203);
    first.apply(exec, view_of(r), view_of(z));

    IncompleteCholesky resumed;  // as after a restart from a checkpoint
    resumed.memory() = first.memory();
    ASSERT_TRUE(resumed.build(exec, loaded.matrix, loaded.terms, view_of(fixed)));
    std::vector<Vec3d> again(203);
    resumed.apply(exec, view_of(r), view_of(again));
    EXPECT_TRUE(same_bits(z, again));
    EXPECT_EQ(resumed.memory().shift, first.memory().shift);
}

}  // namespace
}  // namespace noli
