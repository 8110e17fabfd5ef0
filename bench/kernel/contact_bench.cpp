// SPDX-License-Identifier: Apache-2.0
/// Contact detection on a pile of boxes that sinks into itself: the broad phase of a
/// motion, the collision bound of the step, and the active pairs at its start.

#include "exec/arena.hpp"
#include "kernel/problems.hpp"
#include "step/collision.hpp"

#include <benchmark/benchmark.h>

#include <memory>
#include <vector>

namespace noli::bench {
namespace {

struct Pile {
    Model model;
    std::vector<Vec3d> p;  ///< the motion: every layer falls faster than the one below
    Collision<CpuExec> collision;
    PairSet<CpuExec> pairs;

    explicit Pile(int side) : model(pile(side)) {
        p = noise(model.num_vertices, 0.1 * kPileDhat, 3);
        for (std::size_t v = 0; v < p.size(); ++v)
            p[v].y -= 2.0 * kPileDhat * model.x0[v].y;
    }

    [[nodiscard]] View<const Vec3d> x() const { return view(model.x0); }

    void find_candidates(CpuExec& exec) {
        collision.begin_step(exec, model, model.obstacle);
        collision.find_candidates_along(exec, x(), view(p), 1.0, kPileDhat);
    }
    void find_pairs(CpuExec& exec) {
        collision.find_pairs_at(exec, x(), kPileDhat, pairs);
    }
    StepBound bound(CpuExec& exec) {
        return collision.bound(exec, x(), view(p), 1.0, 0.0);
    }
};

Pile& pile_of(int side) {
    static int last = 0;
    static std::unique_ptr<Pile> kept;
    if (last != side) {
        kept = std::make_unique<Pile>(side);
        last = side;
    }
    return *kept;
}

template <class Work>
void time_contacts(benchmark::State& state, Work work) {
    Pile& pile = pile_of(static_cast<int>(state.range(0)));
    Arena(static_cast<int>(state.range(1))).run([&] {
        CpuExec exec;
        pile.find_candidates(exec);
        pile.find_pairs(exec);
        for (auto _ : state)
            work(pile, exec);
    });
    const double pairs = pile.pairs.size();
    state.counters["num_tets"] = pile.model.num_tets();
    state.counters["pairs"] = pairs;
    state.counters["per_pair"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * pairs,
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void broad_phase(benchmark::State& state) {
    time_contacts(state, [](Pile& pile, CpuExec& exec) { pile.find_candidates(exec); });
}
void active_pairs(benchmark::State& state) {
    time_contacts(state, [](Pile& pile, CpuExec& exec) { pile.find_pairs(exec); });
}
void step_bound_ccd(benchmark::State& state) {
    time_contacts(state, [](Pile& pile, CpuExec& exec) {
        benchmark::DoNotOptimize(pile.bound(exec).alpha);
    });
}

void sizes(benchmark::internal::Benchmark* b) {
    b->ArgNames({"side", "threads"})->UseRealTime()->Unit(benchmark::kMicrosecond);
    for (const int side : {4, 12}) {
        b->Args({side, 1});
        if (all_threads() > 1) b->Args({side, all_threads()});
    }
}

BENCHMARK(broad_phase)->Apply(sizes);
BENCHMARK(active_pairs)->Apply(sizes);
BENCHMARK(step_bound_ccd)->Apply(sizes);

}  // namespace
}  // namespace noli::bench

BENCHMARK_MAIN();
