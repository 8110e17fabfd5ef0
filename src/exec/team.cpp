// SPDX-License-Identifier: Apache-2.0
#include "exec/team.hpp"

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

    alignas(64) std::atomic<int> done{0};   ///< shares of it
    alignas(64) std::atomic<int> awake{0};  ///< 1 in a scope, 0 at rest, -1 at the end
    std::vector<Claim> claims;              ///< per thread; 0 is the leader
    std::vector<std::thread> helpers;

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

    void help(int share) {
        std::uint64_t seen = 0;
        int idle = 0;
        while (true) {
            const std::uint64_t current = loop.load(std::memory_order_acquire);
            if (current != seen) {
                work(share, current);
                seen = current;
                idle = 0;
                continue;
            }
            if (++idle < kSpinsOfHelper) {
                pause();
                continue;
            }
            const int state = awake.load(std::memory_order_acquire);
            if (state < 0) return;
            if (state == 0) awake.wait(0, std::memory_order_acquire);
            std::this_thread::yield();
            idle = kSpinsOfHelper / 2;
        }
    }
};

Team::Team(int threads) : state_(std::make_unique<State>(std::max(1, threads))) {
    for (int k = 1; k < threads; ++k)
        state_->helpers.emplace_back([s = state_.get(), k] { s->help(k); });
}

Team::~Team() {
    state_->awake.store(-1, std::memory_order_release);
    state_->awake.notify_all();
    for (std::thread& helper : state_->helpers)
        helper.join();
}

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
    state_->awake.store(1, std::memory_order_release);
    state_->awake.notify_all();
}

void Team::rest() {
    state_->awake.store(0, std::memory_order_release);
}

TeamScope::TeamScope(Team& team) : team_(current_team == nullptr ? &team : nullptr) {
    if (team_ == nullptr) return;
    current_team = team_;
    team_->wake();
}

TeamScope::~TeamScope() {
    if (team_ == nullptr) return;
    team_->rest();
    current_team = nullptr;
}

}  // namespace noli
