// SPDX-License-Identifier: Apache-2.0
/// Assembly by coloured blocks against the gather, and its bits on all executors.

#include "objective/coloured_elasticity.hpp"

#include "exec/cpu.hpp"
#include "objective/elastic_assembly.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <random>
#include <vector>

namespace noli {
namespace {

/// A grid of cubes, six tetrahedra each, with vertices in random order, corners turned at
/// random, a random elastic model for each tetrahedron, and two vertices without any.
class RandomMesh {
  public:
    RandomMesh(int nx, int ny, int nz, double noise, unsigned seed) : random_(seed) {
        const int n[3] = {nx, ny, nz};
        place_vertices(n, noise);
        std::vector<Int4> tets[kNumElasticModels];
        std::uniform_int_distribution<int> any_model(0, kNumElasticModels - 1);
        for (int i = 0; i < nx; ++i)
            for (int j = 0; j < ny; ++j)
                for (int k = 0; k < nz; ++k)
                    for (int path = 0; path < 6; ++path)
                        tets[any_model(random_)].push_back(tet_along(n, i, j, k, path));
        for (int m = 0; m < kNumElasticModels; ++m) {
            for (const Int4& tet : tets[m])
                add(tet);
            model.model_begin[static_cast<std::size_t>(m) + 1] = model.num_tets();
        }
        pattern = build_block_pattern(model.num_vertices, model.tets);
        x = rattled(noise);
        for (int v = 0; v < model.num_vertices; ++v)
            diagonal.push_back(uniform(0.1, 1.0));
    }

    Model model;
    BlockPattern pattern;
    std::vector<Vec3d> x;
    std::vector<double> diagonal;

  private:
    double uniform(double a, double b) {
        return std::uniform_real_distribution<double>(a, b)(random_);
    }

    std::vector<Vec3d> rattled(double size) {
        std::vector<Vec3d> out = model.x0;
        for (Vec3d& p : out)
            p += Vec3d{uniform(-size, size), uniform(-size, size), uniform(-size, size)};
        return out;
    }

    void place_vertices(const int (&n)[3], double noise) {
        model.num_vertices = (n[0] + 1) * (n[1] + 1) * (n[2] + 1) + 2;
        number_.resize(static_cast<std::size_t>(model.num_vertices));
        std::iota(number_.begin(), number_.end(), 0);
        std::shuffle(number_.begin(), number_.end(), random_);
        model.x0.resize(number_.size());
        for (int i = 0; i <= n[0]; ++i)
            for (int j = 0; j <= n[1]; ++j)
                for (int k = 0; k <= n[2]; ++k)
                    at(vertex(n, i, j, k)) = {1.0 * i, 1.0 * j, 1.0 * k};
        model.x0 = rattled(0.5 * noise);
    }

    Vec3d& at(int v) { return model.x0[static_cast<std::size_t>(v)]; }

    [[nodiscard]] int vertex(const int (&n)[3], int i, int j, int k) const {
        return number_[static_cast<std::size_t>((i * (n[1] + 1) + j) * (n[2] + 1) + k)];
    }

    /// From the cube's lowest corner to its highest along the axes in one of six orders.
    Int4 tet_along(const int (&n)[3], int i, int j, int k, int path) {
        int axes[3] = {0, 1, 2};
        for (int p = 0; p < path; ++p)
            std::next_permutation(axes, axes + 3);
        int corner[3] = {i, j, k};
        Int4 tet;
        tet[0] = vertex(n, i, j, k);
        for (int c = 0; c < 3; ++c) {
            ++corner[axes[c]];
            tet[c + 1] = vertex(n, corner[0], corner[1], corner[2]);
        }
        std::shuffle(tet.v, tet.v + 4, random_);
        return tet;
    }

    void add(Int4 tet) {
        const auto edges = [&] {
            return from_columns(at(tet[1]) - at(tet[0]),
                                at(tet[2]) - at(tet[0]),
                                at(tet[3]) - at(tet[0]));
        };
        if (det(edges()) < 0.0) std::swap(tet[2], tet[3]);
        model.tets.push_back(tet);
        model.dm_inv.push_back(inverse(edges()));
        model.volume.push_back(det(edges()) / 6.0);
        model.mu.push_back(uniform(1e4, 1e6));
        model.lambda.push_back(uniform(1e4, 1e6));
    }

    std::mt19937 random_;
    std::vector<int> number_;
};

std::vector<RandomMesh> meshes() {
    std::vector<RandomMesh> out;
    out.emplace_back(1, 1, 1, 0.05, 1U);
    out.emplace_back(3, 2, 5, 0.15, 2U);
    out.emplace_back(9, 7, 5, 0.1, 3U);
    out.emplace_back(5, 6, 7, 0.35, 4U);  // some elements crushed or inverted
    return out;
}

template <class T>
View<const T> view_of(const std::vector<T>& v) {
    return {v.data(), static_cast<int>(v.size())};
}

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
