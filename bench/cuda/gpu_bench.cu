// SPDX-License-Identifier: Apache-2.0
/// What one GPU does, as CSV on the standard output: copy bandwidth, the bandwidth that
/// the products of a linear solve achieve, and per scene the launches, waits and bytes
/// over the bus of a step. `make gpu-check` runs it; nothing else uses it.
///
///     noli_bench_gpu [scene.json steps]...
#include "noli/scene.hpp"

#include "exec/cuda.cuh"
#include "linear/device_pcg.hpp"
#include "sim/engine_on.hpp"
#include "sim/step_settings.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

namespace noli {
namespace {

using Clock = std::chrono::steady_clock;

/// Median of nine times f, s.
template <class F>
double seconds(CudaExec& exec, const F& f) {
    std::vector<double> all;
    for (int k = 0; k < 10; ++k) {
        exec.wait();
        const auto start = Clock::now();
        f();
        exec.wait();
        all.push_back(std::chrono::duration<double>(Clock::now() - start).count());
    }
    all.erase(all.begin());  // the first one loads the kernel
    std::sort(all.begin(), all.end());
    return all[all.size() / 2];
}

void print(const char* what, const std::string& subject, double value, const char* unit) {
    std::printf("%s,%s,%.6g,%s\n", what, subject.c_str(), value, unit);
}

double copy_bandwidth(CudaExec& exec) {
    constexpr int kDoubles = 1 << 26;  // 512 MB
    CudaBuffer<double> a, b;
    a.resize(kDoubles);
    b.resize(kDoubles);
    const View<double> cleared = a.view();
    exec.for_each("bench/clear", kDoubles, [=] NOLI_HD(int i) { cleared[i] = 1.0; });
    const View<const double> from = a.view();
    const View<double> to = b.view();
    const double s = seconds(exec, [&] {
        exec.for_each("bench/copy", kDoubles, [=] NOLI_HD(int i) { to[i] = from[i]; });
    });
    return 16.0 * kDoubles / s;
}

/// A box of n^3 cubes of six tetrahedra: block rows as in any tetrahedral mesh.
std::vector<Int4> box_tets(int n) {
    std::vector<Int4> tets;
    const auto id = [n](int i, int j, int k) { return (i * (n + 1) + j) * (n + 1) + k; };
    constexpr int kPaths[6][3] = {
        {0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            for (int k = 0; k < n; ++k)
                for (const auto& path : kPaths) {
                    int at[3] = {i, j, k};
                    Int4 tet{{id(i, j, k), 0, 0, 0}};
                    for (int c = 0; c < 3; ++c) {
                        ++at[path[c]];
                        tet[c + 1] = id(at[0], at[1], at[2]);
                    }
                    tets.push_back(tet);
                }
    return tets;
}

void bench_product(CudaExec& exec, double copy) {
    for (const int n : {20, 60, 90}) {
        const int num_vertices = (n + 1) * (n + 1) * (n + 1);
        BlockMatrix<CudaExec> matrix;
        const std::vector<Int4> tets = box_tets(n);
        matrix.set_pattern(exec, build_block_pattern(num_vertices, tets));
        CudaBuffer<Vec3d> x, y;
        CudaBuffer<double> blocks, diagonal;
        x.resize(num_vertices);
        y.resize(num_vertices);
        blocks.resize(kDoublesPerElement * static_cast<int>(tets.size()));
        diagonal.resize(num_vertices);
        const View<double> filled = blocks.view();
        exec.for_each("bench/fill", filled.size, [=] NOLI_HD(int i) {
            filled[i] = 1e-3 * (i % 7);
        });
        detail::set_zero(exec, x.view());
        detail::set_zero(exec, diagonal.view());
        matrix.assemble(exec, blocks.view(), diagonal.view());
        const View<const Vec3d> in = x.view();
        const double s = seconds(exec, [&] { matrix.multiply(exec, in, y.view()); });
        const double bytes = 76.0 * matrix.num_blocks() + 52.0 * num_vertices;
        const std::string name = std::to_string(num_vertices) + " vertices";
        print("product", name, 1e-9 * bytes / s, "GB/s");
        print("product share of copy", name, bytes / s / copy, "");
    }
}

void bench_scene(const std::string& path, int steps) {
    const Result<Scene> scene = read_scene(path);
    const Result<Model> model = scene ? build_model(scene.value()) : scene.error();
    if (!model) {
        std::fprintf(stderr, "%s: %s\n", path.c_str(), model.error().message.c_str());
        return;
    }
    const BlockPattern pattern =
        build_block_pattern(model.value().num_vertices, model.value().tets);
    const StepSettings settings = step_settings(scene.value(), model.value());
    EngineOn<CudaExec> engine(
        {model.value(), pattern, settings, scene.value().gravity, 0});
    const CudaCounts before = engine.exec().counts();
    int newton = 0;
    int done = 0;
    for (; done < steps; ++done) {
        const StepReport report = engine.step();
        newton += report.newton;
        if (report.outcome != Outcome::Converged) break;
    }
    const CudaCounts& after = engine.exec().counts();
    const double n = std::max(1, done);
    print("launches per step", path, (after.launches - before.launches) / n, "");
    print("waits per step", path, (after.waits - before.waits) / n, "");
    print("bus bytes per step", path, (after.bus_bytes - before.bus_bytes) / n, "bytes");
    print("newton per step", path, newton / n, "");
}

}  // namespace
}  // namespace noli

int main(int argc, char** argv) {
    try {
        cudaDeviceProp properties{};
        noli::check_cuda(cudaGetDeviceProperties(&properties, 0), "look at the GPU");
        std::printf("figure,subject,value,unit\n");
        std::printf("device,%s,,\n", properties.name);
        noli::CudaExec exec;
        const double copy = noli::copy_bandwidth(exec);
        noli::print("copy", "512 MB", 1e-9 * copy, "GB/s");
        noli::bench_product(exec, copy);
        for (int k = 1; k + 1 < argc; k += 2)
            noli::bench_scene(argv[k], std::atoi(argv[k + 1]));
    } catch (const std::exception& trouble) {
        std::fprintf(stderr, "noli_bench_gpu: %s\n", trouble.what());
        return 1;
    }
    return 0;
}
