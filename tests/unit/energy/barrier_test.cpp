// SPDX-License-Identifier: Apache-2.0
#include "energy/barrier.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace noli {
namespace {

struct LambdaRow {
    double g, lambda1_r1, lambda23_r1, lambda1_r2, lambda23_r2;
};

// MATH 1.3, six digits
constexpr LambdaRow kReference[] = {{1e-4, 19975.2, -20032.8, 448279, -368679},
                                    {0.01, 193.992, -214.256, 2653.10, -1889.39},
                                    {0.1, 24.1528, -24.4893, 190.873, -93.6906},
                                    {0.25, 15.1137, -8.65888, 61.8259, -18.2421},
                                    {0.5, 10.3863, -2.38629, 17.4376, -2.3472},
                                    {0.75, 5.60508, -0.454349, 3.47782, -0.178655},
                                    {0.9, 2.33867, -0.0643664, 0.506211, -0.00912302}};

TEST(Barrier, EigenvaluesMatchTheReferenceTable) {
    for (const LambdaRow& row : kReference) {
        const auto near = [&](double value, double reference) {
            EXPECT_NEAR(value, reference, 4e-6 * std::fabs(reference)) << "g = " << row.g;
        };
        near(barrier_lambda1(1, row.g), row.lambda1_r1);
        near(barrier_lambda23(1, row.g), row.lambda23_r1);
        near(barrier_lambda1(2, row.g), row.lambda1_r2);
        near(barrier_lambda23(2, row.g), row.lambda23_r2);
    }
}

TEST(Barrier, IsZeroOutsideTheBand) {
    for (int r : {1, 2}) {
        for (double d_sq : {1e-4, 1.0001e-4, 1.0}) {
            const BarrierJet b = barrier(r, d_sq, 1e-4);
            EXPECT_EQ(b.value, 0.0);
            EXPECT_EQ(b.d1, 0.0);
            EXPECT_EQ(b.d2, 0.0);
        }
    }
}

TEST(Barrier, IsInfiniteWithoutSlopeAtZeroDistance) {
    for (int r : {1, 2}) {
        const BarrierJet b = barrier(r, 0.0, 1e-4);
        EXPECT_TRUE(std::isinf(b.value) && b.value > 0.0);
        EXPECT_EQ(b.d1, 0.0);
        EXPECT_EQ(b.d2, 0.0);
        EXPECT_EQ(barrier_curvature(r, 0.0, 1e-2), 0.0);
    }
}

// The textbook derivatives in extended precision; they cancel, hence long double.
TEST(Barrier, MatchesExtendedPrecisionFromTinyGapsToTheBorder) {
    constexpr double kDhatSq = 1e-4;
    for (int r : {1, 2}) {
        for (double g :
             {1e-30, 1e-20, 1e-8, 0.01, 0.49, 0.51, 0.9, 0.999, 1 - 1e-6, 1 - 1e-9}) {
            const double d_sq = g * kDhatSq;
            const long double D = d_sq;
            const long double t = D - static_cast<long double>(kDhatSq);
            const long double L = log1pl(t / kDhatSq);
            const long double log_ratio = g > 0.5 ? L : logl(D / kDhatSq);
            const long double p = r == 1 ? -log_ratio : log_ratio * log_ratio;
            const long double dp = r == 1 ? -1 / D : 2 * log_ratio / D;
            const long double ddp = r == 1 ? 1 / (D * D) : 2 * (1 - log_ratio) / (D * D);
            const BarrierJet b = barrier(r, d_sq, kDhatSq);
            const auto near = [&](double value, long double reference) {
                EXPECT_LE(std::fabs(static_cast<double>(value / reference - 1)), 1e-14)
                    << "r = " << r << ", g = " << g;
            };
            near(b.value, t * t * p);
            near(b.d1, 2 * t * p + t * t * dp);
            near(b.d2, 2 * p + 4 * t * dp + t * t * ddp);
        }
    }
}

TEST(Barrier, DerivativesMatchCentralDifferences) {
    constexpr double kDhatSq = 1e-4;
    for (int r : {1, 2}) {
        for (double g : {1e-6, 1e-3, 0.1, 0.5, 0.9, 0.99}) {
            const double d_sq = g * kDhatSq;
            const double h = 1e-4 * std::fmin(d_sq, kDhatSq - d_sq);
            const BarrierJet b = barrier(r, d_sq, kDhatSq);
            const BarrierJet hi = barrier(r, d_sq + h, kDhatSq);
            const BarrierJet lo = barrier(r, d_sq - h, kDhatSq);
            EXPECT_NEAR((hi.value - lo.value) / (2 * h), b.d1, 1e-7 * std::fabs(b.d1))
                << g;
            EXPECT_NEAR((hi.d1 - lo.d1) / (2 * h), b.d2, 1e-7 * std::fabs(b.d2)) << g;
        }
    }
}

TEST(Barrier, EigenvaluesHaveTheirLimits) {
    const double g = 1e-12;
    EXPECT_NEAR(barrier_lambda1(1, g) * g, 2.0, 1e-9);
    EXPECT_NEAR(barrier_lambda1(2, g) * g / (4.0 * (2.0 - std::log(g))), 1.0, 1e-9);
    EXPECT_NEAR(barrier_lambda23(2, g) * g / (4.0 * std::log(g)), 1.0, 1e-9);
    const double gap = 1e-7;  // the next term is of relative size gap
    EXPECT_NEAR(barrier_lambda1(1, 1.0 - gap) / (24.0 * gap), 1.0, 1e-6);
    EXPECT_NEAR(barrier_lambda1(2, 1.0 - gap) / (48.0 * gap * gap), 1.0, 1e-6);
}

TEST(Barrier, KeepsSignsAndMonotonicityOverTheWholeBand) {
    for (int r : {1, 2}) {
        double previous = HUGE_VAL;
        for (double g = 1e-15; g < 1.0; g *= 1.01) {
            const double lambda1 = barrier_lambda1(r, g);
            EXPECT_GT(lambda1, 0.0) << g;
            EXPECT_LT(lambda1, previous) << g;
            EXPECT_LT(barrier_lambda23(r, g), 0.0) << g;
            previous = lambda1;
        }
    }
}

TEST(Barrier, CurvatureIsTheSecondDerivativeInDistance) {
    constexpr double kDhat = 1e-2;
    for (int r : {1, 2}) {
        for (double s : {0.01, 0.1, 0.5, 0.9}) {
            const double d = s * kDhat;
            const double h = 1e-4 * d;
            const double difference =
                (barrier_slope(r, d + h, kDhat) - barrier_slope(r, d - h, kDhat))
                / (2 * h);
            const double curvature = barrier_curvature(r, d, kDhat);
            EXPECT_NEAR(curvature, difference, 1e-6 * curvature) << s;
            EXPECT_NEAR(
                curvature, kDhat * kDhat * barrier_lambda1(r, s * s), 1e-12 * curvature);
        }
    }
}

TEST(Barrier, CapHoldsTheCurvatureBelowItsGapOnly) {
    constexpr double kDhat = 1e-2;
    constexpr double kCap = 1e-4;
    for (int r : {1, 2}) {
        const double at_cap = barrier_curvature(r, 1e-2 * kDhat, kDhat);
        EXPECT_NEAR(
            barrier_curvature(r, 1e-4 * kDhat, kDhat, kCap), at_cap, 1e-12 * at_cap);
        EXPECT_EQ(barrier_curvature(r, 0.3 * kDhat, kDhat, kCap),
                  barrier_curvature(r, 0.3 * kDhat, kDhat));
        EXPECT_GT(barrier_curvature(r, 1e-4 * kDhat, kDhat), 100 * at_cap);
    }
}

TEST(Barrier, SecondDerivativeForKappaIsTheJets) {
    EXPECT_EQ(barrier_second_derivative_d_sq(2, 3e-5, 1e-4), barrier(2, 3e-5, 1e-4).d2);
    // r = 1, MATH 8.2: -2 L - 4 t / D + t^2 / D^2 at g = 1/2
    EXPECT_NEAR(
        barrier_second_derivative_d_sq(1, 0.5, 1.0), 2 * std::log(2.0) + 4 + 1, 1e-14);
}

}  // namespace
}  // namespace noli
