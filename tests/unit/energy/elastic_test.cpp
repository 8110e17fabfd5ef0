// SPDX-License-Identifier: Apache-2.0
#include "energy/elastic.hpp"

#include "energy/tet.hpp"
#include "unit/energy/elastic_cases.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <cmath>
#include <type_traits>

namespace noli {
namespace {

using elastic_test::deformation_cases;
using elastic_test::density_hessian;
using elastic_test::from_eigen;
using elastic_test::Matrix12;
using elastic_test::Matrix9;
using elastic_test::Random;
using elastic_test::tet_with;
using elastic_test::to_eigen;

constexpr double kYoung = 2.5e6;
constexpr double kPoisson = 0.37;
constexpr double kMu = kYoung / (2.0 * (1.0 + kPoisson));
constexpr double kLambda =
    kYoung * kPoisson / ((1.0 + kPoisson) * (1.0 - 2.0 * kPoisson));

template <class Model>
class Elastic : public testing::Test {
  public:
    static constexpr ElasticModel kModel = Model::value;
    static constexpr bool kAllowsInversion = kModel != ElasticModel::NeoHookean;
    const LameParameters<double> lame = lame_parameters(kModel, kYoung, kPoisson, false);
};
using Models =
    testing::Types<std::integral_constant<ElasticModel, ElasticModel::StableNeoHookean>,
                   std::integral_constant<ElasticModel, ElasticModel::NeoHookean>,
                   std::integral_constant<ElasticModel, ElasticModel::FixedCorotated>>;
struct ModelName {
    template <class Model>
    static std::string GetName(int) {
        switch (Model::value) {
            case ElasticModel::StableNeoHookean:
                return "StableNeoHookean";
            case ElasticModel::NeoHookean:
                return "NeoHookean";
            default:
                return "FixedCorotated";
        }
    }
};
TYPED_TEST_SUITE(Elastic, Models, ModelName);

TYPED_TEST(Elastic, IsZeroWithoutStressAtRestAndUnderRotation) {
    Random random(1);
    for (int k = 0; k < 20; ++k) {
        const Mat3d F = k == 0 ? identity3() : from_eigen(random.rotation());
        EXPECT_NEAR(
            elastic_energy<TestFixture::kModel>(F, this->lame), 0.0, 4e-15 * kYoung);
        EXPECT_LT(to_eigen(elastic_stress<TestFixture::kModel>(F, this->lame)).norm(),
                  1e-14 * kYoung);
    }
}

TYPED_TEST(Elastic, DoesNotChangeUnderRigidMotionAndMaterialRotation) {
    Random random(2);
    for (const auto& c : deformation_cases(TestFixture::kAllowsInversion)) {
        const Eigen::Matrix3d q = random.rotation();
        const Mat3d turned = from_eigen(q * to_eigen(c.F));
        const Mat3d regrained = from_eigen(to_eigen(c.F) * q);
        const double psi = elastic_energy<TestFixture::kModel>(c.F, this->lame);
        const double tolerance = 1e-11 * (psi + kYoung);
        EXPECT_NEAR(
            elastic_energy<TestFixture::kModel>(turned, this->lame), psi, tolerance)
            << c.name;
        EXPECT_NEAR(
            elastic_energy<TestFixture::kModel>(regrained, this->lame), psi, tolerance)
            << c.name;

        const Eigen::Matrix3d stress =
            to_eigen(elastic_stress<TestFixture::kModel>(c.F, this->lame));
        const double stress_tolerance = 1e-11 * (stress.norm() + kYoung);
        EXPECT_LT((to_eigen(elastic_stress<TestFixture::kModel>(turned, this->lame))
                   - q * stress)
                      .norm(),
                  stress_tolerance)
            << c.name;
        EXPECT_LT((to_eigen(elastic_stress<TestFixture::kModel>(regrained, this->lame))
                   - stress * q)
                      .norm(),
                  stress_tolerance)
            << c.name;
    }
}

/// Sigma = 2 mu eps + lambda tr(eps) I, for the Hessian at rest applied to symmetric
/// strains.
template <ElasticModel M>
void expect_linear_elasticity(const LameParameters<double>& lame,
                              double mu,
                              double lambda) {
    const Matrix9 h = density_hessian<M>(identity3(), lame, false);
    Random random(3);
    for (int k = 0; k < 10; ++k) {
        const Eigen::Matrix3d a = random.matrix(1.0);
        const Eigen::Matrix3d strain = a + a.transpose();
        const Eigen::Matrix3d spin = a - a.transpose();
        const Eigen::Matrix3d want =
            2.0 * mu * strain + lambda * strain.trace() * Eigen::Matrix3d::Identity();
        const Eigen::Matrix3d got = (h * strain.reshaped()).reshaped(3, 3);
        EXPECT_LT((got - want).norm(), 1e-13 * want.norm());
        EXPECT_LT((h * spin.reshaped()).norm(), 1e-13 * want.norm());
    }
}

TYPED_TEST(Elastic, IsLinearElasticityInSmallStrains) {
    expect_linear_elasticity<TestFixture::kModel>(this->lame, kMu, kLambda);
}

TYPED_TEST(Elastic, HasYoungsModulusAndPoissonsRatioInAPullTest) {
    // with strains (e, -nu e, -nu e) the side stress vanishes and the axial stress is E e
    const double e = 1e-6;
    const auto axial_and_side = [&](double strain) {
        const Mat3d F{1.0 + strain,
                      0,
                      0,
                      0,
                      1.0 - kPoisson * strain,
                      0,
                      0,
                      0,
                      1.0 - kPoisson * strain};
        const Mat3d P = elastic_stress<TestFixture::kModel>(F, this->lame);
        return Eigen::Vector3d(P(0, 0), P(1, 1), P(2, 2));
    };
    const Eigen::Vector3d slope = (axial_and_side(e) - axial_and_side(-e)) / (2.0 * e);
    EXPECT_NEAR(slope[0], kYoung, 1e-8 * kYoung);
    EXPECT_NEAR(slope[1], 0.0, 1e-8 * kYoung);
    EXPECT_NEAR(slope[2], 0.0, 1e-8 * kYoung);
}

TEST(LameParameters, OfTheGipcProgramAreFourThirdsTooStiffInShear) {
    const LameParameters<double> compat =
        lame_parameters(ElasticModel::StableNeoHookean, kYoung, kPoisson, true);
    expect_linear_elasticity<ElasticModel::StableNeoHookean>(
        compat, 4.0 / 3.0 * kMu, kLambda - 0.5 * kMu);
}

TEST(LameParameters, IgnoreTheCompatibilitySwitchForOtherLaws) {
    for (ElasticModel model : {ElasticModel::NeoHookean, ElasticModel::FixedCorotated}) {
        const LameParameters<double> lame =
            lame_parameters(model, kYoung, kPoisson, true);
        EXPECT_DOUBLE_EQ(lame.mu, kMu);
        EXPECT_DOUBLE_EQ(lame.lambda, kLambda);
    }
}

TEST(NeoHookean, IsInfiniteAndWithoutNanWhenInverted) {
    constexpr ElasticModel kModel = ElasticModel::NeoHookean;
    const LameParameters<double> lame = lame_parameters(kModel, kYoung, kPoisson, false);
    Random random(4);
    for (double c : {0.0, -1e-12, -0.3, -2.0}) {
        Mat3d F{1.2, 0, 0, 0, 0.9, 0, 0, 0, c};
        if (c < 0.0) F = from_eigen(random.rotation() * to_eigen(F));
        EXPECT_EQ(elastic_energy<kModel>(F, lame), INFINITY);
        EXPECT_TRUE(to_eigen(elastic_stress<kModel>(F, lame)).allFinite());
        EXPECT_TRUE(density_hessian<kModel>(F, lame, true).allFinite());
        EXPECT_TRUE(to_eigen(cauchy_stress<kModel>(F, lame)).allFinite());
    }
}

TEST(FixedCorotated, HasAFinitePositiveHessianOnTheInvertedKink) {
    constexpr ElasticModel kModel = ElasticModel::FixedCorotated;
    const LameParameters<double> lame = lame_parameters(kModel, kYoung, kPoisson, false);
    for (const Vec3d& s : {Vec3d{1.0, 0.7, -0.7},
                           Vec3d{1.0, 1.0, -1.0},
                           Vec3d{1.0, 0.0, 0.0},
                           Vec3d{0.0, 0.0, 0.0}}) {
        const Mat3d F{s.x, 0, 0, 0, s.y, 0, 0, 0, s.z};
        const Matrix9 h = density_hessian<kModel>(F, lame, true);
        ASSERT_TRUE(h.allFinite());
        EXPECT_GE(Eigen::SelfAdjointEigenSolver<Matrix9>(h).eigenvalues().minCoeff(),
                  -1e-12 * h.norm());
    }
}

TYPED_TEST(Elastic, ProjectedHessianIsTheExactOneWithNegativeEigenvaluesClamped) {
    for (const auto& c : deformation_cases(TestFixture::kAllowsInversion)) {
        const Matrix9 exact =
            density_hessian<TestFixture::kModel>(c.F, this->lame, false);
        const Matrix9 projected =
            density_hessian<TestFixture::kModel>(c.F, this->lame, true);
        const Eigen::SelfAdjointEigenSolver<Matrix9> eigen(exact);
        const Matrix9 clamped = eigen.eigenvectors()
                              * eigen.eigenvalues().cwiseMax(0.0).asDiagonal()
                              * eigen.eigenvectors().transpose();
        EXPECT_LT((projected - clamped).norm(), 1e-11 * exact.norm()) << c.name;
    }
}

TYPED_TEST(Elastic, SomeCasesNeedTheProjection) {
    int indefinite = 0;
    for (const auto& c : deformation_cases(TestFixture::kAllowsInversion)) {
        const Matrix9 exact =
            density_hessian<TestFixture::kModel>(c.F, this->lame, false);
        const Eigen::SelfAdjointEigenSolver<Matrix9> eigen(exact);
        indefinite += eigen.eigenvalues().minCoeff() < -1e-3 * kYoung;
    }
    EXPECT_GT(indefinite, 5);
}

Mat3d random_shape(Random& random) {
    Eigen::Matrix3d dm = random.matrix(0.3) + Eigen::Matrix3d::Identity();
    return from_eigen((0.1 * dm).inverse());
}

TYPED_TEST(Elastic, TetHessianIsPositiveSemidefiniteWithRowsThatSumToZero) {
    Random random(5);
    for (const auto& c : deformation_cases(TestFixture::kAllowsInversion)) {
        const TetShape<double> tet = tet_with(c.F, random_shape(random), 0.02);
        const Matrix12 h = to_eigen(tet_hessian<TestFixture::kModel>(tet, this->lame));
        EXPECT_EQ((h - h.transpose()).norm(), 0.0) << c.name;
        EXPECT_GE(Eigen::SelfAdjointEigenSolver<Matrix12>(h).eigenvalues().minCoeff(),
                  -1e-14 * h.norm())
            << c.name;
        Eigen::Matrix<double, 12, 3> translation;
        for (int v = 0; v < 4; ++v)
            translation.middleRows<3>(3 * v).setIdentity();
        EXPECT_LT((h * translation).norm(), 1e-14 * h.norm()) << c.name;
    }
}

TYPED_TEST(Elastic, TetHessianIsTheDensityHessianThroughTheShapeFunctions) {
    Random random(6);
    for (const auto& c : deformation_cases(TestFixture::kAllowsInversion)) {
        const Mat3d dm_inv = random_shape(random);
        const TetShape<double> tet = tet_with(c.F, dm_inv, 0.02);
        // d vec(F) / d x, columns of F stacked
        Eigen::Matrix<double, 9, 12> b;
        for (int j = 0; j < 3; ++j) {
            for (int v = 1; v < 4; ++v)
                b.block<3, 3>(3 * j, 3 * v) =
                    dm_inv(v - 1, j) * Eigen::Matrix3d::Identity();
            b.block<3, 3>(3 * j, 0) = -(dm_inv(0, j) + dm_inv(1, j) + dm_inv(2, j))
                                    * Eigen::Matrix3d::Identity();
        }
        for (bool project : {true, false}) {
            const Mat3d F = deformation_gradient(tet.x, tet.dm_inv);
            const Matrix12 want =
                0.02 * b.transpose()
                * density_hessian<TestFixture::kModel>(F, this->lame, project) * b;
            const Matrix12 got =
                to_eigen(tet_hessian<TestFixture::kModel>(tet, this->lame, project));
            EXPECT_LT((got - want).norm(), 1e-11 * want.norm()) << c.name;
        }
    }
}

TYPED_TEST(Elastic, TetDerivativesAreBitwiseTheSeparateFunctions) {
    Random random(7);
    for (const auto& c : deformation_cases(true)) {
        const TetShape<double> tet = tet_with(c.F, random_shape(random), 0.02);
        const TetDerivatives<double> all =
            tet_derivatives<TestFixture::kModel>(tet, this->lame);
        EXPECT_EQ(all.energy, tet_energy<TestFixture::kModel>(tet, this->lame));
        const TetGradient<double> g = tet_gradient<TestFixture::kModel>(tet, this->lame);
        for (int v = 0; v < 4; ++v) {
            for (int i = 0; i < 3; ++i)
                EXPECT_EQ(all.gradient.g[v][i], g.g[v][i]);
        }
        EXPECT_EQ((to_eigen(all.hessian)
                   - to_eigen(tet_hessian<TestFixture::kModel>(tet, this->lame)))
                      .norm(),
                  0.0);
    }
}

TYPED_TEST(Elastic, CauchyStressIsSymmetricAndBalancesTheNominalStress) {
    for (const auto& c : deformation_cases(TestFixture::kAllowsInversion)) {
        const Eigen::Matrix3d cauchy =
            to_eigen(cauchy_stress<TestFixture::kModel>(c.F, this->lame));
        const double size = cauchy.norm() + kYoung;
        EXPECT_LT((cauchy - cauchy.transpose()).norm(), 1e-10 * size) << c.name;
        const Eigen::Matrix3d f = to_eigen(c.F);
        const Eigen::Matrix3d nominal =
            f.determinant() * cauchy * f.inverse().transpose();
        const Eigen::Matrix3d P =
            to_eigen(elastic_stress<TestFixture::kModel>(c.F, this->lame));
        EXPECT_LT((nominal - P).norm(), 1e-10 * (P.norm() + kYoung)) << c.name;
    }
}

TEST(VonMises, IsThePullInAPullTestAndIgnoresPressure) {
    EXPECT_DOUBLE_EQ(von_mises(Mat3d{5, 0, 0, 0, 0, 0, 0, 0, 0}), 5.0);
    EXPECT_DOUBLE_EQ(von_mises(Mat3d{-4, 0, 0, 0, -4, 0, 0, 0, -4}), 0.0);
    EXPECT_DOUBLE_EQ(von_mises(Mat3d{7, 0, 0, 0, 2, 0, 0, 0, 2}), 5.0);
    EXPECT_NEAR(von_mises(Mat3d{0, 2, 0, 2, 0, 0, 0, 0, 0}), 2.0 * std::sqrt(3.0), 1e-15);
}

TEST(DeformationGradient, IsTheLinearMapFromRestToNow) {
    Random random(8);
    const Mat3d F = from_eigen(random.matrix(2.0));
    const Mat3d dm_inv = random_shape(random);
    const TetShape<double> tet = tet_with(F, dm_inv, 1.0);
    EXPECT_LT((to_eigen(deformation_gradient(tet.x, dm_inv)) - to_eigen(F)).norm(),
              1e-13);
}

}  // namespace
}  // namespace noli
