// SPDX-License-Identifier: Apache-2.0
/// Supplement 3: Eqs. (5) to (10) as printed against the library's eigenvalues.
#include "energy/barrier.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace noli::test {
namespace {

template <class F>
void over_gaps(const F& f) {
    for (int i = 0; i <= 400; ++i) {
        f(std::pow(10.0, -8.0 + 8.0 * i / 401.0));
        f((i + 0.5) / 401.0);
    }
}

TEST(PaperEigenvalues, Equation5IsLambda1) {
    over_gaps([](double g) {
        const double L = std::log(g);
        const double printed =
            2.0 * (6.0 * g + 2.0 * g * L - 7.0 * g * g - 6.0 * g * g * L + 1.0) / g;
        // Near g = 1 the printed terms cancel: they are of size 1, the sum of size 1 - g.
        EXPECT_NEAR(barrier_lambda1(1, g), printed, 1e-13 * (1.0 + 1.0 / g)) << g;
    });
}

TEST(PaperEigenvalues, Equation6NeedsTheDenominatorG) {
    over_gaps([](double g) {
        const double numerator = -2.0 * (g - 1.0) * (g + 2.0 * g * std::log(g) - 1.0);
        const double exact = barrier_lambda23(1, g);
        EXPECT_NEAR(exact, numerator / g, 1e-13 * (1.0 + 1.0 / g)) << g;
        if (g < 0.9) {
            EXPECT_GT(std::fabs(numerator / (g * g) / exact - 1.0), 0.1) << g;
        }
    });
}

TEST(PaperEigenvalues, Equation9IsTheSlopeOfLambda1) {
    over_gaps([](double g) {
        const double printed =
            -2.0 * (13.0 * g * g - 2.0 * g + 6.0 * g * g * std::log(g) + 1.0) / (g * g);
        const double h = 1e-3 * std::fmin(g, 1.0 - g);
        const auto at = [&](double t) { return barrier_lambda1(1, g + t * h); };
        const double slope = (8.0 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12.0 * h);
        EXPECT_NEAR(slope / printed, 1.0, 1e-8) << g;
    });
}

TEST(PaperEigenvalues, OneIsPositiveAndFallsToZeroTheOthersAreNegative) {
    for (int r : {1, 2}) {
        double before = HUGE_VAL;
        for (int i = 1; i < 4000; ++i) {
            const double g = i / 4000.0;
            EXPECT_GT(barrier_lambda1(r, g), 0.0) << g;
            EXPECT_LT(barrier_lambda1(r, g), before) << g;
            EXPECT_LT(barrier_lambda23(r, g), 0.0) << g;
            before = barrier_lambda1(r, g);
        }
        EXPECT_LT(before, 0.01);
        EXPECT_GT(barrier_lambda1(r, 1e-12), 1e12);
    }
}

}  // namespace
}  // namespace noli::test
