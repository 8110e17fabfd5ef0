// SPDX-License-Identifier: Apache-2.0
#include "exec/team.hpp"

#include <tbb/task_group.h>

#include <algorithm>
#include <thread>

namespace noli {

namespace {

thread_local Team* current_team = nullptr;

// A look at a counter takes some 50 ns with the pause instruction.
constexpr int kSpinsOfHelper = 2000;  ///< before it gives way
constexpr int kSpinsOfLeader = 40;    ///< before it takes what nobody has begun

void pause() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
}

/// Runs f on the scheduler's own threads: a thread of ours would fight for the core with
/// the scheduler's, which looks for work for a while before it sleeps.
class Helpers {
  public:
#if defined(__SANITIZE_THREAD__)
    // The sanitizer does not see how a TBB that it did not compile synchronises.
    template <class F>
    void start(const F& f) {
        threads_.emplace_back(f);
    }
    void wait() {
        for (std::thread& thread : threads_)
            thread.join();
        threads_.clear();
    }

  private:
    std::vector<std::thread> threads_;
#else
    template <class F>
    void start(const F& f) {
        tasks_.run(f);
    }
    /// Those that have not begun begin now, on this thread.
    void wait() {
        tasks_.wait();
    }

  private:
    tbb::task_group tasks_;
#endif
};

/// The last loop in which a thread's share was taken, by itself or by the leader.
struct alignas(64) Claim {
    std::atomic<std::uint64_t> loop{0};

    bool take(std::uint64_t current) {
        std::uint64_t last = loop.load(std::memory_order_relaxed);
        return last < current
            && loop.compare_exchange_strong(last, current, std::memory_order_acq_rel);
    }
};

}  // namespace

struct Team::State {
    // Written by the leader before a loop opens, read by whoever holds a share of it: on
    // the cache line of the loop's number, which helpers wait for.
    alignas(64) std::atomic<std::uint64_t> loop{0};  ///< number of the open loop
    const void* f = nullptr;
    Call call = nullptr;
    int n = 0;
    int shares = 1;

    alignas(64) std::atomic<int> done{0};  ///< shares of it
    alignas(64) std::atomic<bool> awake{false};
    std::vector<Claim> claims;  ///< per thread; 0 is the leader
    Helpers helpers;

    explicit State(int threads) : claims(static_cast<std::size_t>(threads)) {}

    /// Takes and runs the share of a thread in a loop that is open, or was.
    void work(int share, std::uint64_t current) {
        if (!claims[static_cast<std::size_t>(share)].take(current)) return;
        // The loop stays open until this share is done.
        if (share < shares) call(f, bound(share), bound(share + 1));
        done.fetch_add(1, std::memory_order_release);
    }

    [[nodiscard]] int bound(int share) const {
        return static_cast<int>(static_cast<std::int64_t>(n) * share / shares);
    }

    /// Until the scope is over.
    void help(int share) {
        std::uint64_t seen = 0;
        int idle = 0;
        while (awake.load(std::memory_order_acquire)) {
            const std::uint64_t current = loop.load(std::memory_order_acquire);
            if (current != seen) {
                work(share, current);
                seen = current;
                idle = 0;
            } else if (++idle < kSpinsOfHelper) {
                pause();
            } else {
                std::this_thread::yield();
                idle = kSpinsOfHelper / 2;
            }
        }
    }
};

Team::Team(int threads) : state_(std::make_unique<State>(std::max(1, threads))) {}

Team::~Team() = default;

int Team::threads() const {
    return static_cast<int>(state_->claims.size());
}

Team* Team::current() {
    return current_team;
}

void Team::run_shares(int n, int grain, const void* f, Call call) {
    State& s = *state_;
    const int shares = alone_ ? 1 : std::min(threads(), n / std::max(1, grain));
    if (shares <= 1) {
        if (n > 0) call(f, 0, n);
        return;
    }
    s.f = f;
    s.call = call;
    s.n = n;
    s.shares = shares;
    s.done.store(0, std::memory_order_relaxed);
    const std::uint64_t current = s.loop.load(std::memory_order_relaxed) + 1;
    s.loop.store(current, std::memory_order_release);
    s.work(0, current);
    for (int idle = 0; s.done.load(std::memory_order_acquire) != threads(); ++idle) {
        pause();
        if (idle < kSpinsOfLeader) continue;
        for (int share = 1; share < threads(); ++share)
            s.work(share, current);
        if (idle > kSpinsOfHelper) std::this_thread::yield();
    }
}

void Team::wake() {
    State& s = *state_;
    s.awake.store(true, std::memory_order_release);
    for (int k = 1; k < threads(); ++k)
        s.helpers.start([&s, k] { s.help(k); });
}

void Team::rest() {
    state_->awake.store(false, std::memory_order_release);
    state_->helpers.wait();
}

TeamScope::TeamScope(Team& team) : team_(current_team == nullptr ? &team : nullptr) {
    if (team_ == nullptr) return;
    current_team = team_;
    team_->wake();
}

TeamScope::~TeamScope() {
    if (team_ == nullptr) return;
    current_team = nullptr;
    team_->rest();
}

}  // namespace noli
