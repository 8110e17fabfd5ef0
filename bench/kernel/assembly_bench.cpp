// SPDX-License-Identifier: Apache-2.0
/// Gradient and Hessian of a box as Newton assembles them: element derivatives, the sum
/// into the block matrix, inertia. `per_tet` is the whole, `elastic_per_tet` the elements
/// alone, in seconds. NOLI_SIMD=2|4|8 in the environment chooses the pack
/// width.

#include "exec/arena.hpp"
#include "kernel/problems.hpp"

#include <benchmark/benchmark.h>

namespace noli::bench {
namespace {

void assemble(benchmark::State& state) {
    BoxProblem& problem = box_problem(static_cast<int>(state.range(0)));
    const double num_tets = problem.model.num_tets();
    double elastic = 0.0;
    Arena(static_cast<int>(state.range(1))).run([&] {
        CpuExec exec;
        problem.assemble(exec);
        problem.objective->take_seconds();
        for (auto _ : state)
            problem.assemble(exec);
        elastic = problem.objective->take_seconds().elastic;
    });
    state.counters["num_tets"] = num_tets;
    state.counters["per_tet"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * num_tets,
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
    state.counters["elastic_per_tet"] =
        elastic / (static_cast<double>(state.iterations()) * num_tets);
}

void sizes(benchmark::internal::Benchmark* b) {
    b->ArgNames({"tets", "threads"})->UseRealTime()->Unit(benchmark::kMicrosecond);
    for (const int tets : {10'000, 100'000, 1'000'000}) {
        b->Args({tets, 1});
        if (all_threads() > 1) b->Args({tets, all_threads()});
    }
}

BENCHMARK(assemble)->Apply(sizes);

}  // namespace
}  // namespace noli::bench

BENCHMARK_MAIN();
