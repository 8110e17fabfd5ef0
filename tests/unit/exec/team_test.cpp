// SPDX-License-Identifier: Apache-2.0
#include "exec/team.hpp"

#include "exec/cpu.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <mutex>
#include <numeric>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

namespace noli {
namespace {

using Range = std::pair<int, int>;

class TeamOf : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Threads, TeamOf, testing::Range(1, 5));

/// The ranges of one loop, sorted. Counts in `visits` without a lock: the thread
/// sanitizer sees an index that two threads take.
std::vector<Range> run_loop(Team& team, int n, int grain, std::vector<int>& visits) {
    std::vector<Range> ranges;
    std::mutex mutex;
    team.run(n, grain, [&](int begin, int end) {
        for (int i = begin; i < end; ++i)
            ++visits[static_cast<std::size_t>(i)];
        const std::lock_guard lock(mutex);
        ranges.emplace_back(begin, end);
    });
    std::sort(ranges.begin(), ranges.end());
    return ranges;
}

void expect_one_visit_each(Team& team, int n, int grain) {
    std::vector<int> visits(static_cast<std::size_t>(n), 0);
    const std::vector<Range> ranges = run_loop(team, n, grain, visits);
    EXPECT_EQ(std::count(visits.begin(), visits.end(), 1), n) << n << " " << grain;
    EXPECT_LE(ranges.size(), static_cast<std::size_t>(team.threads()));
    int next = 0;
    for (const auto& [begin, end] : ranges) {
        EXPECT_EQ(begin, next);
        EXPECT_GE(end - begin, std::min(n, grain)) << n << " " << grain;
        next = end;
    }
    EXPECT_EQ(next, n);
}

TEST_P(TeamOf, RunsEveryIndexOnceInRangesThatAreNotTooShort) {
    Team team(GetParam());
    EXPECT_EQ(team.threads(), GetParam());
    const TeamScope scope(team);
    for (const int n : {0, 1, 2, 3, 4, 5, 7, 8, 15, 16, 17, 100, 1023, 40000})
        for (const int grain : {1, 2, 3, 8, 128, 100000})
            expect_one_visit_each(team, n, grain);
}

TEST_P(TeamOf, SharesALongLoopAmongAllThreads) {
    Team team(GetParam());
    const TeamScope scope(team);
    std::vector<int> visits(1000, 0);
    EXPECT_EQ(run_loop(team, 1000, 1, visits).size(),
              static_cast<std::size_t>(GetParam()));
}

TEST_P(TeamOf, LeavesLoopsToItsLeaderWhenTheyAreNotShared) {
    Team team(GetParam());
    const TeamScope scope(team);
    std::vector<int> visits(1000, 0);
    {
        const AloneScope alone(true);
        EXPECT_EQ(run_loop(team, 1000, 1, visits), (std::vector<Range>{{0, 1000}}));
    }
    EXPECT_EQ(run_loop(team, 1000, 1, visits).size(),
              static_cast<std::size_t>(GetParam()));
    EXPECT_EQ(std::count(visits.begin(), visits.end(), 2), 1000);
}

TEST_P(TeamOf, SeesInEachLoopWhatAllThreadsWroteInTheLastOne) {
    Team team(GetParam());
    const TeamScope scope(team);
    constexpr int kLoops = 4000;
    constexpr std::size_t kSize = 64;
    std::vector<int> from(kSize, 0), to(kSize, -1);
    for (int loop = 0; loop < kLoops; ++loop) {
        // Reads the other end, which another thread wrote. The length changes, so that
        // the shares move too.
        const int n = 32 + loop % 33;
        const auto last = static_cast<std::size_t>(n - 1);
        team.run(n, 1, [&](int begin, int end) {
            for (auto i = static_cast<std::size_t>(begin);
                 i < static_cast<std::size_t>(end);
                 ++i)
                to[i] = from[last - i] + 1;
        });
        for (std::size_t i = last + 1; i < kSize; ++i)
            to[i] = from[i] + 1;
        std::swap(from, to);
    }
    EXPECT_EQ(std::count(from.begin(), from.end(), kLoops), 64);
}

TEST_P(TeamOf, WorksInScopesThatRepeatAndBetweenThem) {
    Team team(GetParam());
    for (int round = 0; round < 100; ++round) {
        expect_one_visit_each(team, 500, 8);  // helpers are at rest
        const TeamScope scope(team);
        EXPECT_EQ(Team::current(), &team);
        expect_one_visit_each(team, 500, 8);
    }
    EXPECT_EQ(Team::current(), nullptr);
}

TEST_P(TeamOf, EndsWhetherItEverWokeOrNot) {
    for (int round = 0; round < 20; ++round) {
        Team asleep(GetParam());
        Team team(GetParam());
        {
            const TeamScope scope(team);
            if (round % 2 == 0) expect_one_visit_each(team, 50, 1);
        }
        // Some helpers have not noticed yet that the scope is over.
    }
}

TEST(Team, HasAtLeastItsLeader) {
    Team team(0);
    EXPECT_EQ(team.threads(), 1);
    const TeamScope scope(team);
    expect_one_visit_each(team, 100, 1);
}

TEST(TeamScope, KeepsTheOuterTeamWhenNested) {
    Team outer(2);
    Team inner(3);
    const TeamScope first(outer);
    {
        const TeamScope second(inner);
        EXPECT_EQ(Team::current(), &outer);
        const TeamScope third(outer);
        EXPECT_EQ(Team::current(), &outer);
    }
    EXPECT_EQ(Team::current(), &outer);
    expect_one_visit_each(outer, 300, 1);
    expect_one_visit_each(inner, 300, 1);
}

TEST(TeamScope, BelongsToTheThreadThatOpenedIt) {
    Team team(2);
    const TeamScope scope(team);
    Team* seen = &team;
    std::thread([&seen] { seen = Team::current(); }).join();
    EXPECT_EQ(seen, nullptr);
}

TEST(TeamScope, ServesTwoThreadsWithATeamEach) {
    const auto work = [] {
        Team team(2);
        for (int round = 0; round < 30; ++round) {
            const TeamScope scope(team);
            for (int loop = 0; loop < 10; ++loop)
                expect_one_visit_each(team, 100 + loop, 4);
        }
    };
    std::thread other(work);
    work();
    other.join();
}

// A scope ends before its team: both live on the stack, and neither can be moved away.
static_assert(!std::is_move_constructible_v<Team> && !std::is_move_assignable_v<Team>);
static_assert(
    !std::is_move_constructible_v<TeamScope> && !std::is_move_assignable_v<TeamScope>);

TEST(TeamScope, LeavesTheTeamUsableAtItsEnd) {
    Team team(4);
    for (int round = 0; round < 3; ++round) {
        {
            const TeamScope scope(team);
            expect_one_visit_each(team, 1000, 1);
        }
        EXPECT_EQ(Team::current(), nullptr);
        expect_one_visit_each(team, 1000, 1);  // at rest: the leader does all of it
    }
}

/// Numbers whose sum depends on the order of addition.
double uneven(int i) {
    return std::sin(1.0 + i) * std::pow(10.0, i % 13 - 6);
}

bool same_bits(double a, double b) {
    return std::memcmp(&a, &b, sizeof(double)) == 0;
}

TEST_P(TeamOf, LeavesSumsAndMinimaAsTheyAreWithoutIt) {
    CpuExec exec;
    SerialExec serial;
    Team team(GetParam());
    for (const int n : {0, 1, 511, 512, 513, 1025, 5000, 30011}) {
        const double sum = exec.sum("test/sum", n, uneven);
        const double least = exec.min("test/min", n, uneven);
        EXPECT_TRUE(same_bits(sum, serial.sum("test/sum", n, uneven))) << n;
        const TeamScope scope(team);
        EXPECT_TRUE(same_bits(exec.sum("test/sum", n, uneven), sum)) << n;
        EXPECT_TRUE(same_bits(exec.min("test/min", n, uneven), least)) << n;
    }
}

TEST(StandBy, LeavesTheResultsOfAllLoopsAsTheyAre) {
    CpuExec exec;
    constexpr int kSize = 20000;
    const auto squares = [&exec] {
        std::vector<double> out(kSize, -1.0);
        exec.for_each("test/squares", kSize, [&out](int i) {
            out[static_cast<std::size_t>(i)] = uneven(i) * uneven(i);
        });
        return out;
    };
    const double sum = exec.sum("test/sum", kSize, uneven);
    const std::vector<double> expected = squares();
    for (int round = 0; round < 3; ++round) {
        const auto threads = exec.stand_by();
        EXPECT_NE(Team::current(), nullptr);
        EXPECT_TRUE(same_bits(exec.sum("test/sum", kSize, uneven), sum));
        EXPECT_EQ(squares(), expected);
        const auto again = exec.stand_by();
        EXPECT_EQ(squares(), expected);
    }
    EXPECT_EQ(Team::current(), nullptr);
    EXPECT_EQ(squares(), expected);
}

TEST(StandBy, IsNothingForExecutorsOfOneThread) {
    SerialExec serial;
    [[maybe_unused]] const auto none = serial.stand_by();
    EXPECT_EQ(Team::current(), nullptr);
}

/// Indices in the order in which each thread meets them.
std::map<std::thread::id, std::vector<int>> visits_back(CpuExec& exec, int n) {
    std::map<std::thread::id, std::vector<int>> visits;
    std::mutex mutex;
    const int bounds[] = {0, n};
    exec.for_stages("test/back", {bounds, 2}, true, [&](int i) {
        const std::lock_guard lock(mutex);
        visits[std::this_thread::get_id()].push_back(i);
    });
    return visits;
}

TEST_P(TeamOf, RunsAStageBackwardsInEachRange) {
    Team team(GetParam());
    const TeamScope scope(team);
    CpuExec exec;
    for (const int n : {0, 1, 2, 5, 64, 1000}) {
        std::vector<int> seen;
        int ranges = 0;
        for (const auto& [thread, indices] : visits_back(exec, n)) {
            for (std::size_t k = 0; k < indices.size(); ++k)
                if (k == 0 || indices[k] != indices[k - 1] - 1) ++ranges;
            seen.insert(seen.end(), indices.begin(), indices.end());
        }
        EXPECT_LE(ranges, team.threads());
        std::sort(seen.begin(), seen.end());
        std::vector<int> all(static_cast<std::size_t>(n));
        std::iota(all.begin(), all.end(), 0);
        EXPECT_EQ(seen, all);
    }
}

/// When an item was visited, counted over all items. Plain numbers: the thread sanitizer
/// sees a stage that begins too early.
template <class Exec>
void expect_stages_in_order(Exec& exec, const std::vector<int>& bounds, bool back) {
    const auto n = static_cast<std::size_t>(bounds.back());
    const int stages = static_cast<int>(bounds.size()) - 1;
    // stage_of[i], and what each item saw: the sum over the stage before its own.
    std::vector<int> stage_of(n);
    for (int s = 0; s < stages; ++s)
        for (int i = bounds[std::size_t(s)]; i < bounds[std::size_t(s) + 1]; ++i)
            stage_of[std::size_t(i)] = s;
    std::vector<int> value(n, 0), visits(n, 0);
    const auto before = [&](int s) { return back ? s + 1 : s - 1; };
    exec.for_stages("test/stages", {bounds.data(), stages + 1}, back, [&](int i) {
        const int s = before(stage_of[std::size_t(i)]);
        int sum = 1;
        if (s >= 0 && s < stages)
            for (int k = bounds[std::size_t(s)]; k < bounds[std::size_t(s) + 1]; ++k)
                sum = std::max(sum, value[std::size_t(k)] + 1);
        value[std::size_t(i)] = sum;
        ++visits[std::size_t(i)];
    });
    EXPECT_EQ(std::count(visits.begin(), visits.end(), 1), std::ptrdiff_t(n));
    int depth = 0;  // of the stage before; an empty one breaks the chain
    for (int k = 0; k < stages; ++k) {
        const int s = back ? stages - 1 - k : k;
        const int size = bounds[std::size_t(s) + 1] - bounds[std::size_t(s)];
        depth = size == 0 ? 0 : depth + 1;
        for (int i = bounds[std::size_t(s)]; i < bounds[std::size_t(s) + 1]; ++i)
            ASSERT_EQ(value[std::size_t(i)], depth) << "stage " << s << " item " << i;
    }
}

const std::vector<std::vector<int>> kStages = {{0},
                                               {0, 0},
                                               {0, 1},
                                               {0, 7},
                                               {0, 3, 3, 4, 10, 10, 11, 40},
                                               {0, 50, 100, 101, 103, 130, 131, 190}};

TEST_P(TeamOf, BeginsAStageWhenAllOfTheOneBeforeIsDone) {
    Team team(GetParam());
    CpuExec exec;
    for (int round = 0; round < 200; ++round) {
        const TeamScope scope(team);
        for (const std::vector<int>& bounds : kStages)
            for (const bool back : {false, true}) {
                expect_stages_in_order(exec, bounds, back);
                expect_one_visit_each(team, 20 + round, 1);
            }
    }
}

TEST_P(TeamOf, RunsStagesOnItsLeaderWhenTheyAreNotShared) {
    Team team(GetParam());
    const TeamScope scope(team);
    const AloneScope alone(true);
    CpuExec exec;
    for (const std::vector<int>& bounds : kStages)
        for (const bool back : {false, true})
            expect_stages_in_order(exec, bounds, back);
}

/// 65,535 stages are the most that a loop counts; beyond, its leader runs it.
TEST_P(TeamOf, RunsAnyNumberOfStages) {
    Team team(GetParam());
    const TeamScope scope(team);
    CpuExec exec;
    for (const int stages : {65535, 65536}) {
        std::vector<int> bounds(static_cast<std::size_t>(stages) + 1);
        std::iota(bounds.begin(), bounds.end(), 0);
        for (const bool back : {false, true}) {
            expect_stages_in_order(exec, bounds, back);
            expect_one_visit_each(team, 20, 1);
        }
    }
}

TEST(Stages, AreInOrderOnEveryExecutor) {
    CpuExec cpu;
    SerialExec serial;
    ShuffledExec shuffled;
    for (const std::vector<int>& bounds : kStages)
        for (const bool back : {false, true}) {
            expect_stages_in_order(cpu, bounds, back);
            expect_stages_in_order(serial, bounds, back);
            expect_stages_in_order(shuffled, bounds, back);
        }
}

}  // namespace
}  // namespace noli
