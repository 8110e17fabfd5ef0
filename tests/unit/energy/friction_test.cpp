// SPDX-License-Identifier: Apache-2.0
#include "derivative/contact_oracle.hpp"
#include "energy/friction_hessian.hpp"

#include <gtest/gtest.h>

namespace noli::test {
namespace {

constexpr double kEps = 1e-3;
constexpr BarrierParams kParams{1e-2, 1e8, 2, 0.0};

TEST(FrictionLaw, HasItsValuesAtTheBorders) {
    EXPECT_DOUBLE_EQ(friction_law(0.0, kEps).f0, kEps / 3);
    EXPECT_EQ(friction_law(0.0, kEps).f1, 0.0);
    EXPECT_EQ(friction_law(0.0, kEps).f1_over_y, 2.0 / kEps);
    EXPECT_EQ(friction_law(0.0, kEps).df1, 2.0 / kEps);
    const FrictionJet at = friction_law(kEps, kEps);
    const FrictionJet below = friction_law(kEps * (1 - 1e-15), kEps);
    EXPECT_EQ(at.f0, kEps);
    EXPECT_EQ(at.f1, 1.0);
    EXPECT_NEAR(below.f0, at.f0, 1e-17);
    EXPECT_NEAR(below.f1, at.f1, 1e-14);
    EXPECT_NEAR(below.f1_over_y * kEps, at.f1_over_y * kEps, 1e-14);
    EXPECT_NEAR(below.df1 * kEps, at.df1 * kEps, 1e-14);
}

TEST(FrictionLaw, DerivativesMatchCentralDifferences) {
    for (double t : {0.05, 0.5, 0.95, 1.5, 10.0}) {
        const double y = t * kEps;
        const double h = 1e-5 * kEps;
        const FrictionJet f = friction_law(y, kEps);
        const FrictionJet hi = friction_law(y + h, kEps);
        const FrictionJet lo = friction_law(y - h, kEps);
        EXPECT_NEAR((hi.f0 - lo.f0) / (2 * h), f.f1, 1e-9);
        EXPECT_NEAR((hi.f1 - lo.f1) / (2 * h) * kEps, f.df1 * kEps, 1e-9);
        EXPECT_NEAR(f.f1_over_y * y, f.f1, 1e-15);
    }
}

template <int S>
void expect_orthonormal(const FrictionBasis<S>& basis, const Vec3d& n) {
    EXPECT_NEAR(norm(basis.t0), 1.0, 1e-14);
    EXPECT_NEAR(norm(basis.t1), 1.0, 1e-14);
    EXPECT_NEAR(dot(basis.t0, basis.t1), 0.0, 1e-14);
    EXPECT_NEAR(dot(basis.t0, n), 0.0, 1e-14);
    EXPECT_NEAR(dot(basis.t1, n), 0.0, 1e-14);
}

TEST(FrictionBasis, IsOrthonormalAndAcrossTheNormal) {
    PairSampler sampler(1);
    for (int k = 0; k < 50; ++k) {
        const auto check = []<int S>(PairKind kind, const Stencil<S>& x) {
            const PairGeometry<S> pair = pair_geometry(kind, x);
            const FrictionBasis<S> basis = friction_basis(kind, x, kParams);
            expect_orthonormal(basis, pair.n);
            for (int i = 0; i < S; ++i)
                EXPECT_EQ(basis.w[i], pair.w[i]);
            if (S == 2) return;
            const Vec3d along =
                kind == PairKind::EdgeEdge ? x.x[1] - x.x[0] : x.x[2] - x.x[1];
            EXPECT_NEAR(dot(basis.t0, along), norm(along), 1e-12);
        };
        for_each_kind(sampler, 4e-3, 0.1, check);
    }
}

TEST(FrictionBasis, WorksForEveryNormal) {
    PairSampler sampler(2);
    const Vec3d normals[] = {{1, 0, 0},
                             {0, -1, 0},
                             {0, 0, 1},
                             {0.6, 0.8, 0},
                             {0, 0.6, -0.8},
                             normalized(Vec3d{1, 1e-9, 0}),
                             normalized(sampler.normal())};
    for (const Vec3d& n : normals) {
        expect_orthonormal(
            friction_basis<2>(PairKind::PointPoint, {{4e-3 * n, {0, 0, 0}}}, kParams), n);
        const Wall plane{n, 0.5};
        const FrictionBasis<1> basis = wall_friction_basis(0.504 * n, plane, kParams);
        expect_orthonormal(basis, n);
        EXPECT_EQ(basis.w[0], 1.0);
    }
}

TEST(FrictionBasis, NormalForceIsThatOfTheBarrier) {
    PairSampler sampler(3);
    const auto check = []<int S>(PairKind kind, const Stencil<S>& x) {
        // dE/dx_i = -lambda_N w_i n
        const StencilGradient<S> g = pair_gradient(kind, x, kParams);
        const PairGeometry<S> pair = pair_geometry(kind, x);
        const FrictionBasis<S> basis = friction_basis(kind, x, kParams);
        EXPECT_GT(basis.normal_force, 0.0);
        for (int i = 0; i < S; ++i)
            EXPECT_LE(norm(g.g[i] + (basis.normal_force * pair.w[i]) * pair.n),
                      1e-14 * basis.normal_force);
    };
    for_each_kind(sampler, 4e-3, 0.1, check);
    for_each_kind(sampler, 1.1e-2, 0.1, [](PairKind kind, auto x) {
        EXPECT_EQ(friction_basis(kind, x, kParams).normal_force, 0.0);
    });
}

TEST(FrictionBasis, OfMollifiedPairsUsesTheSubCaseAndTheMollifiedForce) {
    PairSampler sampler(4);
    const MollifiedCase subs[] = {{PairKind::EdgeEdge, {0, 1, 2, 3}},
                                  {PairKind::PointEdge, {2, 0, 1, -1}},
                                  {PairKind::PointPoint, {1, 2, -1, -1}}};
    for (const MollifiedCase& sub : subs) {
        const Stencil<4> x = sampler.near_parallel(sub.kind, 0.02, 4e-3);
        const PairGeometry<4> pair = mollified_geometry(sub, x);
        const FrictionBasis<4> basis = mollified_friction_basis(sub, x, 1e-3, kParams);
        expect_orthonormal(basis, pair.n);
        const double gamma = std::pow(std::sin(0.02), 2);
        const double m = 2 * gamma / 1e-3 - gamma * gamma / 1e-6;
        const double h = 1e-6;
        const auto b = [&](double d) {
            return kParams.kappa * barrier_of(2, d * d, kParams.dhat);
        };
        const double force = -m * (b(4e-3 + h) - b(4e-3 - h)) / (2 * h);
        EXPECT_NEAR(basis.normal_force / force, 1.0, 1e-6);
        for (int i = 0; i < 4; ++i)
            EXPECT_EQ(basis.w[i], pair.w[i]);
    }
}

TEST(Friction, AtRestHasOnlyItsConstantAndAnIsotropicHessian) {
    const Wall plane{{0, 0, 1}, 0.0};
    const FrictionBasis<1> basis = wall_friction_basis({0, 0, 4e-3}, plane, kParams);
    const Stencil<1> rest{{{0, 0, 0}}};
    const double force = 0.3 * basis.normal_force;
    EXPECT_DOUBLE_EQ(friction_energy(basis, rest, 0.3, kEps), force * kEps / 3);
    EXPECT_EQ(norm(friction_gradient(basis, rest, 0.3, kEps).g[0]), 0.0);
    const auto H = dense(friction_hessian(basis, rest, 0.3, kEps));
    const Eigen::Vector3d diagonal(2 * force / kEps, 2 * force / kEps, 0.0);
    EXPECT_LE((H - Eigen::Matrix3d(diagonal.asDiagonal())).norm(), 1e-14 * H.norm());
}

TEST(Friction, OpposesSlidingWithTheCoulombForce) {
    const Wall plane{{0, 0, 1}, 0.0};
    const FrictionBasis<1> basis = wall_friction_basis({0, 0, 4e-3}, plane, kParams);
    const Stencil<1> moved{
        {{3 * kEps, -4 * kEps, 7.0}}};  // the normal part does not count
    const Vec3d g = friction_gradient(basis, moved, 0.3, kEps).g[0];
    const double force = 0.3 * basis.normal_force;
    EXPECT_NEAR(g.x / force, 0.6, 1e-14);
    EXPECT_NEAR(g.y / force, -0.8, 1e-14);
    EXPECT_EQ(g.z, 0.0);
    EXPECT_EQ(friction_hessian(basis, moved, 0.3, kEps).rank, 1);
}

TEST(Friction, IgnoresCommonMotionAndBalances) {
    PairSampler sampler(5);
    const auto check = []<int S>(PairKind kind, const Stencil<S>& x) {
        const FrictionBasis<S> basis = friction_basis(kind, x, kParams);
        Stencil<S> together;
        for (Vec3d& u : together.x)
            u = {0.1, 0.2, -0.3};
        const double force = 0.5 * basis.normal_force;
        EXPECT_NEAR(friction_energy(basis, together, 0.5, kEps),
                    force * kEps / 3,
                    1e-9 * force * kEps);
        Stencil<S> slid{};
        slid.x[0] = 0.3 * kEps * basis.t0 + 0.4 * kEps * basis.t1;
        const StencilGradient<S> g = friction_gradient(basis, slid, 0.5, kEps);
        Vec3d sum{0, 0, 0};
        for (const Vec3d& one : g.g)
            sum += one;
        EXPECT_GT(norm(g.g[0]), 0.1 * force);
        EXPECT_LE(norm(sum), 1e-13 * norm(g.g[0]));
    };
    for_each_kind(sampler, 4e-3, 0.1, check);
}

TEST(Friction, VanishesWithoutCoefficientOrForce) {
    const Wall plane{{0, 0, 1}, 0.0};
    const Stencil<1> moved{{{0.2 * kEps, 0, 0}}};
    const FrictionBasis<1> pressed = wall_friction_basis({0, 0, 4e-3}, plane, kParams);
    const FrictionBasis<1> apart = wall_friction_basis({0, 0, 2e-2}, plane, kParams);
    EXPECT_EQ(friction_energy(pressed, moved, 0.0, kEps), 0.0);
    EXPECT_EQ(friction_hessian(pressed, moved, 0.0, kEps).rank, 0);
    EXPECT_EQ(friction_energy(apart, moved, 0.3, kEps), 0.0);
    EXPECT_EQ(friction_hessian(apart, moved, 0.3, kEps).rank, 0);
}

}  // namespace
}  // namespace noli::test
