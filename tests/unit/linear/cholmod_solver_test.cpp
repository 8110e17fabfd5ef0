// SPDX-License-Identifier: Apache-2.0
#include "linear/cholmod_solver.hpp"

#include "linear/pcg.hpp"
#include "random_system.hpp"

namespace noli {
namespace {

using namespace test;
using Outcome = CholmodSolver::Outcome;

#define NOLI_SKIP_WITHOUT_CHOLMOD() \
    if (!CholmodSolver::available()) GTEST_SKIP() << "built without CHOLMOD"

TEST(CholmodSolver, SaysWhenItIsNotAvailable) {
    if (CholmodSolver::available()) GTEST_SKIP() << "built with CHOLMOD";
    CholmodSolver solver;
    EXPECT_EQ(solver.factorize({}), Outcome::NotAvailable);
}

TEST(CholmodSolver, AgreesWithPcgAndDenseSolve) {
    NOLI_SKIP_WITHOUT_CHOLMOD();
    const RandomSystem s = random_system(201, 600, 90, 3);
    CpuExec exec;
    auto loaded = load(exec, s);
    const auto b = random_vector(201, 4);
    std::vector<std::uint8_t> fixed(201, 0);
    fixed[0] = fixed[77] = fixed[200] = 1;

    CholmodSolver solver;
    HostBuffer<Vec3d> direct;
    ASSERT_EQ(solve_direct(exec,
                           solver,
                           loaded.matrix,
                           loaded.terms,
                           view_of(b),
                           view_of(fixed),
                           direct),
              Outcome::Solved);
    std::vector<Vec3d> iterative(201);
    Pcg<CpuExec> pcg;
    PcgOptions options;
    options.tolerance = 1e-26;
    pcg.solve(exec,
              loaded.matrix,
              loaded.terms,
              view_of(b),
              view_of(fixed),
              options,
              view_of(iterative));
    const std::vector<Vec3d> x(direct.view().begin(), direct.view().end());
    EXPECT_LT((to_eigen(x) - to_eigen(iterative)).norm(), 1e-10 * to_eigen(x).norm());

    Eigen::VectorXd residual =
        to_eigen(b) - (dense_elements(s) + dense_terms(s)) * to_eigen(x);
    for (const int v : {0, 77, 200}) {
        residual.segment<3>(3 * v).setZero();
        EXPECT_EQ(norm(x[static_cast<std::size_t>(v)]), 0.0);
    }
    EXPECT_LT(residual.norm(), 1e-11 * to_eigen(b).norm());
}

TEST(CholmodSolver, AnalysesAgainOnlyWhenThePatternChanges) {
    NOLI_SKIP_WITHOUT_CHOLMOD();
    RandomSystem s = random_system(60, 150, 8, 5);
    SerialExec exec;
    CholmodSolver solver;
    const Numbering all = number_free_vertices(std::vector<std::uint8_t>(60, 0));
    const auto factorize = [&] {
        const auto loaded = load(exec, s);
        return solver.factorize(assemble_sparse(exec, loaded.matrix, loaded.terms, all));
    };
    EXPECT_EQ(factorize(), Outcome::Solved);
    for (double& d : s.diagonal)
        d *= 2;
    EXPECT_EQ(factorize(), Outcome::Solved);
    EXPECT_EQ(solver.num_analyses(), 1);
    s.term_vertices[1] = {{0, 59, -1, -1}};
    EXPECT_EQ(factorize(), Outcome::Solved);
    EXPECT_EQ(solver.num_analyses(), 2);
}

TEST(CholmodSolver, ReportsIndefiniteMatricesAndRecovers) {
    NOLI_SKIP_WITHOUT_CHOLMOD();
    RandomSystem s = random_system(60, 150, 8, 5);
    SerialExec exec;
    CholmodSolver solver;
    const auto b = random_vector(60, 4);
    const std::vector<std::uint8_t> fixed(60, 0);
    HostBuffer<Vec3d> x;
    const auto solve = [&] {
        auto loaded = load(exec, s);
        return solve_direct(
            exec, solver, loaded.matrix, loaded.terms, view_of(b), view_of(fixed), x);
    };
    s.diagonal[20] = -1e3;
    EXPECT_EQ(solve(), Outcome::NotPositiveDefinite);
    s.diagonal[20] = 1.0;
    EXPECT_EQ(solve(), Outcome::Solved);
    const std::vector<Vec3d> got(x.view().begin(), x.view().end());
    const Eigen::VectorXd residual =
        to_eigen(b) - (dense_elements(s) + dense_terms(s)) * to_eigen(got);
    EXPECT_LT(residual.norm(), 1e-11 * to_eigen(b).norm());
}

TEST(CholmodSolver, SolvesWhenEveryVertexIsFixed) {
    NOLI_SKIP_WITHOUT_CHOLMOD();
    const RandomSystem s = random_system(9, 12, 0, 5);
    SerialExec exec;
    CholmodSolver solver;
    auto loaded = load(exec, s);
    HostBuffer<Vec3d> x;
    const std::vector<std::uint8_t> fixed(9, 1);
    EXPECT_EQ(solve_direct(exec,
                           solver,
                           loaded.matrix,
                           loaded.terms,
                           view_of(random_vector(9, 1)),
                           view_of(fixed),
                           x),
              Outcome::Solved);
    for (const Vec3d& v : x.view())
        EXPECT_EQ(norm(v), 0.0);
}

}  // namespace
}  // namespace noli
