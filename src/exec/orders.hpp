// SPDX-License-Identifier: Apache-2.0
#pragma once
/// In which order, and on which threads, a loop of the host visits its indices.

#include "core/view.hpp"
#include "exec/team.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cstdint>
#include <numeric>
#if defined(__SANITIZE_THREAD__)
#include <thread>
#endif

namespace noli::detail {

struct SerialOrder {
    static int threads() { return 1; }

    template <class F>
    static void run(int n, int /*grain*/, const F& f) {
        for (int i = 0; i < n; ++i)
            f(i);
    }
};

/// Stages one after the other, each as a loop of its own; `back`: the last one first.
template <class Order, class F>
void run_stages_of(View<const int> bounds, bool back, const F& f) {
    const int stages = bounds.size - 1;
    for (int k = 0; k < stages; ++k) {
        const int first = bounds[back ? stages - 1 - k : k];
        const int n = bounds[back ? stages - k : k + 1] - first;
        Order::run(n, 1, [&](int i) { f(first + (back ? n - 1 - i : i)); });
    }
}

/// Runs f(i) for i in [0, n) with TBB, or with the team that stands by; small loops, and
/// all within an AloneScope, stay on this thread.
struct TbbOrder {
    static constexpr int kMostThreads = 16;  ///< of a team

    static int threads() { return tbb::this_task_arena::max_concurrency(); }

    template <class F>
    static void run(int n, int grain, const F& f) {
        if (n <= grain || AloneScope::active()) {
            for (int i = 0; i < n; ++i)
                f(i);
            return;
        }
        if (Team* team = Team::current(); team != nullptr) {
            team->run(n, grain, [&f](int begin, int end) {
                for (int i = begin; i < end; ++i)
                    f(i);
            });
            return;
        }
#if defined(__SANITIZE_THREAD__)
        run_on_two_threads(n, f);
#else
        tbb::parallel_for(tbb::blocked_range<int>(0, n, grain),
                          [&](const tbb::blocked_range<int>& range) {
                              for (int i = range.begin(); i != range.end(); ++i)
                                  f(i);
                          });
#endif
    }

    /// f(i) for i in [bounds[s], bounds[s + 1]), stage after stage; `back`: the last
    /// stage first, and in each thread the last index of its share.
    template <class F>
    static void run_stages(View<const int> bounds, bool back, const F& f) {
        Team* team = Team::current();
        if (team == nullptr) return run_stages_of<TbbOrder>(bounds, back, f);
        team->run_stages(bounds.data, bounds.size - 1, back, [&f, back](int b, int e) {
            for (int k = 0; k < e - b; ++k)
                f(back ? e - 1 - k : b + k);
        });
    }

#if defined(__SANITIZE_THREAD__)
    /// The thread sanitizer does not see how a TBB that it did not compile synchronises,
    /// so under it loops run on plain threads.
    template <class F>
    static void run_on_two_threads(int n, const F& f) {
        const auto run_part = [&f](int begin, int end) {
            for (int i = begin; i < end; ++i)
                f(i);
        };
        std::thread other(run_part, n / 2, n);
        run_part(0, n / 2);
        other.join();
    }
#endif
};

/// Visits every index once, in the order of multiplication by a number coprime to n.
struct ShuffledOrder {
    static int threads() { return 1; }

    template <class F>
    static void run(int n, int /*grain*/, const F& f) {
        if (n == 0) return;  // gcd(stride, 0) is never 1
        std::int64_t stride = 7919;
        while (std::gcd(stride, static_cast<std::int64_t>(n)) > 1)
            ++stride;
        for (std::int64_t i = 0; i < n; ++i)
            f(static_cast<int>((n - 1) - (i * stride) % n));
    }
};

}  // namespace noli::detail
