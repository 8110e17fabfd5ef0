// SPDX-License-Identifier: Apache-2.0
/// Memory bandwidth: pure read and STREAM triad (24 bytes per element, as STREAM counts),
/// one thread and all, with arrays far beyond the caches and with arrays of the size of
/// a matrix in use. Sizes are of all arrays together. And how far the cores are apart:
/// the time that a word takes to another one and back.

#include "exec/arena.hpp"
#include "kernel/bandwidth.hpp"
#include "kernel/problems.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <atomic>
#include <thread>
#include <unistd.h>
#include <vector>

namespace noli::bench {
namespace {

constexpr int kMatrixMb = 8;  ///< of a scene of 40,000 tetrahedra

/// Four times the last-level cache, at least 512 MB, at most a quarter of the memory.
int beyond_caches_mb() {
    std::int64_t cache = 0;
    for (const auto& level : benchmark::CPUInfo::Get().caches)
        cache = std::max<std::int64_t>(cache, level.size);
    const std::int64_t memory =
        std::int64_t{sysconf(_SC_PHYS_PAGES)} * sysconf(_SC_PAGE_SIZE);
    return static_cast<int>(
        std::min(std::max<std::int64_t>(512 << 20, 4 * cache), memory / 4) >> 20);
}

/// Runs `pass` on state.range(1) threads that stand by, as in a linear solve.
template <class Pass>
void time_passes(benchmark::State& state, double bytes, Pass pass) {
    Arena arena(static_cast<int>(state.range(1)));
    arena.run([&] {
        CpuExec exec;
        [[maybe_unused]] const auto threads = exec.stand_by();
        pass(exec);
        for (auto _ : state) {
            pass(exec);
            benchmark::ClobberMemory();
        }
    });
    state.counters["bytes_per_second"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * bytes,
                           benchmark::Counter::kIsRate,
                           benchmark::Counter::kIs1000);
}

void read(benchmark::State& state) {
    const auto count = static_cast<std::size_t>(state.range(0)) * (1 << 20) / 8;
    const std::vector<double> data(count, 1.0);
    Reader reader(data.data(), 8 * count);
    time_passes(state, reader.bytes(), [&](CpuExec& exec) { reader.read(exec); });
}

void triad(benchmark::State& state) {
    const auto pieces =
        static_cast<std::size_t>(state.range(0)) * (1 << 20) / (24 * kPiece);
    std::vector<double> a(pieces * kPiece), b(a.size(), 1.0), c(a.size(), 2.0);
    const TriadKernel kernel{a.data(), b.data(), c.data(), 3.0};
    time_passes(state, 24.0 * static_cast<double>(a.size()), [&](CpuExec& exec) {
        exec.for_lanes("bench/triad", static_cast<int>(pieces), kernel);
    });
}

/// A word goes to another thread and comes back.
void there_and_back(benchmark::State& state) {
    struct alignas(128) Word {
        std::atomic<int> value{0};
        void wait_for(int wanted) const {
            while (value.load(std::memory_order_acquire) != wanted) {
            }
        }
    };
    if (all_threads() < 2) return state.SkipWithError("one core only");
    constexpr int kEnd = -1;
    Word there, back;
    std::thread other([&] {
        for (int last = 0;;) {
            const int seen = there.value.load(std::memory_order_acquire);
            if (seen == kEnd) return;
            if (seen == last) continue;
            last = seen;
            back.value.store(seen, std::memory_order_release);
        }
    });
    int round = 0;
    for (auto _ : state) {
        there.value.store(++round, std::memory_order_release);
        back.wait_for(round);
    }
    there.value.store(kEnd, std::memory_order_release);
    other.join();
}

void two_threads(benchmark::internal::Benchmark* b) {
    b->ArgName("threads")->UseRealTime()->Unit(benchmark::kNanosecond);
    if (all_threads() > 1) b->Arg(2);
}

void sizes(benchmark::internal::Benchmark* b) {
    b->ArgNames({"mb", "threads"})->UseRealTime()->Unit(benchmark::kMicrosecond);
    for (const int mb : {beyond_caches_mb(), kMatrixMb}) {
        b->Args({mb, 1});
        if (all_threads() > 1) b->Args({mb, all_threads()});
    }
}

BENCHMARK(read)->Apply(sizes);
BENCHMARK(triad)->Apply(sizes);
BENCHMARK(there_and_back)->Apply(two_threads);

}  // namespace
}  // namespace noli::bench

BENCHMARK_MAIN();
