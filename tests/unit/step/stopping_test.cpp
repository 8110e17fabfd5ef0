// SPDX-License-Identifier: Apache-2.0
/// What may end a minimisation, and what the next Hessian is.
#include "contact/gap_change.hpp"
#include "exec/cpu.hpp"
#include "objective/friction_forces.hpp"
#include "step/force_change.hpp"
#include "step/projection.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace noli {
namespace {

TEST(GapChange, IsRelativeToTheGapAndIgnoresRoundingOfTheCoordinates) {
    EXPECT_NEAR(detail::relative_change(1e-4, 1.1e-4, 1.0), 0.1, 1e-12);
    EXPECT_NEAR(detail::relative_change(1e-4, 0.5e-4, 1.0), 0.5, 1e-12);
    // A gap of 1e-9 m a thousand kilometres from the origin cannot be told any better.
    EXPECT_EQ(detail::relative_change(1e-9, 5e-9, 1e6), 0.0);
    EXPECT_GT(detail::relative_change(1e-9, 5e-9, 1.0), 3.9);
}

TEST(ForceChange, IsRelativeToTheLargestForceOfAll) {
    SerialExec exec;
    GapChangeWork<SerialExec> work;
    const auto change = [&](const std::vector<double>& before,
                            const std::vector<double>& after) {
        exec.upload(before, work.before);
        exec.upload(after, work.after);
        return force_change_later(exec, work, 2, 1e-3, 0.0).value(exec);
    };
    const auto force = [](double gap) { return -barrier_slope(2, gap, 1e-3); };
    // Alone, a pair near dhat is what counts.
    EXPECT_NEAR(change({8e-4}, {8.2e-4}), 1.0 - force(8.2e-4) / force(8e-4), 1e-12);
    EXPECT_GT(change({8e-4}, {8.2e-4}), 0.2);
    // Beside one that carries much it is not.
    EXPECT_LT(change({8e-4, 1e-4}, {8.2e-4, 1e-4}), 1e-2);
    EXPECT_EQ(change({8e-4}, {1.2e-3}), 1.0);
    EXPECT_EQ(change({1.1e-3}, {1.2e-3}), 0.0);
    EXPECT_EQ(change({}, {}), 0.0);
    EXPECT_EQ(force_change_later(exec, work, 2, 1e-3, 0.0).value(exec, 1.0), 0.0);
}

double change(const std::vector<double>& before, const std::vector<double>& after) {
    SerialExec exec;
    const int n = static_cast<int>(before.size());
    return friction_change(
        exec, View<const double>{before.data(), n}, View<const double>{after.data(), n});
}

TEST(FrictionChange, IsTheLargestOfTheBodiesThatCount) {
    EXPECT_EQ(change({0.0, 0.0}, {0.0, 0.0}), 0.0);
    EXPECT_NEAR(change({1.0, 2.0}, {1.0, 1.5}), 0.25, 1e-15);
    EXPECT_NEAR(change({0.0, 2.0}, {1.0, 2.0}), 1.0, 1e-15);
    // A body with a ten-thousandth of the largest friction has no say.
    EXPECT_EQ(change({1e-4, 2.0}, {2e-4, 2.0}), 0.0);
}

TEST(FrictionOfBodies, AddsUpTheTermsOfEachWhateverTheirNumber) {
    // Body b has vertices 2b and 2b + 1; the last body touches nothing.
    constexpr int kBodies = 7;
    std::vector<int> body(2 * kBodies);
    for (std::size_t v = 0; v < body.size(); ++v)
        body[v] = static_cast<int>(v) / 2;
    for (const int count : {0, 1, 63, 64, 65, 1000}) {
        std::vector<FrictionTerm> terms(static_cast<std::size_t>(count));
        std::vector<double> expected(kBodies, 0.0);
        for (int i = 0; i < count; ++i) {
            FrictionTerm& term = terms[static_cast<std::size_t>(i)];
            const int a = (i * i) % 5;
            const int b = i % 3 == 0 ? -1 : (i + a) % 6;
            term.v[0] = 2 * a;
            term.v[1] = b < 0 ? -1 : 2 * b + 1;
            term.v[2] = term.v[3] = -1;
            term.mu = 0.5;
            term.basis.normal_force = 1.0 + i;
            expected[static_cast<std::size_t>(a)] += 0.5 * (1.0 + i);
            if (b >= 0) expected[static_cast<std::size_t>(b)] += 0.5 * (1.0 + i);
        }
        SerialExec exec;
        FrictionOfBodies<SerialExec> friction;
        std::vector<double> found(kBodies, -1.0);
        friction.sum(exec,
                     View<const FrictionTerm>{terms.data(), count},
                     View<const int>{body.data(), static_cast<int>(body.size())},
                     View<double>{found.data(), kBodies});
        for (std::size_t b = 0; b < found.size(); ++b)
            EXPECT_NEAR(found[b], expected[b], 1e-12 * (1.0 + expected[b]))
                << count << " terms, body " << b;
    }
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
        if (breakdown > 0) {
            EXPECT_GT(waits, last);
        }
        last = waits;
    }
}

}  // namespace
}  // namespace noli
