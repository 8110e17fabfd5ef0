// SPDX-License-Identifier: Apache-2.0
#include "exec/sharing.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace noli {
namespace {

/// Share of so many pieces of work that were shared.
double shared_part(Sharing& sharing,
                   int pieces,
                   double seconds_shared,
                   double seconds_alone) {
    int shared = 0;
    for (int k = 0; k < pieces; ++k) {
        const bool now = sharing.shared();
        shared += now ? 1 : 0;
        sharing.took(now ? seconds_shared : seconds_alone);
    }
    return static_cast<double>(shared) / pieces;
}

TEST(Sharing, BeginsWithAllThreads) {
    EXPECT_TRUE(Sharing().shared());
}

TEST(Sharing, KeepsAllThreadsWhereTheyAreFaster) {
    Sharing sharing;
    EXPECT_GT(shared_part(sharing, 10000, 1e-5, 2e-5), 0.99);
}

TEST(Sharing, TakesOneThreadWhereThatIsFaster) {
    Sharing sharing;
    EXPECT_LT(shared_part(sharing, 10000, 3e-5, 2e-5), 0.01);
}

TEST(Sharing, NoticesThatThingsHaveChanged) {
    Sharing sharing;
    shared_part(sharing, 5000, 1e-5, 2e-5);
    shared_part(sharing, 5000, 3e-5, 2e-5);
    EXPECT_LT(shared_part(sharing, 10000, 3e-5, 2e-5), 0.02);
    shared_part(sharing, 5000, 1e-5, 2e-5);
    EXPECT_GT(shared_part(sharing, 10000, 1e-5, 2e-5), 0.98);
}

TEST(Sharing, DoesNotTryWhatTakesLong) {
    Sharing sharing;
    EXPECT_EQ(shared_part(sharing, 1000, 2e-3, 3e-3), 1.0);
    shared_part(sharing, 1000, 3e-5, 2e-5);
    EXPECT_LT(shared_part(sharing, 1000, 3e-5, 2e-5), 0.02);
    EXPECT_GT(shared_part(sharing, 10000, 2e-3, 4e-3), 0.5);
}

TEST(Sharing, LooksPastOnePieceThatWasHeldUp) {
    Sharing sharing;
    int alone = 0;
    for (int k = 0; k < 10000; ++k) {
        const bool now = sharing.shared();
        alone += now ? 0 : 1;
        sharing.took(k % 50 == 0 ? 1.0 : (now ? 1e-5 : 2e-5));
    }
    EXPECT_LT(alone, 200);
}

/// Seconds per work, on all threads and on one, of step number k.
struct StepCosts {
    double shared, alone;
};

/// Seconds of so many steps as `sharing` has them done, over those of the better way for
/// each. Steps come with different amounts of work.
template <class CostsOf>
double cost_over_best(SharingOfSteps& sharing, int steps, const CostsOf& costs_of) {
    double taken = 0.0;
    double best = 0.0;
    for (int k = 0; k < steps; ++k) {
        const StepCosts costs = costs_of(k);
        const double work = 3.0 + (k * 7) % 11;
        const double seconds = work * (sharing.shared() ? costs.shared : costs.alone);
        taken += seconds;
        best += work * std::min(costs.shared, costs.alone);
        sharing.took(seconds, work);
    }
    return taken / best;
}

TEST(SharingOfSteps, BeginsWithAllThreadsUnlessThereIsLittleToDo) {
    EXPECT_TRUE(SharingOfSteps(false, 1.0).shared());
    EXPECT_FALSE(SharingOfSteps(true, 1.0).shared());
}

TEST(SharingOfSteps, FindsTheFasterWayFromEitherStart) {
    for (const bool small : {false, true}) {
        for (const double alone : {0.7e-4, 1.6e-4}) {
            SharingOfSteps sharing(small, 1.0);
            const auto costs = [alone](int) { return StepCosts{1e-4, alone}; };
            cost_over_best(sharing, 20, costs);
            EXPECT_EQ(sharing.shared(), alone > 1e-4);
            EXPECT_LT(cost_over_best(sharing, 2000, costs), 1.01);
        }
    }
}

TEST(SharingOfSteps, IsNotMisledByCostsThatGrow) {
    SharingOfSteps sharing(false, 1.0);
    const auto growing = [](int k) {
        const double shared = 1e-4 * (1.0 + 0.05 * k);
        return StepCosts{shared, 1.3 * shared};
    };
    EXPECT_LT(cost_over_best(sharing, 60, growing), 1.03);
    EXPECT_TRUE(sharing.shared());
}

TEST(SharingOfSteps, DoesNotChangeForOneStepThatWasHeldUp) {
    SharingOfSteps sharing(false, 1.0);
    int held_up = 0;
    int alone = 0;
    bool was_alone = false;
    for (int k = 0; k < 40; ++k) {
        const bool now_alone = !sharing.shared();
        // The step after the first that went the other way: part of its trial.
        const bool hold_up = was_alone && !now_alone && held_up == 0;
        held_up += hold_up ? 1 : 0;
        alone += now_alone ? 1 : 0;
        sharing.took(hold_up ? 1e-2 : (now_alone ? 1.3e-4 : 1e-4), 1.0);
        was_alone = now_alone;
    }
    EXPECT_EQ(held_up, 1);
    EXPECT_LE(alone, 4);
}

TEST(SharingOfSteps, LooksAgainWhenTheWorkChanges) {
    SharingOfSteps sharing(false, 1.0);
    cost_over_best(sharing, 1000, [](int) { return StepCosts{2e-4, 1e-4}; });
    EXPECT_FALSE(sharing.shared());
    const auto heavy = [](int) { return StepCosts{5e-4, 8e-4}; };
    cost_over_best(sharing, 10, heavy);
    EXPECT_TRUE(sharing.shared());
}

TEST(SharingOfSteps, NoticesThatTheOtherWayHasBecomeFaster) {
    SharingOfSteps sharing(false, 1.0);
    cost_over_best(sharing, 1000, [](int) { return StepCosts{1e-4, 1.05e-4}; });
    EXPECT_TRUE(sharing.shared());
    cost_over_best(sharing, 600, [](int) { return StepCosts{1e-4, 0.5e-4}; });
    EXPECT_FALSE(sharing.shared());
}

TEST(SharingOfSteps, DoesNotTryWhatTakesLong) {
    SharingOfSteps sharing(false, 1e-3);
    const auto costs = [](int) { return StepCosts{2e-3, 4e-3}; };
    EXPECT_EQ(cost_over_best(sharing, 1000, costs), 1.0);
}

/// An executor as share_if_faster sees it.
struct TwoThreads {
    static constexpr bool kIsDevice = false;
    static int threads() { return 2; }
};
struct OneThread {
    static constexpr bool kIsDevice = false;
    static int threads() { return 1; }
};
struct Device {
    static constexpr bool kIsDevice = true;
};

TEST(ShareIfFaster, RunsAStepTheWayThatIsAskedFor) {
    for (const bool small : {false, true}) {
        SharingOfSteps sharing(small, 1.0);
        for (int k = 0; k < 20; ++k) {
            const bool alone = !sharing.shared();
            share_if_faster<TwoThreads>(sharing, [alone](int threads) {
                EXPECT_EQ(AloneScope::active(), alone);
                EXPECT_EQ(threads, alone ? 1 : 2);
                return 1.0;
            });
            EXPECT_FALSE(AloneScope::active());
        }
    }
}

TEST(ShareIfFaster, TriesNothingWhereThereIsNoChoice) {
    SharingOfSteps sharing(true, 1.0);
    const auto expect = [](int expected) {
        return [expected](int threads) {
            EXPECT_EQ(threads, expected);
            EXPECT_FALSE(AloneScope::active());
            return 1.0;
        };
    };
    for (int k = 0; k < 20; ++k) {
        share_if_faster<OneThread>(sharing, expect(1));
        share_if_faster<Device>(sharing, expect(0));
    }
    EXPECT_FALSE(sharing.shared());
}

}  // namespace
}  // namespace noli
