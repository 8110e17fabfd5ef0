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
constexpr int kSpinsOfLeader = 100;   ///< before it takes what nobody has begun

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

/// What became of one thread's shares of the stages, which are numbered through.
struct Share {
    /// The last stage whose share was taken, by the thread or by the leader.
    alignas(64) std::atomic<std::uint64_t> taken{0};
    /// The last stage whose share is done.
    alignas(64) std::atomic<std::uint64_t> done{0};

    bool take(std::uint64_t stage) {
        std::uint64_t last = taken.load(std::memory_order_relaxed);
        return last < stage
            && taken.compare_exchange_strong(last, stage, std::memory_order_acq_rel);
    }
};

/// A loop that is open: the number of its first stage, and how many there are.
struct Open {
    static constexpr int kBits = 16;
    std::uint64_t word;

    [[nodiscard]] std::uint64_t first() const { return word >> kBits; }
    [[nodiscard]] std::uint64_t end() const {
        return first() + (word & ((std::uint64_t{1} << kBits) - 1));
    }
};

}  // namespace

struct Team::State {
    // Written by the leader before a loop opens, read by whoever holds a share of it: on
    // the cache line of the loop's number, which helpers wait for.
    alignas(64) std::atomic<std::uint64_t> open{0};
    Batch batch{};
    int whole[2] = {0, 0};  ///< bounds of a loop of one stage

    alignas(64) std::atomic<bool> awake{false};
    std::uint64_t next = 1;     ///< number of the next stage
    std::vector<Share> shares;  ///< per thread; 0 is the leader
    Helpers helpers;

    explicit State(int threads) : shares(static_cast<std::size_t>(threads)) {}

    [[nodiscard]] int threads() const { return static_cast<int>(shares.size()); }
    Share& share(int k) { return shares[static_cast<std::size_t>(k)]; }

    /// Takes and runs a thread's share of a stage of a loop that is open, or was.
    void work(int k, std::uint64_t stage, Open loop) {
        if (!share(k).take(stage)) return;
        // The loop stays open until this share is done.
        const Batch b = batch;
        const auto s =
            static_cast<int>(b.back ? loop.end() - 1 - stage : stage - loop.first());
        const int n = b.bounds[s + 1] - b.bounds[s];
        const int parts = std::clamp(n / std::max(1, b.grain), n > 0 ? 1 : 0, threads());
        const auto bound = [&](int part) {
            return b.bounds[s]
                 + static_cast<int>(static_cast<std::int64_t>(n) * part / parts);
        };
        if (k < parts) b.call(b.f, bound(k), bound(k + 1));
        share(k).done.store(stage, std::memory_order_release);
    }

    [[nodiscard]] bool all_done(std::uint64_t stage) const {
        return std::all_of(shares.begin(), shares.end(), [stage](const Share& s) {
            return s.done.load(std::memory_order_acquire) >= stage;
        });
    }

    /// The stages of a loop that are left to this helper.
    void help_with(int k, Open loop) {
        while (true) {
            const std::uint64_t last = share(k).taken.load(std::memory_order_acquire);
            const std::uint64_t stage = std::max(last + 1, loop.first());
            if (stage >= loop.end()) return;
            for (int idle = 0; stage > loop.first() && !all_done(stage - 1); ++idle)
                idle < kSpinsOfHelper ? pause() : std::this_thread::yield();
            work(k, stage, loop);
        }
    }

    /// Until the scope is over.
    void help(int k) {
        Open seen{0};
        int idle = 0;
        while (awake.load(std::memory_order_acquire)) {
            const Open loop{open.load(std::memory_order_acquire)};
            if (loop.word != seen.word) {
                help_with(k, loop);
                seen = loop;
                idle = 0;
            } else if (++idle < kSpinsOfHelper) {
                pause();
            } else {
                std::this_thread::yield();
                idle = kSpinsOfHelper / 2;
            }
        }
    }

    /// The leader's part of a stage, and what nobody else begins.
    void lead(std::uint64_t stage, Open loop) {
        work(0, stage, loop);
        for (int idle = 0; !all_done(stage); ++idle) {
            pause();
            if (idle < kSpinsOfLeader) continue;
            for (int k = 1; k < threads(); ++k)
                work(k, stage, loop);
            if (idle > kSpinsOfHelper) std::this_thread::yield();
        }
    }
};

Team::Team(int threads) : state_(std::make_unique<State>(std::max(1, threads))) {}

Team::~Team() = default;

int Team::threads() const {
    return state_->threads();
}

Team* Team::current() {
    return current_team;
}

void Team::run_whole(int n, int grain, const void* f, Call each) {
    if (AloneScope::active() || std::min(threads(), n / std::max(1, grain)) <= 1) {
        if (n > 0) each(f, 0, n);
        return;
    }
    state_->whole[1] = n;
    run_batch({f, each, state_->whole, grain, false}, 1);
}

void Team::run_alone(const Batch& batch, int stages) {
    for (int stage = 0; stage < stages; ++stage) {
        const int s = batch.back ? stages - 1 - stage : stage;
        if (batch.bounds[s] < batch.bounds[s + 1])
            batch.call(batch.f, batch.bounds[s], batch.bounds[s + 1]);
    }
}

void Team::run_batch(const Batch& batch, int stages) {
    State& s = *state_;
    if (AloneScope::active() || threads() == 1 || stages >= 1 << Open::kBits)
        return run_alone(batch, stages);
    s.batch = batch;
    const Open loop{s.next << Open::kBits | static_cast<std::uint64_t>(stages)};
    s.next += static_cast<std::uint64_t>(stages);
    s.open.store(loop.word, std::memory_order_release);
    for (std::uint64_t stage = loop.first(); stage < loop.end(); ++stage)
        s.lead(stage, loop);
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

TeamScope::TeamScope(Team& team)
    : team_(current_team == nullptr && !AloneScope::active() ? &team : nullptr) {
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
