// SPDX-License-Identifier: Apache-2.0
#include "energy/small_eigen.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace noli {
namespace {

/// Residual, orthonormality and eigenvalues of the decomposition of A, relative to its
/// size.
template <int N>
void expect_eigenpairs(const double (&A)[N][N]) {
    const SymmetricEigen<N> eigen = eigen_symmetric<N>(A);
    Eigen::Matrix<double, N, N> M;
    Eigen::Matrix<double, N, N> V;
    Eigen::Matrix<double, N, 1> values;
    for (int i = 0; i < N; ++i) {
        values[i] = eigen.values[i];
        for (int j = 0; j < N; ++j) {
            M(i, j) = A[i][j];
            V(j, i) = eigen.vectors[i][j];
        }
    }
    const double size = std::max(M.norm(), 1e-300);
    EXPECT_LE((V.transpose() * V - Eigen::Matrix<double, N, N>::Identity()).norm(),
              1e-14 * N);
    EXPECT_LE((M * V - V * values.asDiagonal()).norm(), 1e-14 * N * size);
    std::sort(values.data(), values.data() + N);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, N, N>> reference(M);
    EXPECT_LE((values - reference.eigenvalues()).norm(), 1e-14 * N * size);
}

template <int N>
void expect_eigenpairs_of_random_matrices(unsigned seed) {
    std::mt19937_64 rng(seed);
    std::normal_distribution<> normal;
    std::uniform_real_distribution<> exponent(-12.0, 4.0);
    for (int trial = 0; trial < 200; ++trial) {
        double A[N][N];
        double scale[N];
        for (double& s : scale)
            s = trial % 2 == 0
                  ? 1.0
                  : std::pow(10.0, exponent(rng));  // graded every other time
        for (int i = 0; i < N; ++i)
            for (int j = 0; j <= i; ++j)
                A[i][j] = A[j][i] = normal(rng) * scale[i] * scale[j];
        expect_eigenpairs<N>(A);
    }
}

TEST(SmallEigen, JacobiMatchesEigenOnRandomAndGradedMatrices) {
    expect_eigenpairs_of_random_matrices<1>(1);
    expect_eigenpairs_of_random_matrices<2>(2);
    expect_eigenpairs_of_random_matrices<3>(3);
    expect_eigenpairs_of_random_matrices<5>(5);
    expect_eigenpairs_of_random_matrices<9>(9);
    expect_eigenpairs_of_random_matrices<12>(12);
}

TEST(SmallEigen, JacobiHandlesZeroDiagonalAndRepeatedEigenvalues) {
    const double zero[3][3] = {};
    const double diagonal[3][3] = {{2, 0, 0}, {0, 2, 0}, {0, 0, -1}};
    const double ones[3][3] = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
    expect_eigenpairs<3>(zero);
    expect_eigenpairs<3>(diagonal);
    expect_eigenpairs<3>(ones);
}

TEST(SmallEigen, ClosedFormDiagonalizesWithTheLargerValueFirst) {
    const double entries[][3] = {{1, 0, 2},
                                 {2, 0, 1},
                                 {1, 0, 1},
                                 {0, 0, 0},
                                 {0, 1, 0},
                                 {3, -2, -5},
                                 {-5, 1e-12, 3},
                                 {1, 1e-200, 1},
                                 {1e-200, 2e-200, -1e-200},
                                 {1e200, 2e200, -1e200}};
    for (const auto& [a, b, c] : entries) {
        const SymmetricEigen<2> eigen = eigen_symmetric_2x2(a, b, c);
        const double size = std::max({std::fabs(a), std::fabs(b), std::fabs(c)});
        EXPECT_GE(eigen.values[0], eigen.values[1]);
        for (int k = 0; k < 2; ++k) {
            const double x = eigen.vectors[k][0];
            const double y = eigen.vectors[k][1];
            EXPECT_NEAR(x * x + y * y, 1.0, 1e-14);
            EXPECT_LE(std::fabs(a * x + b * y - eigen.values[k] * x), 4e-15 * size);
            EXPECT_LE(std::fabs(b * x + c * y - eigen.values[k] * y), 4e-15 * size);
        }
    }
}

// The form (1, (lambda - a) / b) returns (1, 0 / b) or worse here.
TEST(SmallEigen, ClosedFormKeepsTinyCouplingsInTheEigenvector) {
    const SymmetricEigen<2> eigen = eigen_symmetric_2x2(1.0, 1e-17, 3.0);
    EXPECT_NEAR(eigen.vectors[0][0] / eigen.vectors[0][1], 0.5e-17, 1e-31);
}

}  // namespace
}  // namespace noli
