// SPDX-License-Identifier: Apache-2.0
/// The block matrix of a box: one product, and one iteration of PCG for each
/// preconditioner. Every repetition also reads the values of the same matrix with the
/// same threads, so `percent_of_read` says how near the product comes to what the memory
/// gives, whichever cache the matrix lies in. An iteration is compared with one read of
/// what its product needs; the rest is preconditioner and vectors.

#include "exec/arena.hpp"
#include "kernel/bandwidth.hpp"
#include "kernel/problems.hpp"
#include "linear/pcg.hpp"

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

namespace noli::bench {
namespace {

struct Named {
    const char* name;
    PreconditionerKind kind;
};
constexpr Named kPreconditioners[] = {
    {"block_jacobi", PreconditionerKind::BlockJacobi},
    {"gauss_seidel", PreconditionerKind::GaussSeidel},
    {"incomplete_cholesky", PreconditionerKind::IncompleteCholesky},
};

template <class T>
double bytes_of(View<T> view) {
    return static_cast<double>(view.size) * sizeof(T);
}

/// What a product cannot do without: the matrix once, x once, y once.
double bytes_per_product(const BlockMatrix<CpuExec>& matrix) {
    return bytes_of(matrix.values()) + bytes_of(matrix.col())
         + bytes_of(matrix.row_begin()) + 2.0 * sizeof(Vec3d) * matrix.num_rows();
}

/// Sums over the iterations of a benchmark.
struct Times {
    double work = 0.0, read = 0.0;  ///< s
    double read_bytes = 0.0;
};

void report(benchmark::State& state, const BoxProblem& problem, const Times& times) {
    const double bytes = bytes_per_product(problem.objective->matrix());
    const double work_rate = bytes * static_cast<double>(state.iterations()) / times.work;
    const double read_rate = times.read_bytes / times.read;
    state.counters["num_tets"] = problem.model.num_tets();
    state.counters["num_vertices"] = problem.model.num_vertices;
    state.counters["bytes_per_product"] = bytes;
    state.counters["product_gb_s"] = 1e-9 * work_rate;
    state.counters["read_gb_s"] = 1e-9 * read_rate;
    state.counters["percent_of_read"] = 100.0 * work_rate / read_rate;
}

Reader reader_of(const BlockMatrix<CpuExec>& matrix) {
    return {matrix.values().data, static_cast<std::size_t>(bytes_of(matrix.values()))};
}

void multiply(benchmark::State& state) {
    BoxProblem& problem = box_problem(static_cast<int>(state.range(0)));
    const BlockMatrix<CpuExec>& matrix = problem.objective->matrix();
    Reader reader = reader_of(matrix);
    std::vector<Vec3d> y(problem.b.size());
    const View<Vec3d> out{y.data(), static_cast<int>(y.size())};
    Times times;
    Arena(static_cast<int>(state.range(1))).run([&] {
        CpuExec exec;
        [[maybe_unused]] const auto threads = exec.stand_by();
        matrix.multiply(exec, view(problem.b), out);
        for (auto _ : state) {
            times.read += seconds([&] { reader.read(exec); });
            times.read_bytes += reader.bytes();
            const double s =
                seconds([&] { matrix.multiply(exec, view(problem.b), out); });
            times.work += s;
            state.SetIterationTime(s);
        }
    });
    report(state, problem, times);
}

/// Seconds of a solve that is stopped after that many iterations.
double solve(CpuExec& exec,
             Pcg<CpuExec>& pcg,
             BoxProblem& problem,
             PreconditionerKind kind,
             int iterations,
             std::vector<Vec3d>& x) {
    const PcgOptions options{
        .tolerance = 1e-300, .max_iterations = iterations, .preconditioner = kind};
    const int n = problem.model.num_vertices;
    return seconds([&] {
        pcg.solve(exec,
                  problem.objective->matrix(),
                  problem.objective->terms(),
                  view(problem.b),
                  {problem.fixed.data(), n},
                  options,
                  {x.data(), n});
    });
}

/// The difference of a long and a short solve: what one iteration takes, without setup.
void pcg_iteration(benchmark::State& state, PreconditionerKind kind) {
    constexpr int kShort = 2;
    constexpr int kLong = 22;
    BoxProblem& problem = box_problem(static_cast<int>(state.range(0)));
    Reader reader = reader_of(problem.objective->matrix());
    std::vector<Vec3d> x(problem.b.size());
    Times times;
    double setup = 0.0;
    Arena(static_cast<int>(state.range(1))).run([&] {
        CpuExec exec;
        Pcg<CpuExec> pcg;
        solve(exec, pcg, problem, kind, kShort, x);
        for (auto _ : state) {
            const double few = solve(exec, pcg, problem, kind, kShort, x);
            const double many = solve(exec, pcg, problem, kind, kLong, x);
            const double s = (many - few) / (kLong - kShort);
            times.work += s;
            setup += few - kShort * s;
            state.SetIterationTime(s);
            [[maybe_unused]] const auto threads = exec.stand_by();
            reader.read(exec);
            times.read += seconds([&] { reader.read(exec); });
            times.read_bytes += reader.bytes();
        }
    });
    report(state, problem, times);
    state.counters["setup_s"] = setup / static_cast<double>(state.iterations());
}

void sizes(benchmark::internal::Benchmark* b) {
    b->ArgNames({"tets", "threads"})->UseManualTime()->Unit(benchmark::kMicrosecond);
    for (const int tets : {10'000, 100'000, 1'000'000}) {
        b->Args({tets, 1});
        if (all_threads() > 1) b->Args({tets, all_threads()});
    }
}

}  // namespace
}  // namespace noli::bench

int main(int argc, char** argv) {
    using namespace noli::bench;
    benchmark::RegisterBenchmark("multiply", multiply)->Apply(sizes);
    for (const auto& [name, kind] : kPreconditioners)
        benchmark::RegisterBenchmark(
            (std::string("pcg_iteration/") + name).c_str(),
            [kind = kind](benchmark::State& state) { pcg_iteration(state, kind); })
            ->Apply(sizes)
            ->Iterations(4);
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
