// SPDX-License-Identifier: Apache-2.0
/// Stress against differences of the energy, Hessian against differences of the stress.

#include "energy/elastic.hpp"

#include "energy/tet.hpp"
#include "unit/energy/elastic_cases.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace noli {
namespace {

using elastic_test::deformation_cases;
using elastic_test::DeformationCase;
using elastic_test::density_hessian;
using elastic_test::Matrix12;
using elastic_test::Matrix9;
using elastic_test::Random;
using elastic_test::tet_with;
using elastic_test::to_eigen;

template <class Model>
class ElasticDerivatives : public testing::Test {
  public:
    static constexpr ElasticModel kModel = Model::value;
    const LameParameters<double> lame = lame_parameters(kModel, 1.0, 0.4, false);
    const std::vector<DeformationCase> cases =
        deformation_cases(kModel != ElasticModel::NeoHookean);

    /// Step of the differences: the logarithm and the rotation change over the distance
    /// to J = 0 and to sigma_y + sigma_z = 0.
    static double step(const DeformationCase& c) {
        const double scale = kModel == ElasticModel::NeoHookean ? c.sigma[2]
                           : kModel == ElasticModel::FixedCorotated
                               ? c.sigma[1] + c.sigma[2]
                               : 1.0;
        return 2e-3 * std::min(1.0, scale);
    }
};
using Models =
    testing::Types<std::integral_constant<ElasticModel, ElasticModel::StableNeoHookean>,
                   std::integral_constant<ElasticModel, ElasticModel::NeoHookean>,
                   std::integral_constant<ElasticModel, ElasticModel::FixedCorotated>>;
TYPED_TEST_SUITE(ElasticDerivatives, Models);

/// Fourth-order central difference of f at 0; error ~ step^4.
template <class F>
auto derivative(F f, double h) {
    return ((8.0 * (f(h) - f(-h)) - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h)).eval();
}

TYPED_TEST(ElasticDerivatives, StressIsTheSlopeOfTheEnergy) {
    for (const DeformationCase& c : this->cases) {
        const Mat3d P = elastic_stress<TestFixture::kModel>(c.F, this->lame);
        Eigen::Matrix3d slope;
        for (int k = 0; k < 9; ++k) {
            const auto energy = [&](double t) {
                Mat3d F = c.F;
                F.a[k] += t;
                return Eigen::Matrix<double, 1, 1>(
                    elastic_energy<TestFixture::kModel>(F, this->lame));
            };
            slope(k / 3, k % 3) = derivative(energy, TestFixture::step(c))[0];
        }
        EXPECT_LT((slope - to_eigen(P)).norm(), 1e-8 * (1.0 + to_eigen(P).norm()))
            << c.name;
    }
}

TYPED_TEST(ElasticDerivatives, HessianIsTheSlopeOfTheStress) {
    for (const DeformationCase& c : this->cases) {
        const Matrix9 h = density_hessian<TestFixture::kModel>(c.F, this->lame, false);
        Matrix9 slope;
        for (int k = 0; k < 9; ++k) {
            const auto stress = [&](double t) {
                Mat3d F = c.F;
                F(k % 3, k / 3) += t;  // entry k of vec(F), columns stacked
                const Eigen::Matrix3d P =
                    to_eigen(elastic_stress<TestFixture::kModel>(F, this->lame));
                return Eigen::Matrix<double, 9, 1>(P.reshaped());
            };
            slope.col(k) = derivative(stress, TestFixture::step(c));
        }
        EXPECT_LT((slope - h).norm(), 1e-8 * (1.0 + h.norm())) << c.name;
    }
}

TYPED_TEST(ElasticDerivatives, TetGradientAndHessianMatchDifferencesOfPositions) {
    Random random(9);
    for (const DeformationCase& c : this->cases) {
        const Eigen::Matrix3d dm = random.matrix(0.3) + Eigen::Matrix3d::Identity();
        const TetShape<double> tet =
            tet_with(c.F, elastic_test::from_eigen(dm.inverse()), 0.7);
        const auto moved = [&tet](int k, double t) {
            TetShape<double> other = tet;
            other.x[k / 3][k % 3] += t;
            return other;
        };
        const auto stacked = [](const TetGradient<double>& g) {
            Eigen::Matrix<double, 12, 1> out;
            for (int k = 0; k < 12; ++k)
                out[k] = g.g[k / 3][k % 3];
            return out;
        };
        const double h = 0.3 * TestFixture::step(c);
        const auto gradient = stacked(tet_gradient<TestFixture::kModel>(tet, this->lame));
        const Matrix12 hessian =
            to_eigen(tet_hessian<TestFixture::kModel>(tet, this->lame, false));
        for (int k = 0; k < 12; ++k) {
            const auto energy = [&](double t) {
                return Eigen::Matrix<double, 1, 1>(
                    tet_energy<TestFixture::kModel>(moved(k, t), this->lame));
            };
            const auto slope = [&](double t) {
                return stacked(
                    tet_gradient<TestFixture::kModel>(moved(k, t), this->lame));
            };
            EXPECT_NEAR(
                derivative(energy, h)[0], gradient[k], 1e-8 * (1.0 + gradient.norm()))
                << c.name;
            EXPECT_LT((derivative(slope, h) - hessian.col(k)).norm(),
                      1e-8 * (1.0 + hessian.norm()))
                << c.name;
        }
    }
}

/// Deformations from rest volume down to a hundredth of it, across kCrushVolume.
std::vector<Mat3d> crushed_cases() {
    Random random(17);
    std::vector<Mat3d> out;
    for (const double J : {0.5, 0.102, 0.098, 0.05, 0.02, 0.01}) {
        const Eigen::Vector3d sigma(1.1, 0.7, J / 0.77);
        const Eigen::Matrix3d u =
            Eigen::HouseholderQR<Eigen::Matrix3d>(random.matrix(1.0)).householderQ();
        const Eigen::Matrix3d v =
            Eigen::HouseholderQR<Eigen::Matrix3d>(random.matrix(1.0)).householderQ();
        const Eigen::Matrix3d turn = u * v.transpose();
        const double sign = turn.determinant() > 0.0 ? 1.0 : -1.0;
        out.push_back(
            elastic_test::from_eigen(sign * u * sigma.asDiagonal() * v.transpose()));
    }
    return out;
}

TYPED_TEST(ElasticDerivatives, CrushedTetsMatchDifferencesOfPositions) {
    constexpr ElasticModel kLaw = TestFixture::kModel;
    const Eigen::Matrix3d rest = Eigen::Matrix3d::Identity();
    for (const Mat3d& F : crushed_cases()) {
        const TetShape<double> tet = tet_with(F, elastic_test::from_eigen(rest), 0.7);
        const auto moved = [&tet](int k, double t) {
            TetShape<double> other = tet;
            other.x[k / 3][k % 3] += t;
            return other;
        };
        const auto stacked = [](const TetGradient<double>& g) {
            Eigen::Matrix<double, 12, 1> out;
            for (int k = 0; k < 12; ++k)
                out[k] = g.g[k / 3][k % 3];
            return out;
        };
        const double h = 1e-3 * det(F);
        const auto gradient = stacked(tet_gradient<kLaw, true>(tet, this->lame));
        const Matrix12 hessian =
            to_eigen(tet_hessian<kLaw, true>(tet, this->lame, false));
        for (int k = 0; k < 12; ++k) {
            const auto energy = [&](double t) {
                return Eigen::Matrix<double, 1, 1>(
                    tet_energy<kLaw, true>(moved(k, t), this->lame));
            };
            const auto slope = [&](double t) {
                return stacked(tet_gradient<kLaw, true>(moved(k, t), this->lame));
            };
            EXPECT_NEAR(
                derivative(energy, h)[0], gradient[k], 1e-7 * (1.0 + gradient.norm()))
                << det(F);
            EXPECT_LT((derivative(slope, h) - hessian.col(k)).norm(),
                      1e-7 * (1.0 + hessian.norm()))
                << det(F);
        }
    }
}

TEST(CrushBarrier, JoinsSmoothlyAndForbidsInversion) {
    const LameParameters<double> lame{2.0, 3.0};
    const CrushBarrier<double> free = crush_barrier(kCrushVolume * (1.0 + 1e-9), lame);
    EXPECT_EQ(free.energy, 0.0);
    EXPECT_EQ(free.d1, 0.0);
    EXPECT_EQ(free.d2, 0.0);
    const CrushBarrier<double> near = crush_barrier(kCrushVolume * (1.0 - 1e-6), lame);
    EXPECT_GT(near.energy, 0.0);
    EXPECT_LT(near.d1, 0.0);
    EXPECT_GT(near.d2, 0.0);
    EXPECT_LT(near.d2, 1e-4);
    EXPECT_LT(crush_barrier(1e-6, lame).d1, -1e3);
    EXPECT_EQ(crush_barrier(0.0, lame).energy, HUGE_VAL);
    EXPECT_EQ(crush_barrier(-0.5, lame).energy, HUGE_VAL);
}

}  // namespace
}  // namespace noli
