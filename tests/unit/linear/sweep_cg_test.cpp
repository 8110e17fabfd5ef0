// SPDX-License-Identifier: Apache-2.0
#include "linear/sweep_cg.hpp"

#include "dense_gauss_seidel.hpp"
#include "random_system.hpp"
#include "support/linear_problem.hpp"

namespace noli {
namespace {

using namespace test;

class RowOrder : public testing::TestWithParam<RowCut> {};

TEST_P(RowOrder, MatchesTextbookPcgIterateByIterate) {
    LinearProblem<CpuExec> problem(random_system(301, 900, 120, 5), 3, {2, 299});
    const ColouredOperator op = problem.rows(GetParam());
    const Numbering& numbering = op.numbering();
    ASSERT_EQ(op.num_rows(), 299);
    const Eigen::MatrixXd a = in_row_order(problem.s, numbering);
    const Eigen::LLT<Eigen::MatrixXd> preconditioner(gauss_seidel_matrix(a));
    Eigen::VectorXd r = in_row_order(problem.b, numbering);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(r.size());
    Eigen::VectorXd z = preconditioner.solve(r);
    Eigen::VectorXd p = z;
    double delta = r.dot(z);
    const double delta_start = delta;
    SweepCg solver(GetParam());
    for (int iteration = 1; iteration <= 12; ++iteration) {
        const Eigen::VectorXd q = a * p;
        const double alpha = delta / p.dot(q);
        x += alpha * p;
        r -= alpha * q;
        z = preconditioner.solve(r);
        p = z + (r.dot(z) / delta) * p;
        delta = r.dot(z);

        PcgOptions options;
        options.tolerance = 1e-30;
        options.max_iterations = iteration;
        std::vector<Vec3d> got;
        const PcgResult result = problem.solve(solver, options, got);
        EXPECT_EQ(result.iterations, iteration);
        EXPECT_NEAR(
            result.residual_ratio, delta / delta_start, 1e-8 * delta / delta_start);
        const Eigen::VectorXd got_rows = in_row_order(got, numbering);
        for (Eigen::Index i = 0; i < x.size(); ++i)
            EXPECT_NEAR(got_rows[i], x[i], 1e-9 * x.norm());
    }
}

INSTANTIATE_TEST_SUITE_P(SweepCg,
                         RowOrder,
                         testing::Values(ScaledOperator::kRowCut, RowCut{16, 4, 0}),
                         [](const testing::TestParamInfo<RowCut>& cut) {
                             return cut.param.region_rows == 0 ? "Regions" : "Blocks";
                         });

/// A system so large that its rows are cut into regions, whose threads share its colours.
TEST(SweepCg, SolvesALargeSystemWithTheBitsOfOneThread) {
    const RandomSystem system = random_system(11000, 40000, 300, 8);
    PcgOptions options;
    options.tolerance = 1e-20;
    std::vector<Vec3d> x[2];
    LinearProblem<CpuExec> shared(system, 3, {2, 299});
    LinearProblem<SerialExec> alone(system, 3, {2, 299});
    ASSERT_GE(shared.rows().num_rows(), ScaledOperator::kRowCut.region_rows);
    SweepCg solver[2];
    EXPECT_EQ(shared.solve(solver[0], options, x[0]).outcome,
              PcgResult::Outcome::Converged);
    EXPECT_EQ(alone.solve(solver[1], options, x[1]).outcome,
              PcgResult::Outcome::Converged);
    EXPECT_TRUE(same_bits(x[0], x[1]));
}

/// Solves a random system with different inertias.
class SinglePrecision : public testing::Test {
  protected:
    SinglePrecision() {
        const Eigen::MatrixXd dense = dense_elements(problem.s) + dense_terms(problem.s);
        largest.reserve(problem.b.size());
        for (Eigen::Index i = 0; i < dense.rows(); i += 3)
            largest.push_back(dense.diagonal().segment<3>(i).maxCoeff());
    }

    std::vector<Vec3d> solve(const std::vector<double>& inertia, double tolerance) {
        PcgOptions options;
        options.tolerance = tolerance;
        options.inertia = view_of(inertia);
        std::vector<Vec3d> x;
        const PcgResult result = problem.solve(solver, options, x);
        EXPECT_EQ(result.outcome, PcgResult::Outcome::Converged);
        return x;
    }

    /// Inertia that is this share of the diagonal at all vertices.
    [[nodiscard]] std::vector<double> share(double of_diagonal) const {
        std::vector<double> inertia = largest;
        for (double& v : inertia)
            v *= of_diagonal;
        return inertia;
    }

    LinearProblem<CpuExec> problem{random_system(301, 900, 120, 5), 3, {7, 200}};
    std::vector<double> largest;  ///< diagonal entry per vertex
    SweepCg solver;
};

TEST_F(SinglePrecision, HasTheSolutionToFiveDigits) {
    const auto in_double = solve({}, 1e-26);
    const auto in_single = solve(share(0.01), 1e-26);
    EXPECT_FALSE(same_bits(in_double, in_single));
    const Eigen::VectorXd expected = to_eigen(in_double);
    EXPECT_LT((to_eigen(in_single) - expected).norm(), 1e-5 * expected.norm());
}

TEST_F(SinglePrecision, IsLeftWhereInertiaIsASmallShareOfTheDiagonal) {
    const auto in_double = solve({}, 1e-8);
    const auto in_single = solve(share(2e-4), 1e-8);
    EXPECT_FALSE(same_bits(in_double, in_single));
    // One vertex decides.
    for (const std::size_t vertex : {0, 100, 300}) {
        std::vector<double> inertia = share(2e-4);
        inertia[vertex] = 0.99e-4 * largest[vertex];
        EXPECT_TRUE(same_bits(solve(inertia, 1e-8), in_double)) << vertex;
        inertia[vertex] = 1.01e-4 * largest[vertex];
        EXPECT_TRUE(same_bits(solve(inertia, 1e-8), in_single)) << vertex;
        inertia[vertex] = 0.0;
        EXPECT_TRUE(same_bits(solve(inertia, 1e-8), in_double)) << vertex;
    }
}

TEST_F(SinglePrecision, DoesNotLookAtFixedVertices) {
    const auto in_single = solve(share(2e-4), 1e-8);
    std::vector<double> inertia = share(2e-4);
    inertia[7] = inertia[200] = 0.0;
    EXPECT_TRUE(same_bits(solve(inertia, 1e-8), in_single));
}

TEST(SweepCg, ForwardSweepHasTheBitsOfAScalarLoop) {
    const RandomSystem s = random_system(203, 700, 60, 9);
    SerialExec exec;
    auto loaded = load(exec, s);
    const std::vector<std::uint8_t> fixed(203, 0);
    OperatorCopy copy;
    const OperatorView view = view_operator(exec, loaded.matrix, loaded.terms, copy);
    ColouredOperator op(ScaledOperator::kRowCut);
    op.update_pattern(exec, view, view_of(fixed));
    op.update_values(exec, view);

    const std::size_t num_off = op.num_off_diagonal();
    std::vector<double> lower(9 * num_off + 1, 0.0);
    const MergedBlocks& merged = op.lower();
    for (int i = 0; i < op.num_rows(); ++i)
        for (int p = merged.row_begin[static_cast<std::size_t>(i)];
             p < merged.row_begin[static_cast<std::size_t>(i) + 1] - 1;
             ++p)
            for (int k = 0; k < 9; ++k)
                lower[static_cast<std::size_t>(9 * (p - i) + k)] =
                    0.01 * merged.value[static_cast<std::size_t>(p)](k % 3, k / 3);
    const auto padded = [&](int seed) {
        std::vector<double> out;
        for (const Vec3d& v : random_vector(203, seed))
            out.insert(out.end(), {v.x, v.y, v.z, 0.0});
        return out;
    };
    std::vector<double> x = padded(1), r = padded(2), p = padded(3), t = padded(4),
                        w = padded(5);
    const std::vector<int> no_rows(204, 0);
    const detail::SweepArrays<double> arrays{detail::const_view(merged.row_begin),
                                             detail::const_view(merged.col),
                                             detail::const_view(no_rows),
                                             detail::const_view(no_rows),
                                             lower.data(),
                                             lower.data(),
                                             x.data(),
                                             r.data(),
                                             p.data(),
                                             t.data(),
                                             w.data()};
    detail::SweepSums sums;
    detail::sweep_forward(arrays, 0, 203, sums);
    std::vector<double> expected(w.size(), 0.0);
    for (int i = 0; i < 203; ++i) {
        double acc[3][3] = {};
        for (int k = merged.row_begin[static_cast<std::size_t>(i)];
             k < merged.row_begin[static_cast<std::size_t>(i) + 1] - 1;
             ++k)
            for (int c = 0; c < 3; ++c)
                for (int row = 0; row < 3; ++row)
                    acc[row][c] +=
                        lower[static_cast<std::size_t>(9 * (k - i) + 3 * c + row)]
                        * expected[static_cast<std::size_t>(
                            4 * merged.col[static_cast<std::size_t>(k)] + c)];
        for (std::size_t row = 0; row < 3; ++row) {
            const std::size_t at = 4 * static_cast<std::size_t>(i) + row;
            expected[at] = p[at] - t[at] - (acc[row][0] + acc[row][1] + acc[row][2]);
        }
    }
    EXPECT_TRUE(same_bits(w, expected));
}

}  // namespace
}  // namespace noli
