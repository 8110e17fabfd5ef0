// SPDX-License-Identifier: Apache-2.0
/// The primal-dual Hessian of friction: exact where the force direction has settled,
/// positive semi-definite for every admissible one.
#include "energy/friction_hessian.hpp"

#include "derivative/contact_oracle.hpp"

#include <gtest/gtest.h>

#include <random>

namespace noli::test {
namespace {

constexpr double kEps = 1e-3;

/// K / (mu lambda_N) of a point on a plane, in the basis of its tangents, dense.
Eigen::Matrix2d bracket(const Vec2d& u, const Vec2d& w) {
    FrictionBasis<1> basis{{1, 0, 0}, {0, 1, 0}, {1.0}, 1.0};
    const Stencil<1> moved{{{u.x, u.y, 0.3}}};
    const auto K = dense(friction_hessian(basis, moved, w, 1.0, kEps));
    EXPECT_EQ(K.col(2).norm(), 0.0);
    return K.topLeftCorner(2, 2);
}

Eigen::Vector2d force(const Vec2d& u) {
    const Vec2d w = settled_dual(u, kEps);
    return {w.x, w.y};
}

TEST(FrictionRatio, SlopeMatchesCentralDifferences) {
    for (double y : {0.01, 0.3, 0.9, 1.2, 7.0}) {
        const double h = 1e-6 * kEps;
        const double slope = (friction_ratio(y * kEps + h, kEps).rho
                              - friction_ratio(y * kEps - h, kEps).rho)
                           / (2 * h);
        EXPECT_NEAR(friction_ratio(y * kEps, kEps).drho, slope, 1e-6) << y;
        EXPECT_NEAR(friction_ratio(y * kEps, kEps).rho,
                    y * kEps / friction_law(y * kEps, kEps).f1,
                    1e-15);
    }
}

TEST(PrimalDualFriction, IsTheSlopeOfTheForceWhereItsDirectionHasSettled) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> angle(0.0, 6.28);
    for (double y : {0.01, 0.3, 0.9, 1.2, 7.0}) {
        const double a = angle(random);
        const Vec2d u{y * kEps * std::cos(a), y * kEps * std::sin(a)};
        const double h = 1e-5 * kEps;
        Eigen::Matrix2d slope;
        slope.col(0) = (force({u.x + h, u.y}) - force({u.x - h, u.y})) / (2 * h);
        slope.col(1) = (force({u.x, u.y + h}) - force({u.x, u.y - h})) / (2 * h);
        const Eigen::Matrix2d K = bracket(u, settled_dual(u, kEps));
        EXPECT_LE((K - slope).norm() / slope.norm(), 1e-7) << y;
    }
}

TEST(PrimalDualFriction, HasTheEliminatedForm) {
    // K = [I - rho'/2 (w n^T + n w^T)] / rho, symmetric part of the eliminated system.
    std::mt19937 random(2);
    std::uniform_real_distribution<double> one(-1.0, 1.0);
    for (int k = 0; k < 200; ++k) {
        const Vec2d u{3 * kEps * one(random), 3 * kEps * one(random)};
        const Eigen::Vector2d w =
            Eigen::Vector2d(one(random), one(random)) / std::sqrt(2.0);
        const FrictionRatio ratio = friction_ratio(detail::hypot2(u.x, u.y), kEps);
        const Eigen::Vector2d n = Eigen::Vector2d(u.x, u.y).normalized();
        const Eigen::Matrix2d outer = w * n.transpose() + n * w.transpose();
        const Eigen::Matrix2d expected =
            (Eigen::Matrix2d::Identity() - 0.5 * ratio.drho * outer) / ratio.rho;
        EXPECT_LE((bracket(u, {w.x(), w.y()}) - expected).norm(),
                  1e-12 * expected.norm());
    }
}

TEST(PrimalDualFriction, IsPositiveSemiDefiniteForEveryAdmissibleDual) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> one(0.0, 1.0);
    for (int k = 0; k < 20000; ++k) {
        const double a = 6.28 * one(random);
        const double b = 6.28 * one(random);
        const double y = 4 * kEps * one(random);
        const double size = one(random);
        const FrictionRatio ratio = friction_ratio(y, kEps);
        const detail::SlipSpectrum spectrum = detail::slip_spectrum(
            {size * std::cos(a), size * std::sin(a)}, {std::cos(b), std::sin(b)});
        for (const double value : {spectrum.value0, spectrum.value1})
            EXPECT_GE(1.0 - 0.5 * ratio.drho * value, -1e-15);
    }
}

TEST(NextDual, FollowsTheLinearisedSystemBackAndTheLawOutwards) {
    const Vec2d u0{2 * kEps, 0.0};
    const Vec2d settled = settled_dual(u0, kEps);
    // Outwards: what belongs to the new slip.
    const Vec2d out = next_dual(settled, u0, {3 * kEps, kEps}, kEps);
    const Vec2d law = settled_dual({3 * kEps, kEps}, kEps);
    EXPECT_EQ(out.x, law.x);
    EXPECT_EQ(out.y, law.y);
    // Straight back through the kink: the direction turns only as far as |w| allows.
    const Vec2d back = next_dual(settled, u0, {-0.1 * kEps, 0.0}, kEps);
    EXPECT_LE(std::fabs(back.x), friction_law(0.1 * kEps, kEps).f1 * (1 + 1e-12));
    EXPECT_EQ(back.y, 0.0);
    // Linearised and not cut short: rho w = u to first order in the step.
    const Vec2d u1{1.9 * kEps, 0.02 * kEps};
    const Vec2d near = next_dual({0.3, 0.4}, u0, u1, kEps);
    const FrictionRatio ratio = friction_ratio(2 * kEps, kEps);
    const double along = ratio.drho * (u1.x - u0.x);
    EXPECT_NEAR(near.x, (u1.x - along * 0.3) / ratio.rho, 1e-12);
    EXPECT_NEAR(near.y, (u1.y - along * 0.4) / ratio.rho, 1e-12);
}

}  // namespace
}  // namespace noli::test
