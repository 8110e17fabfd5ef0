// SPDX-License-Identifier: Apache-2.0
#include "linear/pcg.hpp"

#include "random_system.hpp"

#include <tbb/global_control.h>

#include <limits>

namespace noli {
namespace {

using namespace test;

template <class Exec>
struct Solution {
    PcgResult result;
    std::vector<Vec3d> x;
};

template <class Exec>
Solution<Exec> solve(const RandomSystem& s,
                     const std::vector<Vec3d>& b,
                     const std::vector<std::uint8_t>& fixed,
                     const PcgOptions& options) {
    Exec exec;
    auto loaded = load(exec, s);
    Pcg<Exec> pcg;
    Solution<Exec> out;
    // Junk: the solver must not read what x held.
    out.x.assign(b.size(), Vec3d{std::numeric_limits<double>::quiet_NaN(), 1e30, -7});
    out.result = pcg.solve(exec,
                           loaded.matrix,
                           loaded.terms,
                           view_of(b),
                           view_of(fixed),
                           options,
                           view_of(out.x));
    return out;
}

constexpr PreconditionerKind kKinds[] = {PreconditionerKind::BlockJacobi,
                                         PreconditionerKind::GaussSeidel,
                                         PreconditionerKind::IncompleteCholesky};

PcgOptions with(PreconditionerKind kind, double tolerance = 1e-4) {
    PcgOptions options;
    options.preconditioner = kind;
    options.tolerance = tolerance;
    return options;
}

/// Dense solution with x = 0 at fixed vertices.
Eigen::VectorXd dense_solution(const RandomSystem& s,
                               const std::vector<Vec3d>& b,
                               const std::vector<std::uint8_t>& fixed) {
    Eigen::MatrixXd dense = dense_elements(s) + dense_terms(s);
    Eigen::VectorXd rhs = to_eigen(b);
    for (Eigen::Index i = 0; i < rhs.size(); ++i) {
        if (fixed[static_cast<std::size_t>(i / 3)] == 0) continue;
        dense.row(i).setZero();
        dense.col(i).setZero();
        dense(i, i) = 1.0;
        rhs[i] = 0.0;
    }
    return dense.llt().solve(rhs);
}

std::vector<std::pair<int, PreconditionerKind>> cases() {
    std::vector<std::pair<int, PreconditionerKind>> all;
    for (const int n : {7, 33, 101, 203})
        for (const PreconditionerKind kind : kKinds)
            all.emplace_back(n, kind);
    return all;
}

template <class Exec>
class PcgOn : public testing::Test {};
using Executors = testing::Types<SerialExec, CpuExec, ShuffledExec>;
TYPED_TEST_SUITE(PcgOn, Executors);

TYPED_TEST(PcgOn, MatchesDenseSolveWithTermsAndFixedVertices) {
    for (const auto& [n, kind] : cases()) {
        const RandomSystem s = random_system(n, 3 * n, n / 2, n);
        const auto b = random_vector(n, 3);
        std::vector<std::uint8_t> fixed(b.size(), 0);
        for (std::size_t i = 0; i < fixed.size(); i += 5)
            fixed[i] = 1;
        const auto got = solve<TypeParam>(s, b, fixed, with(kind, 1e-24));
        EXPECT_EQ(got.result.outcome, PcgResult::Outcome::Converged);
        EXPECT_EQ(got.result.preconditioner, kind);
        EXPECT_LE(got.result.residual_ratio, 1e-24);
        const Eigen::VectorXd expected = dense_solution(s, b, fixed);
        EXPECT_LT((to_eigen(got.x) - expected).norm(), 1e-9 * expected.norm()) << n;
        for (std::size_t i = 0; i < fixed.size(); i += 5)
            EXPECT_TRUE(got.x[i].x == 0 && got.x[i].y == 0 && got.x[i].z == 0);
    }
}

TEST(Pcg, StopsAtTheToleranceInThePreconditionedNorm) {
    const RandomSystem s = random_system(301, 900, 50, 2);
    const auto b = random_vector(301, 3);
    const std::vector<std::uint8_t> fixed(b.size(), 0);
    const auto got = solve<CpuExec>(s, b, fixed, {});
    EXPECT_EQ(got.result.outcome, PcgResult::Outcome::Converged);
    EXPECT_LE(got.result.residual_ratio, 1e-4);

    // The ratio, computed anew from the iterate with dense algebra.
    const Eigen::MatrixXd dense = dense_elements(s) + dense_terms(s);
    const auto preconditioned_norm_sq = [&](const Eigen::VectorXd& r) {
        double sum = 0.0;
        for (Eigen::Index i = 0; i < r.size(); i += 3) {
            const Eigen::Matrix3d block = dense.block<3, 3>(i, i);
            sum += r.segment<3>(i).dot(block.llt().solve(r.segment<3>(i)));
        }
        return sum;
    };
    const Eigen::VectorXd residual = to_eigen(b) - dense * to_eigen(got.x);
    const double ratio =
        preconditioned_norm_sq(residual) / preconditioned_norm_sq(to_eigen(b));
    EXPECT_NEAR(ratio, got.result.residual_ratio, 1e-8 * ratio);
}

class PcgWith : public testing::TestWithParam<PreconditionerKind> {};
INSTANTIATE_TEST_SUITE_P(, PcgWith, testing::ValuesIn(kKinds));

TEST_P(PcgWith, ReportsMaxIterationsWithTheLastIterate) {
    const RandomSystem s = random_system(101, 300, 0, 2);
    const auto b = random_vector(101, 3);
    const std::vector<std::uint8_t> fixed(b.size(), 0);
    PcgOptions options = with(GetParam(), 1e-24);
    options.max_iterations = 3;
    const auto got = solve<SerialExec>(s, b, fixed, options);
    EXPECT_EQ(got.result.outcome, PcgResult::Outcome::MaxIterations);
    EXPECT_EQ(got.result.iterations, 3);
    EXPECT_LT(got.result.residual_ratio, 1.0);
    // CG lowers x.Ax/2 - b.x in every step; the third iterate is far below 0.
    const Eigen::VectorXd x = to_eigen(got.x);
    EXPECT_LT(0.5 * x.dot(dense_elements(s) * x) - to_eigen(b).dot(x), -1e-3);
}

TEST_P(PcgWith, ReturnsZeroForZeroRightHandSide) {
    const RandomSystem s = random_system(11, 20, 0, 2);
    const std::vector<Vec3d> b(11, Vec3d{0, 0, 0});
    const auto got =
        solve<SerialExec>(s, b, std::vector<std::uint8_t>(11, 0), with(GetParam()));
    EXPECT_EQ(got.result.outcome, PcgResult::Outcome::Converged);
    EXPECT_EQ(got.result.iterations, 0);
    EXPECT_EQ(to_eigen(got.x).norm(), 0.0);
}

TEST_P(PcgWith, ReturnsZeroWhenEveryVertexIsFixed) {
    const RandomSystem s = random_system(11, 20, 5, 2);
    const auto got = solve<SerialExec>(
        s, random_vector(11, 1), std::vector<std::uint8_t>(11, 1), with(GetParam()));
    EXPECT_EQ(got.result.outcome, PcgResult::Outcome::Converged);
    EXPECT_EQ(to_eigen(got.x).norm(), 0.0);
}

TEST_P(PcgWith, SolvesADiagonalMatrixInOneIteration) {
    const RandomSystem s = random_system(40, 0, 0, 2);
    const auto b = random_vector(40, 1);
    const auto got = solve<SerialExec>(
        s, b, std::vector<std::uint8_t>(40, 0), with(GetParam(), 1e-12));
    EXPECT_EQ(got.result.outcome, PcgResult::Outcome::Converged);
    EXPECT_LE(got.result.iterations, 2);  // a preconditioner in float may need a second
    for (std::size_t i = 0; i < 40; ++i)
        EXPECT_NEAR(got.x[i].y, b[i].y / s.diagonal[i], 1e-5 * std::abs(got.x[i].y));
}

TEST_P(PcgWith, ReportsBreakdownOnAnIndefiniteMatrix) {
    RandomSystem s = random_system(50, 120, 4, 2);
    for (double& h : s.element_blocks)
        h = -h;
    const auto b = random_vector(50, 3);
    const auto got =
        solve<CpuExec>(s, b, std::vector<std::uint8_t>(50, 0), with(GetParam()));
    EXPECT_EQ(got.result.outcome, PcgResult::Outcome::Breakdown);
    for (const Vec3d& x : got.x)
        EXPECT_TRUE(std::isfinite(norm_sq(x)));
}

TEST_P(PcgWith, ReportsBreakdownWhenOnlyTheCouplingIsIndefinite) {
    // Diagonal blocks are the identity, so only a search direction can tell.
    const std::vector<Int2> couplings = {{{0, 1}}};
    BlockMatrix<SerialExec> matrix;
    LowRankTerms<SerialExec> terms;
    SerialExec exec;
    matrix.set_pattern(exec, build_block_pattern(2, std::span(couplings)));
    const std::vector<Mat3d> upper = {identity3(), 2.0 * identity3(), identity3()};
    matrix.set_upper(exec, view_of(upper));
    terms.resize(0, 0);
    terms.build_incidence(exec, 2);
    const std::vector<Vec3d> b = {{1, 0, 0}, {-1, 0, 0}};
    const std::vector<std::uint8_t> fixed(2, 0);
    std::vector<Vec3d> x(2);
    Pcg<SerialExec> pcg;
    const PcgResult result = pcg.solve(
        exec, matrix, terms, view_of(b), view_of(fixed), with(GetParam()), view_of(x));
    EXPECT_EQ(result.outcome, PcgResult::Outcome::Breakdown);
}

TEST_P(PcgWith, ReportsBreakdownOnNaN) {
    RandomSystem s = random_system(50, 120, 0, 2);
    const std::vector<std::uint8_t> fixed(50, 0);
    for (const std::size_t entry : {0, 17}) {  // on a diagonal block, and beside it
        s.element_blocks[entry] = std::numeric_limits<double>::quiet_NaN();
        const auto got = solve<CpuExec>(s, random_vector(50, 3), fixed, with(GetParam()));
        EXPECT_EQ(got.result.outcome, PcgResult::Outcome::Breakdown) << entry;
        s = random_system(50, 120, 0, 2);
    }
    auto b = random_vector(50, 3);
    b[3].y = std::numeric_limits<double>::quiet_NaN();
    const auto got = solve<CpuExec>(s, b, fixed, with(GetParam()));
    EXPECT_EQ(got.result.outcome, PcgResult::Outcome::Breakdown);
}

TEST_P(PcgWith, LeavesAFreeVertexWithoutStiffnessWhereItIs) {
    RandomSystem s = random_system(50, 120, 0, 2);
    s.diagonal[49] = 0.0;  // the last vertex belongs to no element
    auto b = random_vector(50, 3);
    b[49] = {0, 0, 0};
    const auto got =
        solve<CpuExec>(s, b, std::vector<std::uint8_t>(50, 0), with(GetParam()));
    EXPECT_EQ(got.result.outcome, PcgResult::Outcome::Converged);
    EXPECT_EQ(norm(got.x[49]), 0.0);
}

TEST_P(PcgWith, IgnoresTheRightHandSideAtFixedVertices) {
    const RandomSystem s = random_system(40, 100, 10, 2);
    auto b = random_vector(40, 3);
    std::vector<std::uint8_t> fixed(40, 0);
    fixed[4] = fixed[39] = 1;
    const auto before = solve<SerialExec>(s, b, fixed, with(GetParam()));
    b[4] = {1e6, -1e6, 3};
    const auto after = solve<SerialExec>(s, b, fixed, with(GetParam()));
    EXPECT_TRUE(same_bits(before.x, after.x));
}

TEST_P(PcgWith, FollowsChangesOfPatternAndValuesFromSolveToSolve) {
    SerialExec exec;
    Pcg<SerialExec> reused;
    for (const int seed : {1, 2, 2, 3}) {
        RandomSystem s = random_system(60 + seed, 150, 10 * seed, seed);
        const auto b = random_vector(s.num_vertices, seed);
        std::vector<std::uint8_t> fixed(b.size(), 0);
        fixed[static_cast<std::size_t>(seed)] = 1;
        auto loaded = load(exec, s);
        std::vector<Vec3d> x(b.size());
        reused.solve(exec,
                     loaded.matrix,
                     loaded.terms,
                     view_of(b),
                     view_of(fixed),
                     with(GetParam(), 1e-24),
                     view_of(x));
        const Eigen::VectorXd expected = dense_solution(s, b, fixed);
        EXPECT_LT((to_eigen(x) - expected).norm(), 1e-9 * expected.norm()) << seed;
    }
}

TEST_P(PcgWith, HasTheSameBitsOnEveryExecutorAndThreadCount) {
    const RandomSystem s = random_system(4999, 14001, 60, 6);
    const auto b = random_vector(4999, 3);
    std::vector<std::uint8_t> fixed(b.size(), 0);
    fixed[0] = fixed[1000] = 1;
    const auto reference = solve<SerialExec>(s, b, fixed, with(GetParam(), 1e-12));
    EXPECT_GT(reference.result.iterations, 3);
    EXPECT_TRUE(same_bits(solve<ShuffledExec>(s, b, fixed, with(GetParam(), 1e-12)).x,
                          reference.x));
    for (const std::size_t threads : {1, 2, 3, 4}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                        threads);
        EXPECT_TRUE(same_bits(solve<CpuExec>(s, b, fixed, with(GetParam(), 1e-12)).x,
                              reference.x))
            << threads;
    }
}

TEST(RobustInverse, InvertsWellConditionedBlocks) {
    std::mt19937 rng(3);
    std::normal_distribution<double> normal;
    for (int trial = 0; trial < 50; ++trial) {
        Eigen::Matrix3d half;
        for (double& h : half.reshaped())
            h = normal(rng);
        const Eigen::Matrix3d m =
            half * half.transpose() + 0.1 * Eigen::Matrix3d::Identity();
        Mat3d block;
        for (int k = 0; k < 9; ++k)
            block.a[k] = m(k / 3, k % 3);
        const SymMat3d inverse = robust_inverse(block);
        Eigen::Matrix3d got;
        got << inverse.xx, inverse.xy, inverse.xz, inverse.xy, inverse.yy, inverse.yz,
            inverse.xz, inverse.yz, inverse.zz;
        EXPECT_LT((got - m.inverse()).norm(), 1e-12 * m.inverse().norm());
    }
}

TEST(RobustInverse, IsFiniteAndPositiveForSingularAndIndefiniteBlocks) {
    const Mat3d blocks[] = {
        outer(Vec3d{1, 2, 3}, Vec3d{1, 2, 3}),  // rank one
        outer(Vec3d{1e8, 1e-3, 0}, Vec3d{1e8, 1e-3, 0})
            + identity3(),            // very stiff along x
        {1, 2, 0, 2, 1, 0, 0, 0, 1},  // indefinite
        {-1, 0, 0, 0, 2, 0, 0, 0, 3},
    };
    for (const Mat3d& block : blocks) {
        const SymMat3d p = robust_inverse(block);
        for (int trial = 0; trial < 20; ++trial) {
            const Vec3d v = random_vector(1, trial)[0];
            const double form = dot(v, p * v);
            EXPECT_TRUE(std::isfinite(form));
            EXPECT_GT(form, 0.0);
        }
    }
    const SymMat3d none = robust_inverse(zero3());
    EXPECT_EQ(none.xx + none.xy + none.xz + none.yy + none.yz + none.zz, 0.0);
}

}  // namespace
}  // namespace noli
