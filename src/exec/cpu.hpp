// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The CPU executors: Cpu (oneTBB), Serial (the reference) and Shuffled (indices in a
/// scrambled order, to catch loops whose result depends on order). All three give bitwise
/// equal results.

#include "core/view.hpp"
#include "exec/buffer.hpp"
#include "exec/lanes.hpp"
#include "exec/later.hpp"
#include "exec/orders.hpp"
#include "exec/radix_sort.hpp"
#include "exec/team.hpp"
#include "exec/warp.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

namespace noli {

/// Runs kernels on the host. Reductions use a fixed partition, so results do not depend
/// on the number of threads nor on the order of execution.
template <class Order>
class HostExec : public LaterNumbers<HostExec<Order>, HostBuffer<double>> {
  public:
    template <class T>
    using Buffer = HostBuffer<T>;
    static constexpr bool kIsDevice = false;

    /// Threads that loops are shared among, this one too.
    static int threads() { return Order::threads(); }

    /// While the result lives, threads stand by for the loops of this thread: worth it
    /// where many short loops follow each other.
    auto stand_by() {
        if constexpr (requires { Order::kMostThreads; }) {
            if (!team_)
                team_ = std::make_unique<Team>(std::min(Order::kMostThreads, threads()));
            return TeamScope(*team_);
        } else {
            return 0;
        }
    }

    /// f(i) for every i in [0, n). `grain` is the least number of items worth a task.
    template <class F>
    void for_each(const char* /*name*/, int n, F f, int grain = 128) {
        Order::run(n, grain, f);
    }

    /// f(i) for every i in [bounds[s], bounds[s + 1]), s = 0, 1, ...: a stage begins when
    /// the one before is done. `back`: the last stage first, threads that stand by take
    /// their last item first. Every item is worth a task.
    template <class F>
    void for_stages(const char* /*name*/, View<const int> bounds, bool back, F f) {
        if constexpr (requires { Order::kMostThreads; })
            Order::run_stages(bounds, back, f);
        else
            detail::run_stages_of<Order>(bounds, back, f);
    }

    /// f(lane) for every element, several at a time: see exec/lanes.hpp.
    template <class F>
    void for_lanes(const char* /*name*/, int n, F f) {
        const LaneDispatch dispatch = lane_dispatch();
        const int blocks = (n + kLaneBlock - 1) / kLaneBlock;
        Order::run(blocks, 1, [&](int b) {
            const int begin = b * kLaneBlock;
            run_lane_block(dispatch, begin, std::min(n, begin + kLaneBlock), f);
        });
    }

    /// f(warp, first) for every warp of n threads, `first` the number of its first one:
    /// see exec/warp.hpp. On the CPU warps run one after another.
    template <class F>
    void for_warps(const char* /*name*/, std::uint32_t n, F f) {
        for (std::uint32_t first = 0; first < n; first += kWarpLanes)
            f(SimulatedWarp{}, first);
    }

    /// g(f(0) + ... + f(n-1)), added in an order that only n determines. g is part of the
    /// loop: it runs once, and on a device the sum does not come to the host.
    template <class F, class G>
    void sum_then(const char* /*name*/, int n, F f, G g, int grain = kSumGrain) {
        g(reduce(
            n, 0.0, f, [](double a, double b) { return a + b; }, grain));
    }

    /// g(smallest f(i)): +infinity when n is 0. A NaN anywhere gives NaN.
    template <class F, class G>
    void min_then(const char* /*name*/, int n, F f, G g) {
        constexpr double kNone = std::numeric_limits<double>::infinity();
        g(reduce(
            n,
            kNone,
            f,
            [](double a, double b) { return (b < a || b != b) ? b : a; },
            kSumGrain));
    }

    /// Loops that run again and again without a word from the host between them.
    using Recording = std::function<void()>;

    /// Keeps the loops that `f` starts. Their functions and sizes stay as they are now, f
    /// itself may be called any number of times. No loop may be longer than `longest`,
    /// none may return a number, and f allocates nothing.
    template <class F>
    void record(Recording& to, int /*longest*/, F f) {
        to = f;
    }
    /// Runs the loops of a recording once.
    void replay(Recording& from) { from(); }

    /// offsets[i] = counts[0] + ... + counts[i-1]; offsets has one item more than counts
    /// and may not alias it. *total, in the executor's memory, becomes the sum, if given.
    void scan_then(const char* /*name*/,
                   View<const int> counts,
                   View<int> offsets,
                   double* total) {
        int sum = 0;
        for (int i = 0; i < counts.size; ++i) {
            offsets[i] = sum;
            sum += counts[i];
        }
        offsets[counts.size] = sum;
        if (total != nullptr) *total = sum;
    }

    /// Sorts keys and carries values along; equal keys keep their order.
    template <class Key>
    void sort_by_key(const char* /*name*/, View<Key> keys, View<int> values) {
        sort_.sort(keys, values);
    }

    template <class T>
    void upload(const std::vector<T>& from, HostBuffer<T>& to) {
        to.resize(static_cast<int>(from.size()));
        std::copy(from.begin(), from.end(), to.view().begin());
    }
    template <class T>
    void download(View<const T> from, std::vector<T>& to) {
        to.assign(from.begin(), from.end());
    }
    /// A download that a device does while its host goes on; `take` waits for it.
    template <class T>
    using Arrival = HostArrival<T>;
    template <class T>
    void start_download(View<const T> from, HostArrival<T>& to) {
        to.start(from);
    }
    /// to[i] = from[i]; sizes must agree.
    template <class T>
    void copy(View<const T> from, View<T> to) {
        NOLI_DCHECK(from.size == to.size);
        std::copy(from.begin(), from.end(), to.begin());
    }
    /// One item, host side. Slow on a device: not for loops.
    template <class T>
    T read(View<const T> from, int i) {
        return from[i];
    }

  private:
    template <class F, class Combine>
    double reduce(int n, double start, F f, Combine combine, int grain) {
        constexpr int kChunk =
            128;  // fixed: the split must not depend on the thread count
        const int chunks = (n + kChunk - 1) / kChunk;
        const auto reduce_chunk = [&](int c) {
            double acc = start;
            const int end = std::min(n, (c + 1) * kChunk);
            for (int i = c * kChunk; i < end; ++i)
                acc = combine(acc, f(i));
            return acc;
        };
        if (chunks <= 1) return reduce_chunk(0);
        partial_.resize(static_cast<std::size_t>(chunks));
        double* partial = partial_.data();
        Order::run(chunks, std::max(1, grain / kChunk), [&](int c) {
            partial[c] = reduce_chunk(c);
        });
        double acc = start;
        for (int c = 0; c < chunks; ++c)
            acc = combine(acc, partial[c]);
        return acc;
    }

    std::vector<double> partial_;
    detail::RadixSort<Order> sort_;
    std::unique_ptr<Team> team_;
};

using CpuExec = HostExec<detail::TbbOrder>;
using SerialExec = HostExec<detail::SerialOrder>;
using ShuffledExec = HostExec<detail::ShuffledOrder>;

}  // namespace noli
