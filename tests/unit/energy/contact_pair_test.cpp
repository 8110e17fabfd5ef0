// SPDX-License-Identifier: Apache-2.0
#include "energy/contact_pair.hpp"

#include "derivative/contact_oracle.hpp"

#include <gtest/gtest.h>

namespace noli::test {
namespace {

constexpr BarrierParams kParams{1e-2, 5.0, 2, 0.0};
constexpr ContactHessian kModels[] = {
    ContactHessian::GaussNewton, ContactHessian::GaussNewtonPlus, ContactHessian::Exact};

TEST(ContactPair, IsZeroOutsideTheBand) {
    PairSampler sampler(1);
    for_each_kind(
        sampler, 1.001 * kParams.dhat, 0.1, []<int S>(PairKind kind, Stencil<S> x) {
            EXPECT_EQ(pair_energy(kind, x, kParams), 0.0);
            EXPECT_EQ(flat(pair_gradient(kind, x, kParams).g).norm(), 0.0);
            for (ContactHessian model : kModels)
                EXPECT_EQ(pair_hessian(model, kind, x, kParams).rank, 0);
        });
}

TEST(ContactPair, ForcesBalanceAndHaveNoTorque) {
    PairSampler sampler(2);
    for (double s : {0.9, 0.1, 1e-3}) {
        const auto check = []<int S>(PairKind kind, const Stencil<S>& x) {
            const StencilGradient<S> g = pair_gradient(kind, x, kParams);
            Vec3d force{0, 0, 0};
            Vec3d torque{0, 0, 0};
            double size = 0.0;
            for (int i = 0; i < S; ++i) {
                force += g.g[i];
                torque += cross(x.x[i] - x.x[0], g.g[i]);
                size += norm(g.g[i]);
            }
            EXPECT_GT(size, 0.0);
            EXPECT_LE(norm(force), 1e-13 * size);
            EXPECT_LE(norm(torque), 1e-13 * size);
        };
        for_each_kind(sampler, s * kParams.dhat, 0.1, check);
    }
}

TEST(ContactPair, PushesTheSidesApart) {
    const Stencil<4> x{{{0.2, 0.2, 5e-3}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    const StencilGradient<4> g = pair_gradient(PairKind::PointTriangle, x, kParams);
    EXPECT_LT(g.g[0].z, 0.0);  // the force is minus the gradient
    EXPECT_GT(g.g[1].z, 0.0);
}

template <int S>
Stencil<S> rotated(const Stencil<S>& x, const Mat3d& R, const Vec3d& shift) {
    Stencil<S> out;
    for (int i = 0; i < S; ++i)
        out.x[i] = R * x.x[i] + shift;
    return out;
}

TEST(ContactPair, IsUnchangedByRigidMotion) {
    PairSampler sampler(3);
    const Vec3d e0 = normalized(sampler.normal());
    const Vec3d e1 = sampler.unit_across(e0);
    const Mat3d R = from_columns(e0, e1, cross(e0, e1));
    const auto check = [&]<int S>(PairKind kind, const Stencil<S>& x) {
        const Stencil<S> y = rotated(x, R, {0.3, -0.2, 0.1});
        EXPECT_NEAR(
            pair_energy(kind, y, kParams) / pair_energy(kind, x, kParams), 1.0, 1e-11);
        StencilGradient<S> g = pair_gradient(kind, x, kParams);
        for (Vec3d& one : g.g)
            one = R * one;
        EXPECT_LE(relative_error(flat(pair_gradient(kind, y, kParams).g), flat(g.g)),
                  1e-11);
        for (ContactHessian model : kModels) {
            auto modes = pair_hessian(model, kind, x, kParams);
            for (auto& q : modes.q)
                for (Vec3d& one : q)
                    one = R * one;
            const auto there = pair_hessian(model, kind, y, kParams);
            EXPECT_LE(relative_error(dense(there), dense(modes)), 1e-10);
            // no stiffness against translation
            for (int k = 0; k < there.rank; ++k) {
                Vec3d sum{0, 0, 0};
                for (const Vec3d& one : there.q[k])
                    sum += one;
                EXPECT_LE(norm(sum), 1e-12 * flat(there.q[k]).norm());
            }
        }
    };
    for (double s : {0.9, 0.3, 0.05})
        for_each_kind(sampler, s * kParams.dhat, 0.1, check);
}

TEST(ContactPair, GaussNewtonPlusStiffensMotionsThatKeepTheDistance) {
    PairSampler sampler(4);
    const auto check = []<int S>(PairKind kind, const Stencil<S>& x) {
        const auto gn =
            dense(pair_hessian(ContactHessian::GaussNewton, kind, x, kParams));
        const auto plus =
            dense(pair_hessian(ContactHessian::GaussNewtonPlus, kind, x, kParams));
        const Eigen::SelfAdjointEigenSolver<std::decay_t<decltype(gn)>> eigen(plus - gn);
        EXPECT_GE(eigen.eigenvalues()[0], -1e-12 * plus.norm());
        int stiffened = 0;
        for (int i = 0; i < 3 * S; ++i)
            stiffened += eigen.eigenvalues()[i] > 1e-8 * plus.norm() ? 1 : 0;
        EXPECT_EQ(stiffened, S - 2);
    };
    for_each_kind(sampler, 0.1 * kParams.dhat, 0.1, check);
}

TEST(ContactPair, CapLimitsGaussNewtonButNotTheForce) {
    PairSampler sampler(5);
    BarrierParams capped = kParams;
    capped.curvature_cap = 1e-4;
    const Stencil<4> x = sampler.point_triangle(1e-4 * kParams.dhat, 0.1);
    const auto norm_of = [&](const BarrierParams& params) {
        return dense(pair_hessian(
                         ContactHessian::GaussNewton, PairKind::PointTriangle, x, params))
            .norm();
    };
    EXPECT_GT(norm_of(kParams), 100 * norm_of(capped));
    EXPECT_EQ(flat(pair_gradient(PairKind::PointTriangle, x, kParams).g),
              flat(pair_gradient(PairKind::PointTriangle, x, capped).g));
}

/// Shapes on the verge of collapse, or collapsed.
template <int S>
void expect_finite(PairKind kind, const Stencil<S>& x) {
    for (ContactHessian model : kModels) {
        const auto modes = pair_hessian(model, kind, x, kParams);
        EXPECT_LE(modes.rank, max_rank(kind, model));
        EXPECT_TRUE(dense(modes).allFinite()) << "kind " << int(kind);
    }
    EXPECT_TRUE(flat(pair_gradient(kind, x, kParams).g).allFinite());
    EXPECT_FALSE(std::isnan(pair_energy(kind, x, kParams)));
}

TEST(ContactPair, StaysFiniteForCollapsingShapes) {
    for (double thin : {1e-3, 1e-6, 1e-9, 1e-13, 1e-200, 0.0}) {
        SCOPED_TRACE(thin);
        expect_finite<4>(
            PairKind::PointTriangle,
            {{{0.3, 0.1 * thin, 5e-3}, {0, 0, 0}, {1, 0, 0}, {0.4, thin, 0}}});
        expect_finite<4>(PairKind::EdgeEdge,
                         {{{0, 0, 0}, {1, 0, 0}, {0.5, -thin, 5e-3}, {0.6, thin, 5e-3}}});
        expect_finite<4>(PairKind::EdgeEdge,
                         {{{-thin, 0, 0}, {thin, 0, 0}, {0, -1, 5e-3}, {0, 1, 5e-3}}});
        expect_finite<3>(PairKind::PointEdge,
                         {{{0, 0, 5e-3}, {-thin, 0, 0}, {thin, 0, 0}}});
        expect_finite<2>(PairKind::PointPoint, {{{0, 0, thin}, {0, 0, 0}}});
    }
}

TEST(ContactPair, KeepsItsAccuracyAtTinyGaps) {
    // 1e-9 of the edge length: r / |r| would keep only a few digits of the normal
    const Stencil<4> x{{{0.3, 0.2, 1e-9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    const double slope = kParams.kappa * barrier_slope(2, 1e-9, kParams.dhat);
    const StencilGradient<4> g = pair_gradient(PairKind::PointTriangle, x, kParams);
    EXPECT_NEAR(g.g[0].z / slope, 1.0, 1e-14);
    EXPECT_NEAR(g.g[1].z / slope, -0.5, 1e-14);
    EXPECT_EQ(g.g[0].x, 0.0);
}

TEST(ContactPair, RanksAreThoseOfTheTheory) {
    EXPECT_EQ(max_rank(PairKind::EdgeEdge, ContactHessian::GaussNewton), 1);
    EXPECT_EQ(max_rank(PairKind::PointPoint, ContactHessian::Exact), 1);
    EXPECT_EQ(max_rank(PairKind::PointEdge, ContactHessian::GaussNewtonPlus), 2);
    EXPECT_EQ(max_rank(PairKind::PointTriangle, ContactHessian::Exact), 3);
}

}  // namespace
}  // namespace noli::test
