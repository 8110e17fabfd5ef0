// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Threads that stand by between the many short loops of a linear solve. CPU only.
///
/// A task scheduler takes several microseconds to start a loop, a triangular sweep of a
/// small system is shorter than that. Inside a TeamScope the helpers of the team, tasks
/// of that scheduler, watch a counter: a loop starts and ends within a fraction of a
/// microsecond. Each thread takes the same share of every loop of the same length, so
/// that what it wrote is still in its cache when it reads it; the share of a helper that
/// the system has taken away goes to the leader.

#include <atomic>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <vector>

namespace noli {

class Team {
  public:
    /// `threads` >= 1 counts the leader, which is whoever calls run.
    explicit Team(int threads);
    ~Team();
    Team(const Team&) = delete;
    Team& operator=(const Team&) = delete;

    /// f(begin, end) for ranges that make up [0, n), one per thread, fewer if they would
    /// be shorter than `grain`. Returns when all are done. f must not throw nor run
    /// another loop.
    template <class F>
    void run(int n, int grain, const F& f) {
        run_whole(n, grain, &f, &call<F>);
    }

    /// The same for [bounds[s], bounds[s + 1]), s = 0, 1, ... `stages` - 1, one after the
    /// other: a stage begins when all of the one before is done. `back`: the last stage
    /// first. Threads wait for each other only, not for the leader to open a loop and to
    /// see its end: half the time between two stages.
    template <class F>
    void run_stages(const int* bounds, int stages, bool back, const F& f) {
        run_batch({&f, &call<F>, bounds, 1, back}, stages);
    }

    [[nodiscard]] int threads() const;

    /// The team of the innermost scope on this thread, or null.
    static Team* current();

  private:
    friend class TeamScope;
    using Call = void (*)(const void*, int, int);
    template <class F>
    static void call(const void* f, int begin, int end) {
        (*static_cast<const F*>(f))(begin, end);
    }

    /// What the stages of a loop do.
    struct Batch {
        const void* f;
        Call call;
        const int* bounds;
        int grain;
        bool back;
    };

    void run_whole(int n, int grain, const void* f, Call each);
    void run_batch(const Batch& batch, int stages);
    void run_alone(const Batch& batch, int stages);
    void wake();
    void rest();

    struct State;
    std::unique_ptr<State> state_;
};

/// While one that says so lives, CPU loops of this thread stay on it, those of a team
/// too, and no team wakes.
class AloneScope {
  public:
    explicit AloneScope(bool alone) : before_(active()) { flag() = before_ || alone; }
    ~AloneScope() { flag() = before_; }
    AloneScope(const AloneScope&) = delete;
    AloneScope& operator=(const AloneScope&) = delete;

    static bool active() { return flag(); }

  private:
    static bool& flag() {
        thread_local bool active = false;
        return active;
    }
    bool before_;
};

/// While it lives, the team's helpers are awake and CPU loops of this thread run on them.
/// Until it ends this thread must not wait in the scheduler by itself: it could be given
/// a helper's task, which ends with the scope.
class TeamScope {
  public:
    explicit TeamScope(Team& team);
    ~TeamScope();
    TeamScope(const TeamScope&) = delete;
    TeamScope& operator=(const TeamScope&) = delete;

  private:
    Team* team_;  ///< null if the team was awake already
};

}  // namespace noli
