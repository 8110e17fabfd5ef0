// SPDX-License-Identifier: Apache-2.0
/// Time per tetrahedron of energy + gradient + projected Hessian, one thread, data in
/// cache, without and with the barrier against crushing that the engine always adds.
/// NOLI_SIMD=2|4|8 in the environment chooses the pack width.

#include "core/pack.hpp"
#include "energy/tet.hpp"
#include "exec/cpu.hpp"

#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstring>
#include <random>
#include <type_traits>
#include <vector>

namespace noli {
namespace {

constexpr int kNumTets = 1024;
constexpr int kShapeValues = 24;    // 12 positions, 9 of dm_inv, weight, mu, lambda
constexpr int kResultValues = 103;  // energy, 12, 10 blocks

/// Blocks of 8 tetrahedra; within a block the 8 copies of a value lie together. (One
/// array per value would put all values of a tetrahedron into the same cache set.)
template <int kNumRows>
struct Blocks {
    static constexpr int kWidth = 8;
    double* values;

    [[nodiscard]] double* at(int row, int tet) const {
        return values + (tet / kWidth * kNumRows + row) * kWidth + tet % kWidth;
    }
    template <class T>
    [[nodiscard]] T load(int row, int tet) const {
        if constexpr (std::is_same_v<T, double>) {
            return *at(row, tet);
        } else {
            typename T::Raw raw;
            std::memcpy(&raw, at(row, tet), sizeof(raw));
            return T::from(raw);
        }
    }
    template <class T>
    void store(int row, int tet, const T& value) const {
        if constexpr (std::is_same_v<T, double>)
            *at(row, tet) = value;
        else
            std::memcpy(at(row, tet), &value.v, sizeof(value.v));
    }
};

template <ElasticModel M, bool kResist>
struct DerivativesKernel {
    Blocks<kShapeValues> in;
    Blocks<kResultValues> out;

    template <class T>
    void operator()(Lane<T> lane) const {
        const int i = lane.first;
        const auto vec = [&](int row) {
            return Vec3<T>{in.template load<T>(row, i),
                           in.template load<T>(row + 1, i),
                           in.template load<T>(row + 2, i)};
        };
        const Vec3<T> r0 = vec(12);
        const Vec3<T> r1 = vec(15);
        const Vec3<T> r2 = vec(18);
        const TetShape<T> tet{{vec(0), vec(3), vec(6), vec(9)},
                              {r0.x, r0.y, r0.z, r1.x, r1.y, r1.z, r2.x, r2.y, r2.z},
                              in.template load<T>(21, i)};
        const LameParameters<T> lame{in.template load<T>(22, i),
                                     in.template load<T>(23, i)};
        const TetDerivatives<T> d = tet_derivatives<M, kResist>(tet, lame);
        out.store(0, i, d.energy);
#pragma GCC unroll 4
        for (int v = 0; v < 4; ++v) {
            out.store(1 + 3 * v, i, d.gradient.g[v].x);
            out.store(2 + 3 * v, i, d.gradient.g[v].y);
            out.store(3 + 3 * v, i, d.gradient.g[v].z);
        }
#pragma GCC unroll 10
        for (int b = 0; b < 10; ++b) {
#pragma GCC unroll 9
            for (int k = 0; k < 9; ++k)
                out.store(13 + 9 * b + k, i, d.hessian.block[b].a[k]);
        }
    }
};

std::vector<double> random_tets() {
    std::vector<double> values(kShapeValues * kNumTets);
    std::mt19937 rng(1);
    std::uniform_real_distribution<double> noise(-0.2, 0.2);
    for (int i = 0; i < kNumTets; ++i) {
        const Blocks<kShapeValues> blocks{values.data()};
        const auto at = [&](int row) -> double& { return *blocks.at(row, i); };
        for (int row = 0; row < 12; ++row)
            at(row) = noise(rng);
        for (int a = 0; a < 3; ++a) {
            at(3 * (a + 1) + a) += 1.0;
            at(12 + 4 * a) = 1.0;
        }
        at(21) = 1.0 / 6.0;
        at(22) = 4e5;
        at(23) = 1e6;
    }
    return values;
}

template <ElasticModel M, bool kResist>
void derivatives(benchmark::State& state) {
    std::vector<double> in = random_tets();
    std::vector<double> out(kResultValues * kNumTets);
    SerialExec exec;
    for (auto _ : state) {
        exec.for_lanes("bench/elastic",
                       kNumTets,
                       DerivativesKernel<M, kResist>{{in.data()}, {out.data()}});
        benchmark::ClobberMemory();
    }
    state.counters["per_tet"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * kNumTets,
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK(derivatives<ElasticModel::StableNeoHookean, false>)->Name("stable_neo_hookean");
BENCHMARK(derivatives<ElasticModel::StableNeoHookean, true>)
    ->Name("stable_neo_hookean/resisting");
BENCHMARK(derivatives<ElasticModel::NeoHookean, false>)->Name("neo_hookean");
BENCHMARK(derivatives<ElasticModel::NeoHookean, true>)->Name("neo_hookean/resisting");
BENCHMARK(derivatives<ElasticModel::FixedCorotated, false>)->Name("fixed_corotated");
BENCHMARK(derivatives<ElasticModel::FixedCorotated, true>)
    ->Name("fixed_corotated/resisting");

}  // namespace
}  // namespace noli

BENCHMARK_MAIN();
