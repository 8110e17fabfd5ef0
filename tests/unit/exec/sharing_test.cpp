// SPDX-License-Identifier: Apache-2.0
#include "exec/sharing.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace noli
