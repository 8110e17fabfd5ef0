// SPDX-License-Identifier: Apache-2.0
#include "linear/incomplete_cholesky.hpp"

#include "random_system.hpp"

namespace noli {
namespace {

using namespace test;

/// The factor of the scaled operator, applied to vectors that are not scaled.
template <class Exec>
class Factor {
  public:
    bool build(const BlockMatrix<Exec>& matrix,
               const LowRankTerms<Exec>& terms,
               View<const std::uint8_t> fixed) {
        return op.build(exec, matrix, terms, fixed, {})
                != ScaledOperator::Built::NotPositive
            && factor.build(exec, op);
    }

    /// z = C⁻ᵀ (M D Mᵀ)⁻¹ C⁻¹ r
    double apply(const std::vector<Vec3d>& r, std::vector<Vec3d>& z) {
        const std::vector<Eigen::Matrix3d> scale = scales();
        std::vector<double> from(4 * scale.size(), 0.0), to(from.size(), 0.0);
        using In = Eigen::Map<const Eigen::Vector3d>;
        for (std::size_t i = 0; i < scale.size(); ++i) {
            Eigen::Map<Eigen::Vector3d> scaled(&from[4 * i]);
            scaled = scale[i] * In(&r[vertex(i)].x);
        }
        double product = 0.0;
        for (int g = 0; g < op.rows().num_groups(); ++g)
            factor.forward(op.rows(), g, from.data(), to.data());
        for (int g = op.rows().num_groups() - 1; g >= 0; --g)
            product += factor.backward(op.rows(), g, from.data(), to.data());
        z.assign(r.size(), Vec3d{0, 0, 0});
        for (std::size_t i = 0; i < scale.size(); ++i) {
            Eigen::Map<Eigen::Vector3d> moved(&z[vertex(i)].x);
            moved = scale[i].transpose() * In(&to[4 * i]);
        }
        return product;
    }

    IncompleteCholesky factor;

  private:
    [[nodiscard]] std::size_t vertex(std::size_t row) const {
        return static_cast<std::size_t>(op.vertex(static_cast<int>(row)));
    }
    [[nodiscard]] std::vector<Eigen::Matrix3d> scales() const {
        std::vector<Eigen::Matrix3d> out(static_cast<std::size_t>(op.rows().num_rows()));
        for (std::size_t i = 0; i < out.size(); ++i)
            for (int r = 0; r < 3; ++r)
                out[i].row(r) << op.scale()[i].c0[r], op.scale()[i].c1[r],
                    op.scale()[i].c2[r];
        return out;
    }

    Exec exec;
    ScaledOperator op;
};

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

    Factor<SerialExec> factor;
    const std::vector<std::uint8_t> fixed(kVertices, 0);
    ASSERT_TRUE(factor.build(matrix, terms, view_of(fixed)));
    const double shift = factor.factor.memory().shift;
    EXPECT_GT(shift, 0.0);
    const auto z = random_vector(kVertices, 1);
    std::vector<Vec3d> r(z.size());
    matrix.multiply(exec, view_of(z), view_of(r));
    std::vector<Mat3d> blocks(z.size());
    matrix.diagonal_blocks(exec, view_of(blocks));
    for (std::size_t i = 0; i < z.size(); ++i)
        r[i] += shift * (blocks[i] * z[i]);
    std::vector<Vec3d> got(z.size());
    const double product = factor.apply(r, got);
    EXPECT_LT((to_eigen(got) - to_eigen(z)).norm(), 1e-5 * to_eigen(z).norm());
    EXPECT_NEAR(product, to_eigen(r).dot(to_eigen(got)), 1e-12 * product);
}

TEST(IncompleteCholesky, IsSymmetricPositiveAndZeroAtFixedVertices) {
    const RandomSystem s = random_system(203, 700, 60, 9);
    CpuExec exec;
    auto loaded = load(exec, s);
    std::vector<std::uint8_t> fixed(203, 0);
    fixed[9] = fixed[100] = 1;
    Factor<CpuExec> factor;
    ASSERT_TRUE(factor.build(loaded.matrix, loaded.terms, view_of(fixed)));
    const auto a = random_vector(203, 1);
    const auto b = random_vector(203, 2);
    std::vector<Vec3d> pa(203);
    std::vector<Vec3d> pb(203);
    EXPECT_GT(factor.apply(a, pa), 0.0);
    EXPECT_GT(factor.apply(b, pb), 0.0);
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
    Factor<CpuExec> factor;
    EXPECT_FALSE(factor.build(loaded.matrix, loaded.terms, view_of(fixed)));
    EXPECT_EQ(factor.factor.memory().shift, 0.0);
}

TEST(IncompleteCholesky, StartsFromTheRememberedShift) {
    const RandomSystem s = random_system(203, 700, 60, 9);
    CpuExec exec;
    auto loaded = load(exec, s);
    const std::vector<std::uint8_t> fixed(203, 0);
    Factor<CpuExec> first;
    ASSERT_TRUE(first.build(loaded.matrix, loaded.terms, view_of(fixed)));
    ASSERT_TRUE(first.build(loaded.matrix, loaded.terms, view_of(fixed)));
    const auto r = random_vector(203, 1);
    std::vector<Vec3d> z(203);
    first.apply(r, z);

    Factor<CpuExec> resumed;  // as after a restart from a checkpoint
    resumed.factor.memory() = first.factor.memory();
    ASSERT_TRUE(resumed.build(loaded.matrix, loaded.terms, view_of(fixed)));
    std::vector<Vec3d> again(203);
    resumed.apply(r, again);
    EXPECT_TRUE(same_bits(z, again));
    EXPECT_EQ(resumed.factor.memory().shift, first.factor.memory().shift);
}

}  // namespace
}  // namespace noli
