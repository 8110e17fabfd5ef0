// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Seeded random dense blocks for the tests of linear/warp_product.hpp, with their plain
/// product.

#include "linear/warp_product.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

namespace noli::test {

/// Blocks of m x m that are not symmetric, so that rows and columns cannot be mixed up.
template <int m, int kDim = 3>
struct RandomBlocks {
    static constexpr int kPoints = m / kDim;
    int num_vertices;
    std::vector<double> values;
    std::vector<int> vertices;
    std::vector<double> c;

    RandomBlocks(int num_blocks, int num_vertices_, unsigned seed)
        : num_vertices(num_vertices_) {
        std::mt19937 rng(seed);
        std::normal_distribution<double> normal;
        std::vector<int> all(static_cast<std::size_t>(num_vertices));
        std::iota(all.begin(), all.end(), 0);
        for (int b = 0; b < num_blocks; ++b) {
            std::shuffle(all.begin(), all.end(), rng);
            vertices.insert(vertices.end(), all.begin(), all.begin() + kPoints);
        }
        for (int i = 0; i < m * m * num_blocks; ++i)
            values.push_back(normal(rng));
        for (int i = 0; i < kDim * num_vertices; ++i)
            c.push_back(normal(rng));
    }

    [[nodiscard]] DenseBlockView<m, kDim> view() const {
        return {{values.data(), static_cast<int>(values.size())},
                {vertices.data(), static_cast<int>(vertices.size())}};
    }
    [[nodiscard]] View<const double> c_view() const {
        return {c.data(), static_cast<int>(c.size())};
    }
    /// H c over the entries of `range`, one entry after the other.
    [[nodiscard]] Eigen::VectorXd product(EntryRange range) const {
        Eigen::VectorXd y = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(c.size()));
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
            const auto index = static_cast<int>(i);
            const int* v = vertices.data() + kPoints * (index / (m * m));
            const int row = index % (m * m) / m;
            const int col = index % m;
            y[kDim * v[row / kDim] + row % kDim] +=
                values[i]
                * c[static_cast<std::size_t>(kDim * v[col / kDim] + col % kDim)];
        }
        return y;
    }
    [[nodiscard]] Eigen::VectorXd product() const { return product(all_entries()); }
    [[nodiscard]] EntryRange all_entries() const {
        return {0, static_cast<std::uint32_t>(values.size())};
    }
};

inline double relative_error(const std::vector<double>& y,
                             const Eigen::VectorXd& expected) {
    const Eigen::Map<const Eigen::VectorXd> map(y.data(),
                                                static_cast<Eigen::Index>(y.size()));
    return (map - expected).norm() / expected.norm();
}

}  // namespace noli::test
