// SPDX-License-Identifier: Apache-2.0
#include "linear/coarse_cholesky.hpp"

#include "exec/cpu.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>

namespace noli {
namespace {

using Dense = Eigen::MatrixXd;

SerialExec exec;

/// Pairs (row, column) of blocks below the diagonal.
using Couplings = std::vector<std::pair<int, int>>;

Couplings random_couplings(int n, int count, std::mt19937& rng) {
    Couplings out;
    std::uniform_int_distribution<int> any(0, n - 1);
    for (int k = 0; k < count; ++k) {
        const int a = any(rng);
        const int b = any(rng);
        if (a != b) out.emplace_back(std::max(a, b), std::min(a, b));
    }
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
}

/// Two-block elements of rank six with a little on the diagonal: positive definite, and
/// not well conditioned.
Dense random_spd(int n, const Couplings& couplings, std::mt19937& rng) {
    std::normal_distribution<double> normal;
    Dense a = 1e-2 * Dense::Identity(6 * n, 6 * n);
    for (const auto& [i, j] : couplings) {
        Eigen::Matrix<double, 12, 6> half;
        for (double& h : half.reshaped())
            h = normal(rng);
        const Eigen::Matrix<double, 12, 12> h = half * half.transpose();
        a.block<6, 6>(6 * i, 6 * i) += h.block<6, 6>(0, 0);
        a.block<6, 6>(6 * i, 6 * j) += h.block<6, 6>(0, 6);
        a.block<6, 6>(6 * j, 6 * i) += h.block<6, 6>(6, 0);
        a.block<6, 6>(6 * j, 6 * j) += h.block<6, 6>(6, 6);
    }
    return a;
}

/// `couplings` sorted by rows.
CoarseMatrix to_blocks(int n, const Couplings& couplings, const Dense& a) {
    CoarseMatrix out;
    out.row_begin.push_back(0);
    auto next = couplings.begin();
    for (int i = 0; i < n; ++i) {
        for (; next != couplings.end() && next->first == i; ++next)
            out.col.push_back(next->second);
        out.col.push_back(i);
        out.row_begin.push_back(static_cast<int>(out.col.size()));
        for (std::size_t p = out.value.size(); p < out.col.size(); ++p) {
            Block6 block;
            for (int k = 0; k < 36; ++k)
                block.a[k] = a(6 * i + k / 6, 6 * out.col[p] + k % 6);
            out.value.push_back(block);
        }
    }
    return out;
}

Eigen::VectorXd random_rhs(int n, std::mt19937& rng) {
    std::normal_distribution<double> normal;
    Eigen::VectorXd b(6 * n);
    for (double& v : b)
        v = normal(rng);
    return b;
}

Eigen::VectorXd solved(const CoarseCholesky& solver, Eigen::VectorXd b) {
    solver.solve({b.data(), static_cast<std::size_t>(b.size())});
    return b;
}

void expect_solves(const CoarseCholesky& solver, const Dense& a, std::mt19937& rng) {
    const Eigen::VectorXd b = random_rhs(static_cast<int>(a.rows() / 6), rng);
    const Eigen::VectorXd expected = a.llt().solve(b);
    EXPECT_LT((solved(solver, b) - expected).norm(), 1e-9 * expected.norm());
}

TEST(CoarseCholesky, MatchesADenseFactorisation) {
    std::mt19937 rng(5);
    for (const int n : {1, 2, 3, 5, 17, 40, 83}) {
        const Couplings couplings = random_couplings(n, 2 * n, rng);
        const Dense a = random_spd(n, couplings, rng);
        const CoarseMatrix matrix = to_blocks(n, couplings, a);
        CoarseCholesky solver;
        solver.analyze(matrix);
        ASSERT_TRUE(solver.factorize(exec, matrix)) << n;
        expect_solves(solver, a, rng);
        expect_solves(solver, a, rng);  // a solve leaves the factor as it is
    }
}

TEST(CoarseCholesky, TakesADiagonalMatrixAndADenseOne) {
    std::mt19937 rng(6);
    Couplings all;
    for (int i = 0; i < 12; ++i)
        for (int j = 0; j < i; ++j)
            all.emplace_back(i, j);
    for (const Couplings& couplings : {Couplings{}, all}) {
        const Dense a = random_spd(12, couplings, rng);
        const CoarseMatrix matrix = to_blocks(12, couplings, a);
        CoarseCholesky solver;
        solver.analyze(matrix);
        ASSERT_TRUE(solver.factorize(exec, matrix));
        EXPECT_EQ(solver.num_blocks(), couplings.size() + 12);  // no fill
        expect_solves(solver, a, rng);
    }
}

TEST(CoarseCholesky, FillsNothingOfATree) {
    std::mt19937 rng(6);
    Couplings star;
    for (int i = 1; i < 60; ++i)
        star.emplace_back(i, 0);
    const Dense a = random_spd(60, star, rng);
    const CoarseMatrix matrix = to_blocks(60, star, a);
    CoarseCholesky solver;
    solver.analyze(matrix);
    ASSERT_TRUE(solver.factorize(exec, matrix));
    EXPECT_EQ(solver.num_blocks(), 60u + 59u);  // 1830 in the matrix's own order
    expect_solves(solver, a, rng);
}

TEST(CoarseCholesky, TakesNewValues) {
    std::mt19937 rng(7);
    const Couplings couplings = random_couplings(30, 60, rng);
    CoarseCholesky solver;
    solver.analyze(to_blocks(30, couplings, random_spd(30, couplings, rng)));
    for (int k = 0; k < 3; ++k) {
        const Dense a = random_spd(30, couplings, rng);
        ASSERT_TRUE(solver.factorize(exec, to_blocks(30, couplings, a)));
        expect_solves(solver, a, rng);
    }
}

TEST(CoarseCholesky, FollowsChangesOfThePattern) {
    std::mt19937 rng(8);
    CoarseCholesky solver;
    // A few couplings more or fewer keep the order; many, or another size, change it.
    for (const auto& [n, count] :
         {std::pair{40, 50}, {40, 53}, {40, 45}, {40, 0}, {40, 400}, {23, 40}, {61, 80}})
        for (int again = 0; again < 2; ++again) {
            const Couplings couplings = random_couplings(n, count, rng);
            const Dense a = random_spd(n, couplings, rng);
            const CoarseMatrix matrix = to_blocks(n, couplings, a);
            solver.analyze(matrix);
            ASSERT_TRUE(solver.factorize(exec, matrix)) << n << " " << count;
            expect_solves(solver, a, rng);
        }
}

TEST(CoarseCholesky, FindsANewOrderWhenTheOldOneFillsTooMuch) {
    std::mt19937 rng(9);
    // Two stars with different centres: the order of one eliminates the other's centre
    // first, which couples all.
    const auto star = [](int centre) {
        Couplings out;
        for (int i = 0; i < 50; ++i)
            if (i != centre) out.emplace_back(std::max(i, centre), std::min(i, centre));
        std::sort(out.begin(), out.end());
        return out;
    };
    CoarseCholesky solver;
    for (const int centre : {49, 0, 20}) {
        const Dense a = random_spd(50, star(centre), rng);
        const CoarseMatrix matrix = to_blocks(50, star(centre), a);
        solver.analyze(matrix);
        ASSERT_TRUE(solver.factorize(exec, matrix));
        EXPECT_EQ(solver.num_blocks(), 50u + 49u) << centre;
        expect_solves(solver, a, rng);
    }
}

/// `a` with the listed unknowns taken out: their rows and columns are zero.
Dense without(Dense a, const std::vector<int>& unknowns) {
    for (const int u : unknowns) {
        a.row(u).setZero();
        a.col(u).setZero();
    }
    return a;
}

TEST(CoarseCholesky, LeavesDirectionsWithoutStiffnessAtZero) {
    std::mt19937 rng(10);
    const int n = 25;
    const Couplings couplings = random_couplings(n, 60, rng);
    // The rotations of block 4, as of an aggregate of one vertex; all of block 11; one
    // unknown of block 0.
    std::vector<int> dead = {27, 28, 29, 2};
    for (int k = 0; k < 6; ++k)
        dead.push_back(6 * 11 + k);
    const Dense full = random_spd(n, couplings, rng);
    const CoarseMatrix matrix = to_blocks(n, couplings, without(full, dead));
    CoarseCholesky solver;
    solver.analyze(matrix);
    ASSERT_TRUE(solver.factorize(exec, matrix));

    Dense alive = without(full, dead);
    Eigen::VectorXd b = random_rhs(n, rng);  // also at dead unknowns
    const Eigen::VectorXd got = solved(solver, b);
    for (const int u : dead) {
        EXPECT_EQ(got[u], 0.0);
        alive(u, u) = 1.0;
        b[u] = 0.0;
    }
    const Eigen::VectorXd expected = alive.llt().solve(b);
    EXPECT_LT((got - expected).norm(), 1e-9 * expected.norm());
}

TEST(CoarseCholesky, SolvesASingularBlockWhereItCanBeSolved) {
    // An aggregate of two vertices cannot turn about the line between them; the direction
    // is no axis of the block.
    std::mt19937 rng(11);
    const int n = 10;
    const Couplings couplings = random_couplings(n, 20, rng);
    Dense a = random_spd(n, couplings, rng);
    Eigen::VectorXd free = Eigen::VectorXd::Zero(6 * n);
    free.segment<3>(6 * 3 + 3) = Eigen::Vector3d(1.0, -2.0, 0.5).normalized();
    const Dense project = Dense::Identity(6 * n, 6 * n) - free * free.transpose();
    a = project * a * project;
    const CoarseMatrix matrix = to_blocks(n, couplings, a);
    CoarseCholesky solver;
    solver.analyze(matrix);
    ASSERT_TRUE(solver.factorize(exec, matrix));
    const Eigen::VectorXd b = a * random_rhs(n, rng);
    const Eigen::VectorXd x = solved(solver, b);
    EXPECT_LT((a * x - b).norm(), 1e-8 * b.norm());
}

TEST(CoarseCholesky, SaysWhenAPivotIsNotANumber) {
    std::mt19937 rng(12);
    const int n = 12;
    const Couplings couplings = random_couplings(n, 30, rng);
    const Dense a = random_spd(n, couplings, rng);
    const CoarseMatrix good = to_blocks(n, couplings, a);
    CoarseCholesky solver;
    solver.analyze(good);
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()})
        for (std::size_t p = 0; p < good.value.size(); ++p) {
            CoarseMatrix matrix = good;
            matrix.value[p].a[0] = bad;
            EXPECT_FALSE(solver.factorize(exec, matrix)) << bad << " in block " << p;
        }
    ASSERT_TRUE(solver.factorize(exec, good));  // nothing stays behind
    expect_solves(solver, a, rng);
}

TEST(CoarseCholesky, TakesAnEmptyMatrix) {
    CoarseMatrix matrix;
    matrix.row_begin = {0};
    CoarseCholesky solver;
    solver.analyze(matrix);
    EXPECT_TRUE(solver.factorize(exec, matrix));
    solver.solve({});
    EXPECT_EQ(solver.num_blocks(), 0u);
}

}  // namespace
}  // namespace noli
