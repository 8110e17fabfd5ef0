// SPDX-License-Identifier: Apache-2.0
#include "energy/mollified_pair.hpp"

#include "derivative/contact_oracle.hpp"

#include <gtest/gtest.h>

namespace noli::test {
namespace {

constexpr double kEps = 1e-3;
constexpr BarrierParams kParams{0.1, 5.0, 2, 0.0};
constexpr MollifiedHessian kModels[] = {
    MollifiedHessian::TwoMode, MollifiedHessian::FourMode, MollifiedHessian::Exact};
constexpr MollifiedCase kCases[] = {{PairKind::EdgeEdge, {0, 1, 2, 3}},
                                    {PairKind::PointEdge, {2, 0, 1, -1}},
                                    {PairKind::PointPoint, {1, 2, -1, -1}}};

TEST(Mollifier, RisesFromZeroToOneWithContinuousSlope) {
    EXPECT_EQ(mollifier(0.0, kEps).value, 0.0);
    EXPECT_EQ(mollifier(0.0, kEps).d1, 2.0 / kEps);
    EXPECT_EQ(mollifier(0.5 * kEps, kEps).value, 0.75);
    const MollifierJet inside = mollifier(kEps * (1 - 1e-12), kEps);
    EXPECT_NEAR(inside.value, 1.0, 1e-12);
    EXPECT_NEAR(inside.d1 * kEps, 0.0, 1e-11);
    for (double gamma : {kEps, 2 * kEps}) {
        const MollifierJet outside = mollifier(gamma, kEps);
        EXPECT_EQ(outside.value, 1.0);
        EXPECT_EQ(outside.d1, 0.0);
        EXPECT_EQ(outside.d2, 0.0);
    }
}

TEST(Mollifier, DerivativesMatchCentralDifferences) {
    for (double t : {0.01, 0.3, 0.7, 0.99}) {
        const double h = 1e-5 * kEps;
        const MollifierJet m = mollifier(t * kEps, kEps);
        const MollifierJet hi = mollifier(t * kEps + h, kEps);
        const MollifierJet lo = mollifier(t * kEps - h, kEps);
        EXPECT_NEAR((hi.value - lo.value) / (2 * h), m.d1, 1e-8 / kEps);
        EXPECT_NEAR((hi.d1 - lo.d1) / (2 * h), m.d2, 1e-8 / (kEps * kEps));
    }
}

TEST(Mollifier, ThresholdIsAThousandthOfTheSquaredLengths) {
    EXPECT_DOUBLE_EQ(edge_edge_threshold({2, 0, 0}, {0, 3, 0}), 0.036);
    EXPECT_EQ(mollifier(0.0, edge_edge_threshold({0, 0, 0}, {1, 0, 0})).value, 1.0);
}

TEST(MollifiedPair, IsZeroOutsideTheBand) {
    PairSampler sampler(1);
    for (const MollifiedCase& sub : kCases) {
        const Stencil<4> x = sampler.near_parallel(sub.kind, 0.01, 1.001 * kParams.dhat);
        EXPECT_EQ(mollified_energy(sub, x, kEps, kParams), 0.0);
        EXPECT_EQ(flat(mollified_gradient(sub, x, kEps, kParams).g).norm(), 0.0);
        for (MollifiedHessian model : kModels)
            EXPECT_EQ(mollified_hessian(model, sub, x, kEps, kParams).rank, 0);
    }
}

TEST(MollifiedPair, ForcesBalanceAndHaveNoTorque) {
    PairSampler sampler(2);
    for (const MollifiedCase& sub : kCases) {
        for (double s : {0.9, 0.3, 0.01}) {
            const Stencil<4> x = sampler.near_parallel(sub.kind, 0.01, s * kParams.dhat);
            const StencilGradient<4> g = mollified_gradient(sub, x, kEps, kParams);
            Vec3d force{0, 0, 0};
            Vec3d torque{0, 0, 0};
            double size = 0.0;
            for (int i = 0; i < 4; ++i) {
                force += g.g[i];
                torque += cross(x.x[i] - x.x[0], g.g[i]);
                size += norm(g.g[i]);
            }
            EXPECT_GT(size, 0.0);
            EXPECT_LE(norm(force), 1e-13 * size);
            EXPECT_LE(norm(torque), 1e-11 * size);
        }
    }
}

TEST(MollifiedPair, HessiansHaveNoStiffnessAgainstTranslation) {
    PairSampler sampler(3);
    for (const MollifiedCase& sub : kCases) {
        const Stencil<4> x = sampler.near_parallel(sub.kind, 0.01, 0.3 * kParams.dhat);
        for (MollifiedHessian model : kModels) {
            const auto H = dense(mollified_hessian(model, sub, x, kEps, kParams));
            Eigen::Matrix<double, 12, 3> shift;
            for (int i = 0; i < 4; ++i)
                shift.block<3, 3>(3 * i, 0).setIdentity();
            EXPECT_GT(H.norm(), 0.0);
            EXPECT_LE((H * shift).norm(), 1e-12 * H.norm());
        }
    }
}

TEST(MollifiedPair, OnlyTheSubCasesVerticesCarryTheDistance) {
    PairSampler sampler(4);
    const Stencil<4> x = sampler.near_parallel(PairKind::PointPoint, 0.01, 0.03);
    const PairGeometry<4> pair = mollified_geometry(kCases[2], x);
    EXPECT_EQ(pair.w[0], 0.0);
    EXPECT_EQ(pair.w[1], 1.0);
    EXPECT_EQ(pair.w[2], -1.0);
    EXPECT_EQ(pair.w[3], 0.0);
    EXPECT_NEAR(pair.d, 0.03, 1e-15);
}

TEST(MollifiedPair, StaysFiniteForParallelAndTouchingEdges) {
    for (double angle : {0.0, 1e-200, 1e-12, 1e-7}) {
        for (double d : {0.0, 1e-12, 0.05}) {
            const Stencil<4> x{{{0, 0, 0}, {1, 0, 0}, {0.5, 0, d}, {1.5, angle, d}}};
            const MollifiedCase subs[] = {{PairKind::EdgeEdge, {0, 1, 2, 3}},
                                          {PairKind::PointEdge, {2, 0, 1, -1}}};
            for (const MollifiedCase& sub : subs) {
                EXPECT_FALSE(std::isnan(mollified_energy(sub, x, kEps, kParams)));
                EXPECT_TRUE(
                    flat(mollified_gradient(sub, x, kEps, kParams).g).allFinite());
                for (MollifiedHessian model : kModels)
                    EXPECT_TRUE(dense(mollified_hessian(model, sub, x, kEps, kParams))
                                    .allFinite())
                        << "angle " << angle << ", d " << d << ", model " << int(model);
            }
        }
    }
}

}  // namespace
}  // namespace noli::test
