// SPDX-License-Identifier: Apache-2.0
#include "linear/coarse_space.hpp"

#include "box_grid.hpp"
#include "core/morton.hpp"
#include "dense_gauss_seidel.hpp"
#include "linear/sweep_cg.hpp"
#include "random_system.hpp"
#include "support/linear_problem.hpp"

#include <tbb/global_control.h>

namespace noli {
namespace {

using namespace test;

std::vector<int> identity_order(int n) {
    std::vector<int> order(static_cast<std::size_t>(n));
    std::iota(order.begin(), order.end(), 0);
    return order;
}

/// Orthonormal basis of the rigid motions of all aggregates, in the solver's row order.
/// Written from the definition: translations, and rotations about the origin.
Eigen::MatrixXd rigid_basis(const RigidAggregates& aggregates,
                            const std::vector<Vec3d>& x,
                            const Numbering& numbering) {
    const auto n = static_cast<Eigen::Index>(numbering.vertex.size());
    std::vector<Eigen::MatrixXd> parts;
    Eigen::Index rank = 0;
    for (int a = 0; a < aggregates.count; ++a) {
        Eigen::MatrixXd z = Eigen::MatrixXd::Zero(3 * n, 6);
        for (Eigen::Index i = 0; i < n; ++i) {
            const auto v =
                static_cast<std::size_t>(numbering.vertex[static_cast<std::size_t>(i)]);
            if (aggregates.of_vertex[v] != a) continue;
            const Eigen::Vector3d at(x[v].x, x[v].y, x[v].z);
            for (int k = 0; k < 3; ++k) {
                z.block<3, 1>(3 * i, k) = Eigen::Vector3d::Unit(k);
                z.block<3, 1>(3 * i, 3 + k) = Eigen::Vector3d::Unit(k).cross(at);
            }
        }
        const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(z);
        parts.emplace_back(qr.householderQ()
                           * Eigen::MatrixXd::Identity(3 * n, qr.rank()));
        rank += qr.rank();
    }
    Eigen::MatrixXd basis(3 * n, rank);
    Eigen::Index next = 0;
    for (const Eigen::MatrixXd& part : parts) {
        basis.middleCols(next, part.cols()) = part;
        next += part.cols();
    }
    return basis;
}

/// A random system whose elements are the tetrahedra, with positions that have nothing to
/// do with them.
class AgainstDenseAlgebra : public testing::TestWithParam<int> {
  protected:
    static constexpr int kNumVertices = 171;

    AgainstDenseAlgebra() {
        const auto order = identity_order(kNumVertices);
        aggregates = cut_aggregates(problem.s.elements, order, GetParam());
        solver.set_aggregates(aggregates);
    }

    PcgResult solve(const PcgOptions& options, std::vector<Vec3d>& out) {
        return problem.solve(solver, options, out);
    }

    [[nodiscard]] Eigen::VectorXd in_rows(const std::vector<Vec3d>& v) const {
        return in_row_order(v, op.numbering());
    }

    LinearProblem<CpuExec> problem{
        random_system(kNumVertices, 480, 70, 5), 3, {2, 100, 169}};
    std::vector<Vec3d> x = random_vector(kNumVertices, 4);
    RigidAggregates aggregates;
    ColouredOperator op = problem.rows();
    SweepCg solver;
};
// One vertex cannot turn, and two cannot turn about the line between them.
INSTANTIATE_TEST_SUITE_P(Sizes,
                         AgainstDenseAlgebra,
                         testing::Values(1, 2, 3, 8, 32, 999));

TEST_P(AgainstDenseAlgebra, MatchesDeflatedPcgIterateByIterate) {
    const Eigen::MatrixXd a = in_row_order(problem.s, op.numbering());
    const Eigen::LLT<Eigen::MatrixXd> sweeps(gauss_seidel_matrix(a));
    const Eigen::MatrixXd basis = rigid_basis(aggregates, x, op.numbering());
    const Eigen::LLT<Eigen::MatrixXd> coarse(basis.transpose() * a * basis);
    const auto correct = [&](const Eigen::VectorXd& r) -> Eigen::VectorXd {
        return basis * coarse.solve(basis.transpose() * r);
    };
    const auto precondition = [&](const Eigen::VectorXd& r) -> Eigen::VectorXd {
        const Eigen::VectorXd y = sweeps.solve(r);
        return y + correct(r - a * y);
    };
    const Eigen::VectorXd start = in_rows(problem.b);
    Eigen::VectorXd expected = correct(start);
    Eigen::VectorXd r = start - a * expected;
    Eigen::VectorXd p = precondition(r);
    double delta = r.dot(p);
    const double first = r.dot(sweeps.solve(r)) + start.dot(expected);
    for (int iteration = 1; iteration <= 12; ++iteration) {
        const Eigen::VectorXd q = a * p;
        const double alpha = delta / p.dot(q);
        expected += alpha * p;
        r -= alpha * q;
        const Eigen::VectorXd z = precondition(r);
        const double next = r.dot(z);
        p = z + (next / delta) * p;
        delta = next;

        PcgOptions options;
        options.tolerance = 1e-30;
        options.max_iterations = iteration;
        options.positions = view_of(x);
        std::vector<Vec3d> got;
        const PcgResult result = solve(options, got);
        if (result.iterations < iteration) {  // all of the space is coarse
            EXPECT_LT(result.residual_ratio, 1e-25);
            EXPECT_LT((in_rows(got) - expected).norm(), 1e-9 * expected.norm());
            break;
        }
        // Z' is stored in single precision.
        EXPECT_LT((in_rows(got) - expected).norm(), 1e-6 * expected.norm()) << iteration;
        constexpr double kRoundingSq = 4e-15;  // of single precision
        EXPECT_NEAR(
            result.residual_ratio, delta / first, 1e-5 * delta / first + kRoundingSq);
        EXPECT_EQ(norm(got[2]) + norm(got[100]) + norm(got[169]), 0.0);
    }
}

TEST_P(AgainstDenseAlgebra, ReachesTheSolution) {
    Eigen::MatrixXd a = in_row_order(problem.s, op.numbering());
    const Eigen::VectorXd exact = a.llt().solve(in_rows(problem.b));
    PcgOptions options;
    options.tolerance = 1e-24;
    options.positions = view_of(x);
    for (const PreconditionerKind kind :
         {PreconditionerKind::GaussSeidel, PreconditionerKind::IncompleteCholesky}) {
        options.preconditioner = kind;
        std::vector<Vec3d> got;
        const PcgResult result = solve(options, got);
        EXPECT_EQ(result.outcome, PcgResult::Outcome::Converged);
        EXPECT_EQ(result.preconditioner, kind);
        // Single precision changes the way to the solution, not the solution.
        EXPECT_LT((in_rows(got) - exact).norm(), 1e-9 * exact.norm());
    }
}

TEST_P(AgainstDenseAlgebra, TakesNoPartWithoutPositions) {
    PcgOptions options;
    options.positions = view_of(x);
    std::vector<Vec3d> with, without, plain;
    solve(options, with);
    options.positions = {};
    solve(options, without);
    solver.set_aggregates({});
    solve(options, plain);
    EXPECT_TRUE(same_bits(without, plain));
    EXPECT_FALSE(same_bits(with, plain));
    options.positions = view_of(x);  // without aggregates they mean nothing
    solve(options, without);
    EXPECT_TRUE(same_bits(without, plain));
}

TEST(CoarseSpace, FollowsChangesOfPatternAndAggregates) {
    SweepCg reused;
    for (const int seed : {1, 2, 2, 3, 4}) {
        const int n = 80 + 7 * (seed % 3);
        LinearProblem<SerialExec> problem(random_system(n, 200, 10 * seed, seed),
                                          seed,
                                          {static_cast<std::size_t>(seed)});
        const auto x = random_vector(n, seed + 50);
        PcgOptions options;
        options.positions = view_of(x);
        for (const int size : {8, 16}) {
            std::vector<Vec3d> got, expected;
            SweepCg fresh;
            for (SweepCg* solver : {&reused, &fresh}) {
                solver->set_aggregates(
                    cut_aggregates(problem.s.elements, identity_order(n), size));
                problem.solve(*solver, options, solver == &reused ? got : expected);
            }
            // The order of elimination is kept where it is good enough.
            EXPECT_LT((to_eigen(got) - to_eigen(expected)).norm(),
                      1e-6 * to_eigen(expected).norm())
                << seed;
        }
    }
}

TEST(CoarseSpace, ForgetsWhatItSawBefore) {
    // After eight solves IC(0) tries a smaller shift.
    constexpr int kVertices = 301;
    SweepCg used, fresh;
    const auto solve = [&](SweepCg& solver, int terms) {
        LinearProblem<SerialExec> problem(random_system(kVertices, 600, terms, 5), 1);
        const auto x = random_vector(kVertices, 2);
        PcgOptions options;
        options.positions = view_of(x);
        options.preconditioner = PreconditionerKind::IncompleteCholesky;
        std::vector<Vec3d> out;
        problem.solve(solver, options, out);
        return out;
    };
    for (SweepCg* solver : {&used, &fresh})
        solver->set_aggregates(cut_aggregates(
            random_system(kVertices, 600, 0, 5).elements, identity_order(kVertices), 4));
    for (int k = 0; k < 9; ++k)
        solve(used, 5);
    EXPECT_FALSE(same_bits(solve(used, 40), solve(fresh, 40)));
    used.forget();
    fresh.forget();
    EXPECT_TRUE(same_bits(solve(used, 40), solve(fresh, 40)));
}

/// Stiff springs along the edges of two boxes, and a little inertia.
struct StiffBoxes {
    TetGrid grid;
    BlockMatrix<CpuExec> matrix;
    LowRankTerms<CpuExec> terms;
    int vertices_of_first = 0;

    StiffBoxes(CpuExec& exec, double inertia) {
        add_box(grid, {12, 4, 4}, {0, 0, 0}, 0.1);
        vertices_of_first = static_cast<int>(grid.x.size());
        add_box(grid, {5, 5, 5}, {0.3, 1, 0.2}, 0.1);
        std::vector<double> blocks;
        for (const Int4& tet : grid.tets)
            add_springs(tet, blocks);
        const auto n = static_cast<int>(grid.x.size());
        const std::vector<double> diagonal(grid.x.size(), inertia);
        matrix.set_pattern(exec, build_block_pattern(n, std::span(grid.tets)));
        matrix.assemble(exec, view_of(blocks), view_of(diagonal));
        terms.resize(0, 0);
        terms.build_incidence(exec, n);
    }

    /// Upper blocks of the tetrahedron's six springs of stiffness 1.
    void add_springs(const Int4& tet, std::vector<double>& blocks) const {
        Eigen::Matrix<double, 12, 12> h = Eigen::Matrix<double, 12, 12>::Zero();
        for (int a = 0; a < 4; ++a)
            for (int b = a + 1; b < 4; ++b) {
                const Vec3d d = grid.x[static_cast<std::size_t>(tet[a])]
                              - grid.x[static_cast<std::size_t>(tet[b])];
                Eigen::Matrix<double, 12, 1> q = Eigen::Matrix<double, 12, 1>::Zero();
                const Eigen::Vector3d along = Eigen::Vector3d(d.x, d.y, d.z).normalized();
                q.segment<3>(3 * a) = along;
                q.segment<3>(3 * b) = -along;
                h += q * q.transpose();
            }
        for (int a = 0; a < 4; ++a)
            for (int b = a; b < 4; ++b)
                for (int k = 0; k < 9; ++k)
                    blocks.push_back(h(3 * a + k / 3, 3 * b + k % 3));
    }
};

TEST(CoarseSpace, FindsTheRigidMotionOfAnAggregateInOneIteration) {
    CpuExec exec;
    StiffBoxes boxes(exec, 1e-5);
    const auto n = static_cast<int>(boxes.grid.x.size());
    const std::vector<int> order = morton_order(boxes.grid.x);
    const RigidAggregates aggregates = cut_aggregates(boxes.grid.tets, order, n);
    ASSERT_EQ(aggregates.count, 2);
    std::vector<Vec3d> exact(boxes.grid.x.size(), Vec3d{0, 0, 0});
    for (std::size_t v = 0; v < static_cast<std::size_t>(boxes.vertices_of_first); ++v)
        exact[v] = Vec3d{1, -0.5, 0.3} + cross(Vec3d{0.4, 2, -1}, boxes.grid.x[v]);
    std::vector<Vec3d> b(exact.size());
    boxes.matrix.multiply(exec, view_of(std::as_const(exact)), view_of(b));
    const std::vector<std::uint8_t> fixed(exact.size(), 0);

    SweepCg solver;
    solver.set_order(order);
    solver.set_aggregates(aggregates);
    const auto error_after = [&](int iterations, bool coarse) {
        PcgOptions options;
        options.tolerance = 1e-30;
        options.max_iterations = iterations;
        if (coarse) options.positions = view_of(std::as_const(boxes.grid.x));
        std::vector<Vec3d> x(exact.size());
        solver.solve(exec,
                     boxes.matrix,
                     boxes.terms,
                     view_of(std::as_const(b)),
                     view_of(fixed),
                     options,
                     view_of(x));
        for (std::size_t v = 0; v < x.size(); ++v)
            x[v] -= exact[v];
        return std::sqrt(
            boxes.matrix.quadratic_form(exec, view_of(std::as_const(x)))
            / boxes.matrix.quadratic_form(exec, view_of(std::as_const(exact))));
    };
    EXPECT_LT(error_after(1, true), 0.01);
    EXPECT_GT(error_after(20, false), 0.1);
}

/// Solves with a coarse space.
template <class Exec>
std::vector<Vec3d> solve_large(const RandomSystem& s, bool single) {
    LinearProblem<Exec> problem(s, 3, {0, 1000});
    const auto x = random_vector(s.num_vertices, 4);
    const std::vector<double> inertia(x.size(), 1e3);
    SweepCg solver;
    solver.set_aggregates(cut_aggregates(s.elements, identity_order(s.num_vertices), 32));
    PcgOptions options;
    options.tolerance = 1e-10;
    options.test = PcgOptions::Test::Energy;
    options.positions = view_of(x);
    if (single) options.inertia = view_of(inertia);
    std::vector<Vec3d> out;
    const PcgResult result = problem.solve(solver, options, out);
    EXPECT_EQ(result.outcome, PcgResult::Outcome::Converged);
    EXPECT_GT(result.iterations, 3);
    return out;
}

TEST(CoarseSpace, HasTheSameBitsOnEveryExecutorAndThreadCount) {
    const RandomSystem s = random_system(4999, 14001, 60, 6);
    for (const bool single : {false, true}) {
        const auto reference = solve_large<SerialExec>(s, single);
        EXPECT_TRUE(same_bits(solve_large<ShuffledExec>(s, single), reference));
        EXPECT_TRUE(same_bits(solve_large<CpuExec>(s, single), reference));
        for (const int threads : {1, 2, 3, 4}) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                            static_cast<std::size_t>(threads));
            EXPECT_TRUE(same_bits(solve_large<CpuExec>(s, single), reference)) << threads;
            // This machine may have fewer cores.
            Team team(threads);
            const TeamScope scope(team);
            EXPECT_TRUE(same_bits(solve_large<CpuExec>(s, single), reference)) << threads;
        }
    }
    EXPECT_FALSE(
        same_bits(solve_large<SerialExec>(s, false), solve_large<SerialExec>(s, true)));
}

TEST(CoarseSpace, ReportsBreakdownWhenPositionsAreNotNumbers) {
    LinearProblem<SerialExec> problem(random_system(60, 150, 10, 3), 3);
    auto x = random_vector(60, 4);
    x[20].y = std::nan("");
    SweepCg solver;
    solver.set_aggregates(cut_aggregates(problem.s.elements, identity_order(60), 16));
    PcgOptions options;
    options.positions = view_of(std::as_const(x));
    std::vector<Vec3d> out;
    const PcgResult result = problem.solve(solver, options, out);
    EXPECT_EQ(result.outcome, PcgResult::Outcome::Breakdown);
}

}  // namespace
}  // namespace noli
