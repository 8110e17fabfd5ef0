// SPDX-License-Identifier: Apache-2.0
/// Newton systems of real scenes, solved to the solution stored beside them.

#include "ipc_system.hpp"
#include "linear/cholmod_solver.hpp"
#include "linear/pcg.hpp"
#include "random_system.hpp"

#include <gtest/gtest.h>

namespace noli {
namespace {

using namespace test;

struct Case {
    const char* name;
    int jacobi_iterations;  ///< to 1e-2 in the preconditioned norm, measured
                            ///< independently
};

class RealSystem : public testing::TestWithParam<Case> {
  protected:
    void SetUp() override {
        auto read = read_ipc_system(GetParam().name);
        if (!read)
            GTEST_SKIP() << "no " << NOLI_SHARED_DIR << "/linear-systems/"
                         << GetParam().name;
        system = std::move(*read);
        const BlockPattern pattern =
            build_block_pattern(system.num_vertices, std::span(system.couplings));
        ASSERT_EQ(pattern.num_upper(), static_cast<int>(system.a.size()));
        matrix.set_pattern(exec, pattern);
        matrix.set_upper(exec, view_of(system.a));
        terms.resize(0, 0);
        terms.build_incidence(exec, system.num_vertices);
    }

    PcgResult solve(const PcgOptions& options) {
        x.resize(system.b.size());
        Pcg<CpuExec> pcg;
        return pcg.solve(exec,
                         matrix,
                         terms,
                         view_of(system.b),
                         view_of(system.fixed),
                         options,
                         view_of(x));
    }

    /// |x - x*|_A / |x*|_A
    double energy_error(const std::vector<Vec3d>& got) {
        std::vector<Vec3d> difference = got;
        for (std::size_t i = 0; i < got.size(); ++i)
            difference[i] -= system.x[i];
        return std::sqrt(matrix.quadratic_form(exec, view_of(difference))
                         / matrix.quadratic_form(exec, view_of(system.x)));
    }

    CpuExec exec;
    IpcSystem system;
    BlockMatrix<CpuExec> matrix;
    LowRankTerms<CpuExec> terms;
    std::vector<Vec3d> x;
};

TEST_P(RealSystem, BlockJacobiTakesTheKnownNumberOfIterations) {
    const PcgResult result = solve({});
    RecordProperty("iterations", result.iterations);
    EXPECT_EQ(result.outcome, PcgResult::Outcome::Converged);
    const int expected = GetParam().jacobi_iterations;
    EXPECT_NEAR(result.iterations, expected, 2 + expected / 50);
}

TEST_P(RealSystem, SweepPreconditionersHalveTheIterations) {
    PcgOptions options;
    options.preconditioner = PreconditionerKind::GaussSeidel;
    const PcgResult gauss_seidel = solve(options);
    RecordProperty("gauss_seidel", gauss_seidel.iterations);
    EXPECT_EQ(gauss_seidel.outcome, PcgResult::Outcome::Converged);
    EXPECT_LT(gauss_seidel.iterations, 0.5 * GetParam().jacobi_iterations);

    options.preconditioner = PreconditionerKind::IncompleteCholesky;
    const PcgResult incomplete = solve(options);
    RecordProperty("incomplete", incomplete.iterations);
    EXPECT_EQ(incomplete.outcome, PcgResult::Outcome::Converged);
    EXPECT_EQ(incomplete.preconditioner, options.preconditioner);
    EXPECT_LT(incomplete.iterations, 0.6 * GetParam().jacobi_iterations);
}

TEST_P(RealSystem, PcgReachesTheStoredSolution) {
    PcgOptions options;
    options.tolerance = 1e-16;
    options.max_iterations = 60000;
    for (const PreconditionerKind kind :
         {PreconditionerKind::BlockJacobi, PreconditionerKind::GaussSeidel}) {
        options.preconditioner = kind;
        EXPECT_EQ(solve(options).outcome, PcgResult::Outcome::Converged);
        EXPECT_LT(energy_error(x), 1e-5);
    }
}

TEST_P(RealSystem, CholmodReachesTheStoredSolution) {
    if (!CholmodSolver::available()) GTEST_SKIP() << "built without CHOLMOD";
    CholmodSolver solver;
    HostBuffer<Vec3d> got;
    ASSERT_EQ(
        solve_direct(
            exec, solver, matrix, terms, view_of(system.b), view_of(system.fixed), got),
        CholmodSolver::Outcome::Solved);
    EXPECT_LT(energy_error({got.view().begin(), got.view().end()}), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(LinearSystems,
                         RealSystem,
                         testing::Values(Case{"twist_s48_i12", 98},
                                         Case{"rollers_s10_i0", 41},
                                         Case{"dolphin_s22_i25", 39},
                                         Case{"board_s9_i20", 134},
                                         Case{"twistE8_s40_i1", 240}),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace noli
