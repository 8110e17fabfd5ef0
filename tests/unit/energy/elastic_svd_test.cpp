// SPDX-License-Identifier: Apache-2.0
#include "energy/svd3.hpp"
#include "unit/energy/elastic_cases.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace noli {
namespace {

using elastic_test::from_eigen;
using elastic_test::Random;
using elastic_test::to_eigen;

constexpr double kTolerance = 2e-14;  // of |F|

/// Largest error of any property that svd3 promises, in units of |F| where it has a unit.
double svd_error(const Mat3d& F) {
    const Svd3<double> svd = svd3(F);
    const Eigen::Matrix3d f = to_eigen(F);
    const Eigen::Matrix3d u = to_eigen(svd.u);
    const Eigen::Matrix3d v = to_eigen(svd.v);
    const Eigen::Vector3d s(svd.sigma.x, svd.sigma.y, svd.sigma.z);
    const double size = f.norm() > 0.0 ? f.norm() : 1.0;
    const Eigen::Vector3d reference =
        Eigen::JacobiSVD<Eigen::Matrix3d>(f).singularValues();
    const double order = std::max({0.0, s[1] - s[0], std::abs(s[2]) - s[1]});
    const double errors[] = {
        (u * s.asDiagonal() * v.transpose() - f).norm() / size,
        (s.cwiseAbs() - reference).norm() / size,
        order / size,
        (u.transpose() * u - Eigen::Matrix3d::Identity()).norm(),
        (v.transpose() * v - Eigen::Matrix3d::Identity()).norm(),
        std::abs(u.determinant() - 1.0),
        std::abs(v.determinant() - 1.0),
    };
    double worst = 0.0;
    for (double e : errors)
        worst = std::isnan(e) ? INFINITY : std::max(worst, e);
    return worst;
}

TEST(Svd3, ReconstructsRandomMatrices) {
    Random random(1);
    double worst = 0.0;
    for (int k = 0; k < 50000; ++k)
        worst = std::max(worst, svd_error(from_eigen(random.matrix(1.0))));
    EXPECT_LT(worst, kTolerance);
}

TEST(Svd3, ReconstructsWhenSingularValuesRepeatOrVanish) {
    const double values[] = {0.0, 1e-12, 1e-9, 1e-6, 1e-3, 0.5, 0.7, 1.0 - 1e-8, 1.0};
    Random random(2);
    for (double b : values) {
        for (double c : values) {
            for (double sign : {1.0, -1.0}) {
                for (int k = 0; k < 50; ++k)
                    EXPECT_LT(svd_error(random.with_singular_values(1.0, b, sign * c)),
                              kTolerance)
                        << b << " " << sign * c;
            }
        }
    }
}

TEST(Svd3, ReconstructsEveryMatrixOfSmallIntegers) {
    double worst = 0.0;
    for (int code = 0; code < 19683; ++code) {
        Mat3d F;
        for (int i = 0, rest = code; i < 9; ++i, rest /= 3)
            F.a[i] = rest % 3 - 1;
        worst = std::max(worst, svd_error(F));
    }
    EXPECT_LT(worst, kTolerance);
}

TEST(Svd3, DoesNotDependOnScale) {
    Random random(3);
    for (double scale : {1e-60, 1e-20, 1e20, 1e45}) {
        for (int k = 0; k < 1000; ++k)
            EXPECT_LT(svd_error(from_eigen(scale * random.matrix(1.0))), kTolerance)
                << scale;
    }
}

TEST(Svd3, PutsTheSignOfTheDeterminantIntoTheSmallest) {
    Random random(4);
    for (int k = 0; k < 1000; ++k) {
        const Mat3d F = from_eigen(random.matrix(1.0));
        const Vec3d s = svd3(F).sigma;
        EXPECT_GT(s.x, 0.0);
        EXPECT_GT(s.y, 0.0);
        if (std::fabs(det(F)) > 1e-6) {
            EXPECT_GT(s.z * det(F), 0.0);
        }
    }
}

TEST(Svd3, IsNearlyTheIdentityNearTheIdentity) {
    const Svd3<double> svd = svd3(identity3());
    EXPECT_DOUBLE_EQ(svd.sigma.x, 1.0);
    EXPECT_DOUBLE_EQ(svd.sigma.y, 1.0);
    EXPECT_DOUBLE_EQ(svd.sigma.z, 1.0);
}

TEST(ThirdAngleCosine, MatchesTheTrigonometricForm) {
    double worst = 0.0;
    for (int k = 0; k <= 100000; ++k) {
        const double r = k / 100000.0;
        worst = std::max(
            worst,
            std::fabs(detail::third_angle_cosine(r) - std::cos(std::acos(r) / 3.0)));
    }
    EXPECT_LT(worst, 5e-16);
}

/// |A+ - clamped A| / |A|, by Eigen's solver.
double positive_part_error(const Eigen::Matrix3d& a) {
    const Symmetric3<double> p = positive_part(
        Symmetric3<double>{a(0, 0), a(1, 1), a(2, 2), a(0, 1), a(0, 2), a(1, 2)});
    Eigen::Matrix3d got;
    got << p.xx, p.xy, p.xz, p.xy, p.yy, p.yz, p.xz, p.yz, p.zz;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(a);
    const Eigen::Matrix3d want = eigen.eigenvectors()
                               * eigen.eigenvalues().cwiseMax(0.0).asDiagonal()
                               * eigen.eigenvectors().transpose();
    const double error = (got - want).norm() / std::max(a.norm(), 1e-300);
    return std::isnan(error) ? INFINITY : error;
}

TEST(PositivePart, ClampsNegativeEigenvaluesOfSymmetricMatrices) {
    const double values[] = {-1.0, -1.0 + 1e-9, -0.3, -1e-6, 0.0, 1e-9, 1e-3, 0.5, 1.0};
    Random random(5);
    for (double a : values) {
        for (double b : values) {
            for (double c : values) {
                for (int k = 0; k < 5; ++k) {
                    const Eigen::Matrix3d q = random.rotation();
                    const Eigen::Matrix3d m =
                        q * Eigen::Vector3d(a, b, c).asDiagonal() * q.transpose();
                    EXPECT_LT(positive_part_error(0.5 * (m + m.transpose())), kTolerance)
                        << a << " " << b << " " << c;
                }
            }
        }
    }
}

TEST(PositivePart, ClampsMatricesOfSmallIntegers) {
    for (int code = 0; code < 15625; ++code) {
        int e[6];
        for (int i = 0, rest = code; i < 6; ++i, rest /= 5)
            e[i] = rest % 5 - 2;
        Eigen::Matrix3d m;
        m << e[0], e[1], e[2], e[1], e[3], e[4], e[2], e[4], e[5];
        EXPECT_LT(positive_part_error(m), kTolerance) << m;
    }
}

}  // namespace
}  // namespace noli
