// SPDX-License-Identifier: Apache-2.0
#include "exec/cpu.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <mutex>
#include <set>
#include <thread>

namespace noli {
namespace {

/// Threads that run the indices of a loop which is long enough for several.
std::set<std::thread::id> threads_of_loop(CpuExec& exec) {
    std::set<std::thread::id> threads;
    std::mutex mutex;
    exec.for_each(
        "test/threads",
        1000,
        [&](int) {
            std::this_thread::sleep_for(std::chrono::microseconds(1));
            const std::lock_guard lock(mutex);
            threads.insert(std::this_thread::get_id());
        },
        1);
    return threads;
}

TEST(AloneScope, KeepsLoopsOnTheirThread) {
    CpuExec exec;
    const std::set<std::thread::id> own{std::this_thread::get_id()};
    const AloneScope alone(true);
    EXPECT_EQ(threads_of_loop(exec), own);
    const AloneScope inner(false);
    EXPECT_EQ(threads_of_loop(exec), own);
}

TEST(AloneScope, WakesNoTeam) {
    CpuExec exec;
    {
        const AloneScope alone(true);
        const auto threads = exec.stand_by();
        EXPECT_EQ(Team::current(), nullptr);
    }
    const AloneScope none(false);
    EXPECT_FALSE(AloneScope::active());
    const auto threads = exec.stand_by();
    EXPECT_NE(Team::current(), nullptr);
}

}  // namespace
}  // namespace noli
