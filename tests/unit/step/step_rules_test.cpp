// SPDX-License-Identifier: Apache-2.0
/// The small rules that a Newton step is made of.

#include "exec/cpu.hpp"
#include "step/adaptive_law.hpp"
#include "step/boundary_pace.hpp"
#include "step/boundary_path.hpp"
#include "step/integrator.hpp"
#include "step/line_search.hpp"
#include "step/stiffness.hpp"
#include "step/trouble.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace noli {
namespace {

IterationRecord iteration(double step, bool boundary_moved) {
    IterationRecord record;
    record.step = step;
    record.boundary_moved = boundary_moved;
    return record;
}

TEST(LineSearch, LetsTheEnergyFallAndNotRise) {
    LineSearch search{.energy_before = 1.0, .slope = -1.0};
    EXPECT_TRUE(search.accepts(1.0, 1.0));
    EXPECT_TRUE(search.accepts(0.5, 1.0));
    EXPECT_FALSE(search.accepts(1.0 + 1e-9, 1.0));
    EXPECT_FALSE(search.noise_accepted);
}

TEST(LineSearch, NeverTakesAnInfiniteEnergyNotEvenWhileTheBoundaryMoves) {
    LineSearch search{.energy_before = 1.0, .slope = -1.0, .may_rise = true};
    EXPECT_TRUE(search.accepts(2.0, 1.0));
    EXPECT_FALSE(search.accepts(HUGE_VAL, 1.0));
    EXPECT_FALSE(search.accepts(std::nan(""), 1.0));
}

TEST(LineSearch, CallsARiseNoiseOnlyIfTheExpectedChangeIsNoiseToo) {
    LineSearch expected_change{.energy_before = 1.0, .slope = -1e-3};
    EXPECT_FALSE(expected_change.accepts(1.0 + 1e-14, 1.0));
    LineSearch none{.energy_before = 1.0, .slope = -1e-14};
    EXPECT_TRUE(none.accepts(1.0 + 1e-14, 1.0));
    EXPECT_TRUE(none.noise_accepted);
    EXPECT_FALSE(none.accepts(1.0 + 1e-9, 1.0));
}

TEST(BoundaryPace, WaitsAfterAMoveThatWasCutShort) {
    BoundaryPace pace;
    EXPECT_TRUE(pace.moves());
    pace.add(iteration(1.0, true));
    EXPECT_TRUE(pace.moves());
    pace.add(iteration(0.1, true));
    EXPECT_FALSE(pace.moves());
    pace.add(iteration(0.2, false));
    EXPECT_FALSE(pace.moves());
    pace.add(iteration(0.9, false));  // relaxed
    EXPECT_TRUE(pace.moves());
}

TEST(BoundaryPace, IsBlockedAfterSixShortMoves) {
    BoundaryPace pace;
    for (int k = 0; k < 6; ++k) {
        EXPECT_FALSE(pace.blocked());
        pace.add(iteration(0.1, true));
        pace.add(iteration(1.0, false));
    }
    EXPECT_TRUE(pace.blocked());
}

TEST(BoundaryPace, SolvesMovingSystemsMoreExactlyButNotWithoutEnd) {
    BoundaryPace pace;
    EXPECT_EQ(pace.tolerance(1e-4, false), 1e-4);
    EXPECT_LT(pace.tolerance(1e-4, true), 1e-4);
    int retries = 0;
    while (pace.retry_more_exactly())
        ASSERT_LT(++retries, 10);
    EXPECT_GT(retries, 0);
    EXPECT_GE(pace.tolerance(1e-4, true), 1e-20);
}

TEST(BoundaryPath, GoesLegByLegToTheEnd) {
    std::vector<Vec3d> points{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
    BoundaryPath path({points.data(), 4}, 2);
    EXPECT_EQ(path.target().size, 2);
    EXPECT_EQ(path.target()[1].x, 1.0);
    EXPECT_EQ(path.end()[1].x, 3.0);
    EXPECT_TRUE(path.next_leg());
    EXPECT_EQ(path.target()[0].x, 2.0);
    EXPECT_FALSE(path.next_leg());
    EXPECT_EQ(path.target()[0].x, 2.0);
}

TEST(StallDetector, CountsShortStepsInARow) {
    StallDetector stall;
    for (int k = 0; k < 4; ++k)
        stall.add(iteration(1e-6, false));
    EXPECT_EQ(stall.short_steps, 4);
    stall.add(iteration(0.5, false));
    EXPECT_EQ(stall.short_steps, 0);
}

TEST(Stiffness, FollowsTheRuleOfTheSmallestDistance) {
    StepSettings settings;
    settings.diagonal = 2.0;
    settings.dhat = 2e-3;
    settings.mean_mass = 0.5;
    const StiffnessRange range = stiffness_range(settings);
    // kappa_min = 1e11 m D0 / (4 Dhat^2) for a curvature of Dhat^2 / D0^2, D0 = 1e-16
    // l^2; the logarithms of the exact curvature change it by less than 1e-6.
    const double d0_sq = 1e-16 * 4.0;
    const double dhat_sq = 4e-6;
    const double estimate =
        settings.contact.kappa_min_multiplier * 0.5 * d0_sq / (4.0 * dhat_sq * dhat_sq);
    EXPECT_NEAR(range.low, estimate, 1e-5 * estimate);
    EXPECT_EQ(range.high, 100.0 * range.low);
}

TEST(Stiffness, IsFiniteForEveryDhat) {
    StepSettings settings;
    settings.diagonal = 2.0;
    settings.mean_mass = 0.5;
    double before = 0.0;
    for (double dhat = 1e-2; dhat > 1e-15; dhat *= 0.1) {
        settings.dhat = dhat;
        const StiffnessRange range = stiffness_range(settings);
        EXPECT_TRUE(std::isfinite(range.low) && std::isfinite(range.high)) << dhat;
        EXPECT_GT(range.low, before) << dhat;
        before = range.low;
    }
}

TEST(Stiffness, ReachesAsFarAsToCarryTheLargestForceOfTheMaterial) {
    StepSettings settings;
    settings.diagonal = 2.0;
    settings.dhat = 2e-3;
    settings.mean_mass = 0.5;
    settings.dt = 0.01;
    settings.vertex_force = 1e12;
    const double high = stiffness_range(settings).high;
    const double force = -high * barrier_slope(2, 1e-3 * settings.dhat, settings.dhat);
    EXPECT_NEAR(force, settings.dt * settings.dt * settings.vertex_force, 1e-6 * force);
}

/// A scene of one metre whose material lets kappa rise far.
StepSettings stiff_metre() {
    StepSettings settings;
    settings.diagonal = 1.0;
    settings.dhat = 1e-3;
    settings.mean_mass = 1.0;
    settings.dt = 0.01;
    settings.vertex_force = 1e12;
    return settings;
}

TEST(AdaptiveLaw, RisesToWhatCarriesTheForceOfATinyGapTenTimesAtMost) {
    const StepSettings settings = stiff_metre();
    AdaptiveLaw law(settings);
    law.set_kappa(law.range().low);
    const auto force_at = [&](double gap) {
        return -law.current().barrier.kappa * barrier_slope(2, gap, settings.dhat);
    };
    EXPECT_FALSE(law.stiffen(1e-6));  // no tiny gap
    const double force = force_at(9e-10);
    const double before = law.current().barrier.kappa;
    EXPECT_TRUE(law.stiffen(9e-10));
    EXPECT_NEAR(law.current().barrier.kappa, 10.0 * before, 1e-9 * before);
    EXPECT_LE(force_at(1e-6), force);
    EXPECT_FALSE(law.stiffen(2e-9));  // it opens again
}

TEST(AdaptiveLaw, RisesWhereAGapDivesThreeTimesInARow) {
    const StepSettings settings = stiff_metre();
    AdaptiveLaw law(settings);
    law.set_kappa(law.range().low);
    const auto shrink = [&](std::vector<double> gaps) {
        bool stiffer = false;
        law.begin_step();
        for (const double gap : gaps)
            stiffer = law.stiffen(gap);
        return stiffer;
    };
    // Every step takes four fifths of the gap: the barrier is not felt.
    EXPECT_FALSE(shrink({5e-6, 9e-7, 1.8e-7}));
    EXPECT_TRUE(shrink({5e-6, 9e-7, 1.8e-7, 3.6e-8}));
    // It is felt; or the gap is not small yet; or it opens in between.
    EXPECT_FALSE(shrink({5e-6, 9e-7, 1.8e-7, 1.2e-7}));
    EXPECT_FALSE(shrink({5e-4, 1e-4, 2e-5, 4e-6}));
    EXPECT_FALSE(shrink({9e-7, 1.8e-7, 2e-7, 9e-8, 3e-8}));
}

/// One free vertex under a constant acceleration, as the integrators see it.
struct OneVertex {
    SerialExec exec;
    std::vector<Vec3d> x{{1, 0, 0}}, v{{2, 0, 0}}, a{{3, 0, 0}};
    std::vector<Vec3d> x_prev{{0.7, 0, 0}}, v_prev{{1.5, 0, 0}}, a_ext{{3, 0, 0}},
        out{{}};
    std::vector<std::uint8_t> fixed{0};
    std::vector<std::uint8_t> touching{0};
    std::vector<int> body{0};
    std::vector<double> weight{0.0};

    static View<Vec3d> view(std::vector<Vec3d>& items) { return {items.data(), 1}; }

    void step(IntegratorChoice choice) {
        const IntegratorOfVertex how{choice, {touching.data(), 1}, {body.data(), 1}};
        detail::predict(exec,
                        how,
                        view(x),
                        view(v),
                        view(a),
                        view(x_prev),
                        view(v_prev),
                        view(a_ext),
                        view(out),
                        {weight.data(), 1});
        detail::advance(exec,
                        how,
                        View<const std::uint8_t>{fixed.data(), 1},
                        view(out),
                        view(x),
                        view(v),
                        view(a),
                        view(x_prev),
                        view(v_prev));
    }
};

TEST(Integrators, FallWithoutForcesAsTheirFormulasSay) {
    const double dt = 0.1;
    OneVertex euler;
    euler.step({Integrator::ImplicitEuler, dt, 0.25, 0.5});
    EXPECT_NEAR(euler.v[0].x, 2.0 + 3.0 * dt, 1e-14);
    EXPECT_NEAR(euler.x[0].x, 1.0 + dt * (2.0 + 3.0 * dt), 1e-14);
    EXPECT_EQ(euler.x_prev[0].x, 1.0);

    // BDF2: (3 v' - 4 v + v_1) / (2 dt) = a.
    OneVertex bdf2;
    bdf2.step({Integrator::Bdf2, dt, 0.25, 0.5});
    EXPECT_NEAR((3.0 * bdf2.v[0].x - 4.0 * 2.0 + 1.5) / (2.0 * dt), 3.0, 1e-12);

    // Newmark with beta 1/4, gamma 1/2 is exact for a constant acceleration.
    OneVertex newmark;
    newmark.step({Integrator::Newmark, dt, 0.25, 0.5});
    EXPECT_NEAR(newmark.x[0].x, 1.0 + 2.0 * dt + 0.5 * 3.0 * dt * dt, 1e-14);
    EXPECT_NEAR(newmark.v[0].x, 2.0 + 3.0 * dt, 1e-13);
    EXPECT_NEAR(newmark.a[0].x, 3.0, 1e-12);
}

TEST(Integrators, OfABodyInContactIsImplicitEuler) {
    const double dt = 0.1;
    OneVertex euler;
    euler.step({Integrator::ImplicitEuler, dt, 0.25, 0.5});
    EXPECT_EQ(euler.weight[0], 1.0);
    for (const Integrator kind : {Integrator::Bdf2, Integrator::Newmark}) {
        OneVertex free;
        free.step({kind, dt, 0.25, 0.5});
        EXPECT_NE(free.weight[0], 1.0);
        OneVertex touching;
        touching.touching = {1};
        touching.step({kind, dt, 0.25, 0.5});
        EXPECT_EQ(touching.weight[0], 1.0);
        EXPECT_EQ(touching.x[0].x, euler.x[0].x);
        EXPECT_EQ(touching.v[0].x, euler.v[0].x);
    }
}

}  // namespace
}  // namespace noli
