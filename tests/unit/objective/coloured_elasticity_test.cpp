// SPDX-License-Identifier: Apache-2.0
/// Assembly by coloured blocks against the gather, and its bits on all executors.

#include "objective/coloured_elasticity.hpp"

#include "exec/cpu.hpp"
#include "objective/elastic_assembly.hpp"
#include "random_mesh.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <numeric>
#include <vector>

namespace noli {
namespace {

using namespace test;

/// Values of the matrix, then the gradient.
template <class Exec, class Assemble>
std::vector<double> assembled(const RandomMesh& mesh, const Assemble& assemble) {
    Exec exec;
    DeviceModel<Exec> device;
    device.upload(exec, mesh.model);
    BlockMatrix<Exec> matrix;
    matrix.set_pattern(exec, mesh.pattern);
    std::vector<Vec3d> gradient = mesh.x;
    assemble(exec,
             device,
             View<Vec3d>{gradient.data(), static_cast<int>(gradient.size())},
             matrix);
    std::vector<double> out;
    for (const Mat3d& m : matrix.values())
        out.insert(out.end(), m.a, m.a + 9);
    for (const Vec3d& g : gradient)
        out.insert(out.end(), {g.x, g.y, g.z});
    return out;
}

template <class Exec>
std::vector<double> by_gather(const RandomMesh& mesh) {
    GatheredElasticity<Exec> elasticity(mesh.model, mesh.pattern);
    return assembled<Exec>(mesh,
                           [&](auto& exec, auto& device, auto gradient, auto& matrix) {
                               elasticity.assemble(exec,
                                                   device,
                                                   view_of(mesh.x),
                                                   1e-4,
                                                   view_of(mesh.diagonal),
                                                   gradient,
                                                   matrix);
                           });
}

template <class Exec>
std::vector<double> by_colours(const RandomMesh& mesh,
                               LaneDispatch dispatch = lane_dispatch()) {
    const ColouredElasticity elasticity(mesh.model, mesh.pattern);
    return assembled<Exec>(mesh,
                           [&](auto& exec, auto& device, auto gradient, auto& matrix) {
                               elasticity.assemble(exec,
                                                   device,
                                                   view_of(mesh.x),
                                                   1e-4,
                                                   view_of(mesh.diagonal),
                                                   gradient,
                                                   matrix,
                                                   true,
                                                   dispatch);
                           });
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
    return a.size() == b.size()
        && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

double largest(std::vector<double>::const_iterator begin,
               std::vector<double>::const_iterator end) {
    return std::accumulate(
        begin, end, 0.0, [](double m, double v) { return std::fmax(m, std::fabs(v)); });
}

TEST(ColouredElasticity, EqualsTheGather) {
    for (const RandomMesh& mesh : meshes()) {
        const std::vector<double> expected = by_gather<SerialExec>(mesh);
        const std::vector<double> got = by_colours<SerialExec>(mesh);
        ASSERT_EQ(got.size(), expected.size());
        const auto num_values = static_cast<std::ptrdiff_t>(9 * mesh.pattern.col.size());
        const auto split = expected.begin() + num_values;
        const double matrix_size = largest(expected.begin(), split);
        const double gradient_size = largest(split, expected.end());
        for (std::size_t i = 0; i < got.size(); ++i)
            EXPECT_NEAR(
                got[i],
                expected[i],
                1e-13
                    * (static_cast<std::ptrdiff_t>(i) < num_values ? matrix_size
                                                                   : gradient_size));
    }
}

TEST(ColouredElasticity, IsExactlySymmetric) {
    const RandomMesh mesh(4, 5, 3, 0.2, 6U);
    const std::vector<double> got = by_colours<SerialExec>(mesh);
    for (int u = 0; u < mesh.pattern.num_upper(); ++u)
        for (int k = 0; k < 9; ++k) {
            const auto at = [&](int block, int entry) {
                return got[static_cast<std::size_t>(9 * block + entry)];
            };
            EXPECT_EQ(
                at(mesh.pattern.upper[static_cast<std::size_t>(u)], k),
                at(mesh.pattern.lower[static_cast<std::size_t>(u)], k % 3 * 3 + k / 3));
        }
}

TEST(ColouredElasticity, HasTheSameBitsOnEveryExecutorAndThreadCount) {
    for (const RandomMesh& mesh : meshes()) {
        const std::vector<double> reference = by_colours<SerialExec>(mesh);
        EXPECT_TRUE(same_bits(by_colours<ShuffledExec>(mesh), reference));
        for (const std::size_t threads : {1, 2, 3, 4}) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                            threads);
            EXPECT_TRUE(same_bits(by_colours<CpuExec>(mesh), reference)) << threads;
        }
    }
}

TEST(ColouredElasticity, HasTheSameBitsForEveryWidth) {
    for (const RandomMesh& mesh : meshes()) {
        const std::vector<double> reference =
            by_colours<SerialExec>(mesh, LaneDispatch::Width2);
        for (const LaneDispatch width : {LaneDispatch::Width4, LaneDispatch::Width8}) {
            if (width > lane_dispatch()) continue;
            EXPECT_TRUE(same_bits(by_colours<SerialExec>(mesh, width), reference));
        }
    }
}

TEST(ColouredElasticity, LeavesTheGradientAloneWhereNoneIsAsked) {
    const RandomMesh mesh(3, 3, 3, 0.1, 5U);
    const ColouredElasticity elasticity(mesh.model, mesh.pattern);
    const auto with = by_colours<SerialExec>(mesh);
    const auto without = assembled<SerialExec>(
        mesh, [&](auto& exec, auto& device, auto /*gradient*/, auto& matrix) {
            elasticity.assemble(
                exec, device, view_of(mesh.x), 1e-4, view_of(mesh.diagonal), {}, matrix);
        });
    const auto split = static_cast<std::ptrdiff_t>(9 * mesh.pattern.col.size());
    EXPECT_TRUE(same_bits({with.begin(), with.begin() + split},
                          {without.begin(), without.begin() + split}));
    for (std::size_t v = 0; v < mesh.x.size(); ++v)
        EXPECT_EQ(without[static_cast<std::size_t>(split) + 3 * v], mesh.x[v].x);
}

}  // namespace
}  // namespace noli
