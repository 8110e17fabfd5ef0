// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Small meshes with all that a loop over tetrahedra may stumble over.

#include "linear/block_pattern.hpp"
#include "model/model.hpp"

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

namespace noli::test {

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

inline std::vector<RandomMesh> meshes() {
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

}  // namespace noli::test
