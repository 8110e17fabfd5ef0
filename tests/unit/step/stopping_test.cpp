// SPDX-License-Identifier: Apache-2.0
/// What may end a minimisation, and what the next Hessian is.
#include "contact/gap_change.hpp"
#include "objective/friction_forces.hpp"
#include "step/projection.hpp"

#include <gtest/gtest.h>

namespace noli {
namespace {

TEST(GapChange, IsRelativeToTheGapAndIgnoresRoundingOfTheCoordinates) {
    EXPECT_NEAR(detail::relative_change(1e-4, 1.1e-4, 1.0), 0.1, 1e-12);
    EXPECT_NEAR(detail::relative_change(1e-4, 0.5e-4, 1.0), 0.5, 1e-12);
    // A gap of 1e-9 m a thousand kilometres from the origin cannot be told any better.
    EXPECT_EQ(detail::relative_change(1e-9, 5e-9, 1e6), 0.0);
    EXPECT_GT(detail::relative_change(1e-9, 5e-9, 1.0), 3.9);
}

TEST(FrictionChange, IsTheLargestOfTheBodiesThatCount) {
    EXPECT_EQ(friction_change({0.0, 0.0}, {0.0, 0.0}), 0.0);
    EXPECT_NEAR(friction_change({1.0, 2.0}, {1.0, 1.5}), 0.25, 1e-15);
    EXPECT_NEAR(friction_change({0.0, 2.0}, {1.0, 2.0}), 1.0, 1e-15);
    // A body with a ten-thousandth of the largest friction has no say.
    EXPECT_EQ(friction_change({1e-4, 2.0}, {2e-4, 2.0}), 0.0);
}

TEST(ProjectionOnDemand, TriesTheExactHessianAfterFullStepsOnly) {
    ProjectionOnDemand projection;
    projection.begin(false);
    EXPECT_FALSE(projection.exact());
    projection.took(0.5, false);
    EXPECT_FALSE(projection.exact());
    projection.took(1.0, true);
    EXPECT_FALSE(projection.exact());
    projection.took(1.0, false);
    EXPECT_TRUE(projection.exact());
    projection.begin(true);
    projection.took(1.0, false);
    EXPECT_FALSE(projection.exact());
}

TEST(ProjectionOnDemand, WaitsLongerAfterEachBreakdown) {
    ProjectionOnDemand projection;
    projection.begin(false);
    int last = 0;
    for (int breakdown = 0; breakdown < 4; ++breakdown) {
        int waits = 0;
        projection.took(1.0, false);
        while (!projection.exact()) {
            ++waits;
            projection.took(1.0, false);
        }
        projection.broke_down();
        if (breakdown > 0) EXPECT_GT(waits, last);
        last = waits;
    }
}

}  // namespace
}  // namespace noli
