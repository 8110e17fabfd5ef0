// SPDX-License-Identifier: Apache-2.0
/// Supplement 4: the eigenpairs of the mollified barrier, Eqs. (11) to (15), against
/// finite differences in J space; and what of them the library keeps.
#include "support/mollified_reference.hpp"

#include <gtest/gtest.h>

namespace noli::test {
namespace {

constexpr double kEps = 1.3;

/// Columns of J as the three points of a stencil: its 9 coordinates are then vec(J).
Stencil<3> columns_of(const Eigen::Matrix3d& J) {
    Stencil<3> out;
    for (int i = 0; i < 3; ++i)
        out.x[i] = {J(0, i), J(1, i), J(2, i)};
    return out;
}

Eigen::Matrix3d matrix_of(const Stencil<3>& columns) {
    Eigen::Matrix3d J;
    for (int i = 0; i < 3; ++i)
        J.col(i) = Eigen::Vector3d(columns.x[i].x, columns.x[i].y, columns.x[i].z);
    return J;
}

struct Directions {
    Eigen::Vector3d gamma, g;
};

const Directions kAxes{Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()};

/// b~(J), naive.
double energy(const Eigen::Matrix3d& J, const Directions& n, int r) {
    const double gamma = (J * n.gamma).squaredNorm();
    const double g = (J * n.g).squaredNorm();
    const double m = 2.0 * gamma / kEps - gamma * gamma / (kEps * kEps);
    return m * barrier_of(r, g, 1.0);
}

/// vec(db~/dJ) = 2 b~_gamma J n n^T + 2 b~_g J n n^T of the two invariants.
Vec9 gradient(const Eigen::Matrix3d& J, const Directions& n, int r) {
    const MollifiedPartials b =
        mollified_partials(r, (J * n.gamma).squaredNorm(), (J * n.g).squaredNorm(), kEps);
    return vec(2.0 * b.gamma * J * n.gamma * n.gamma.transpose()
               + 2.0 * b.g * J * n.g * n.g.transpose());
}

Mat9 difference_hessian(const Eigen::Matrix3d& J, const Directions& n, int r) {
    const auto slope = [&](const Stencil<3>& y) -> Eigen::VectorXd {
        return gradient(matrix_of(y), n, r);
    };
    return central_differences(slope, columns_of(J), 1e-4);
}

/// f(c, s, r) over both signs of lambda_gamma1 (c^2 above and below eps / 3).
template <class F>
void sweep(const F& f) {
    for (double c : {0.05, 0.3, 0.65, 0.67, 0.9, 1.1})
        for (double s : {0.1, 0.4, 0.8})
            for (int r : {1, 2}) {
                SCOPED_TRACE(testing::Message()
                             << "c " << c << ", s " << s << ", r " << r);
                f(c, s, r);
            }
}

Eigen::Matrix3d random_stretch(PairSampler& sampler) {
    Eigen::Matrix3d J;
    for (int i = 0; i < 9; ++i)
        J(i / 3, i % 3) = sampler.uniform(-0.4, 0.4);
    return J;
}

Eigen::Vector3d random_unit(PairSampler& sampler) {
    const Vec3d n = normalized(sampler.normal());
    return {n.x, n.y, n.z};
}

TEST(MollifiedSpace, GradientMatchesDifferencesOfTheEnergy) {
    PairSampler sampler(1);
    for (int k = 0; k < 50; ++k) {
        const Eigen::Matrix3d J = random_stretch(sampler);
        const Directions n{random_unit(sampler), random_unit(sampler)};
        for (int r : {1, 2}) {
            const auto value = [&](const Stencil<3>& y) -> Eigen::VectorXd {
                return Eigen::VectorXd::Constant(1, energy(matrix_of(y), n, r));
            };
            const double h = 3e-3 * (J * n.g).norm();
            const Eigen::MatrixXd difference =
                central_differences(value, columns_of(J), h);
            EXPECT_LE(relative_error(gradient(J, n, r), difference.transpose()), 1e-7);
        }
    }
}

TEST(MollifiedSpace, Equation15IsTheHessian) {
    sweep([](double c, double s, int r) {
        const Eigen::Matrix3d J = Eigen::Vector3d(1.0, c, s).asDiagonal();
        const Mat9 closed =
            mollified_stretch_hessian(mollified_spectrum(r, c, s, kEps), c, s);
        EXPECT_LE(relative_error(closed, difference_hessian(J, kAxes, r)), 1e-7);
    });
}

TEST(MollifiedSpace, Equations11And12GiveEigenmatricesForAnyStretch) {
    PairSampler sampler(2);
    for (int k = 0; k < 50; ++k) {
        const Eigen::Matrix3d J = random_stretch(sampler);
        const Eigen::Vector3d n = random_unit(sampler);
        const Directions both{n, random_unit(sampler)};
        // The first two terms: the Hessian in J with g held at a constant.
        const double gamma = (J * n).squaredNorm();
        const double g = (J * both.g).squaredNorm();
        const MollifiedPartials b = mollified_partials(2, gamma, g, kEps);
        const auto slope = [&](const Stencil<3>& y) -> Eigen::VectorXd {
            const Eigen::Matrix3d Y = matrix_of(y);
            const double at = (Y * n).squaredNorm();
            return vec(2.0 * mollified_partials(2, at, g, kEps).gamma * Y * n
                       * n.transpose());
        };
        const Mat9 H = central_differences(slope, columns_of(J), 1e-3);
        const Eigen::JacobiSVD<Eigen::Matrix3d> svd(
            J, Eigen::ComputeFullU | Eigen::ComputeFullV);
        const auto twists =
            twist_eigenmatrices(svd.matrixU(), svd.singularValues(), svd.matrixV(), n);
        for (const auto& Q : twists)
            EXPECT_LE((H * vec(Q) - 2.0 * b.gamma * vec(Q)).norm(), 1e-8 * H.norm());
        EXPECT_NEAR(vec(twists[0]).dot(vec(twists[1])), 0.0, 1e-10);
        const Vec9 stretch = vec(stretch_eigenmatrix(J, n));
        const double lambda = stretch_eigenvalue(gamma, b.gamma, b.gamma_gamma);
        EXPECT_LE((H * stretch - lambda * stretch).norm(), 1e-8 * H.norm());
    }
}

TEST(MollifiedSpace, PrintedEigenmatricesAreThoseOfTheFormulas) {
    const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
    const Eigen::Vector3d sigma(1.0, 0.3, 0.6);
    Eigen::Matrix3d first;
    Eigen::Matrix3d gamma3;
    Eigen::Matrix3d g3;
    first << 0, 0, 0, 0, 0, 1, 0, -1, 0;
    gamma3 << 0, 1, 0, -1, 0, 0, 0, 0, 0;
    g3 << 0, 0, 1, 0, 0, 0, -1, 0, 0;
    const auto expect_pair = [&](const Eigen::Vector3d& n, const Eigen::Matrix3d& third) {
        const auto Q = twist_eigenmatrices(I, sigma, I, n);
        EXPECT_LE((Q[0] - first * n * n.transpose()).norm(), 1e-15);
        EXPECT_LE((Q[1] - third * n * n.transpose()).norm(), 1e-15);
    };
    expect_pair(kAxes.gamma, gamma3);
    expect_pair(kAxes.g, g3);
}

TEST(MollifiedSpace, Equation13HasTheEigenvaluesPlusMinus4t) {
    sweep([](double c, double s, int r) {
        const MollifiedSpectrum spectrum = mollified_spectrum(r, c, s, kEps);
        const Eigen::Matrix3d J = Eigen::Vector3d(1.0, c, s).asDiagonal();
        const MollifiedPartials b = mollified_partials(r, c * c, s * s, kEps);
        const Vec9 g_gamma = vec(2.0 * J * kAxes.gamma * kAxes.gamma.transpose());
        const Vec9 g_g = vec(2.0 * J * kAxes.g * kAxes.g.transpose());
        const Mat9 terms =
            b.gamma_g * (g_g * g_gamma.transpose() + g_gamma * g_g.transpose());
        EXPECT_LE(relative_error(coupling_matrix(spectrum), terms), 1e-14);
        const Eigen::SelfAdjointEigenSolver<Mat9> eigen(terms);
        const double size = std::fabs(spectrum.coupling);
        EXPECT_NEAR(eigen.eigenvalues()[0], -size, 1e-13 * size);
        EXPECT_NEAR(eigen.eigenvalues()[8], size, 1e-13 * size);
        EXPECT_LE(std::fabs(eigen.eigenvalues()[1]), 1e-13 * size);
    });
}

TEST(MollifiedSpace, Equation14HasTheClosedFormEigenpairs) {
    sweep([](double c, double s, int r) {
        const MollifiedSpectrum spectrum = mollified_spectrum(r, c, s, kEps);
        const Mat9 M = auxiliary_matrix(spectrum);
        Mat9 printed = coupling_matrix(spectrum);
        printed(4, 4) = spectrum.gamma1;
        printed(8, 8) = spectrum.g1;
        EXPECT_LE(relative_error(M, printed), 1e-14);
        const auto expect_eigenpair = [&](double value, const Eigen::Vector2d& q) {
            const Eigen::Matrix3d Q = Eigen::Vector3d(0.0, q[0], q[1]).asDiagonal();
            EXPECT_LE((M * vec(Q) - value * vec(Q)).norm(), 1e-12 * M.norm());
        };
        expect_eigenpair(spectrum.prime7, spectrum.q7);
        expect_eigenpair(spectrum.prime8, spectrum.q8);
    });
}

TEST(MollifiedSpace, SignsAreThoseOfTheText) {
    sweep([](double c, double s, int r) {
        const MollifiedSpectrum spectrum = mollified_spectrum(r, c, s, kEps);
        EXPECT_EQ(spectrum.gamma1 > 0.0, c * c < kEps / 3.0);
        EXPECT_GT(spectrum.gamma23, 0.0);
        EXPECT_GT(spectrum.g1, 0.0);
        EXPECT_LT(spectrum.g23, 0.0);
    });
}

/// [grad c | grad d / dhat] by central differences.
Eigen::Matrix<double, 12, 2> stretch_gradients(const MollifiedCase& sub,
                                               const Stencil<4>& x,
                                               double c,
                                               double dhat) {
    const auto stretch = [&](const Stencil<4>& y) -> Eigen::VectorXd {
        const Point<double> u = {
            y.x[1].x - y.x[0].x, y.x[1].y - y.x[0].y, y.x[1].z - y.x[0].z};
        const Point<double> v = {
            y.x[3].x - y.x[2].x, y.x[3].y - y.x[2].y, y.x[3].z - y.x[2].z};
        return Eigen::Vector2d(std::sqrt(scalar(times(u, v), times(u, v))),
                               mollified_geometry(sub, y).d / dhat);
    };
    return central_differences(stretch, x, 5e-3 * c).transpose();
}

TEST(MollifiedSpace, LibraryPullsBackThePositiveEigenpairsOfM) {
    constexpr double kDhat = 0.1;
    constexpr double kRestEps = 1e-3;
    PairSampler sampler(3);
    for (PairKind kind : {PairKind::PointPoint, PairKind::PointEdge, PairKind::EdgeEdge})
        for (double ratio : {0.05, 0.3, 0.6})
            for (double s : {0.2, 0.7}) {
                SCOPED_TRACE(testing::Message()
                             << "kind " << int(kind) << ", gamma / eps " << ratio
                             << ", s " << s);
                const double c = std::sqrt(ratio * kRestEps);
                const Stencil<4> x = sampler.near_parallel(kind, std::asin(c), s * kDhat);
                const MollifiedCase sub = near_parallel_case(kind);
                const auto A = stretch_gradients(sub, x, c, kDhat);
                const MollifiedSpectrum m = mollified_spectrum(
                    2, c, mollified_geometry(sub, x).d / kDhat, kRestEps);
                const double K = std::pow(kDhat, 4);
                const Eigen::Matrix2d kept =
                    std::fmax(m.prime7, 0.0) * m.q7 * m.q7.transpose()
                    + std::fmax(m.prime8, 0.0) * m.q8 * m.q8.transpose();
                const Eigen::Matrix<double, 12, 12> pulled = K * A * kept * A.transpose();
                const auto two = dense(mollified_hessian(
                    MollifiedHessian::TwoMode, sub, x, kRestEps, {kDhat, 1.0, 2, 0.0}));
                EXPECT_LE(relative_error(two, pulled), 1e-5);
            }
}

}  // namespace
}  // namespace noli::test
