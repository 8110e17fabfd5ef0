// SPDX-License-Identifier: Apache-2.0
#include "linear/rigid_aggregates.hpp"

#include "core/index.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>

namespace noli {

namespace {

constexpr int kSmallest = 32;
constexpr int kMost = 1000;

using detail::at;

int find_root(std::vector<int>& parent, int v) {
    while (parent[at(v)] != v) {
        parent[at(v)] = parent[at(parent[at(v)])];
        v = parent[at(v)];
    }
    return v;
}

/// Per vertex: a vertex that stands for its connected piece.
std::vector<int> find_pieces(std::span<const Int4> tets, std::size_t num_vertices) {
    std::vector<int> parent(num_vertices);
    std::iota(parent.begin(), parent.end(), 0);
    for (const Int4& tet : tets)
        for (int c = 1; c < 4; ++c) {
            const int a = find_root(parent, tet[0]);
            const int b = find_root(parent, tet[c]);
            parent[at(std::max(a, b))] = std::min(a, b);
        }
    for (int v = 0; v < static_cast<int>(num_vertices); ++v)
        parent[at(v)] = find_root(parent, v);
    return parent;
}

}  // namespace

int aggregate_size(int num_vertices) {
    return std::max(kSmallest, num_vertices / kMost);
}

RigidAggregates cut_aggregates(std::span<const Int4> tets,
                               std::span<const int> order,
                               int size) {
    const std::vector<int> piece = find_pieces(tets, order.size());
    std::vector<int> piece_size(order.size(), 0);
    std::vector<char> elastic(order.size(), 0);
    for (const Int4& tet : tets)
        for (const int v : tet.v)
            elastic[at(v)] = 1;
    for (const int v : order)
        ++piece_size[at(piece[at(v)])];

    RigidAggregates out;
    out.of_vertex.assign(order.size(), -1);
    // Of each piece: vertices seen, and the aggregate that takes the next one.
    std::vector<int> seen(order.size(), 0);
    std::vector<int> current(order.size(), -1);
    for (const int v : order) {
        if (elastic[at(v)] == 0) continue;
        const std::size_t p = at(piece[at(v)]);
        const int runs = std::max(1, (piece_size[p] + size / 2) / size);
        const auto run_of = [&](int k) {
            return static_cast<int>(static_cast<std::int64_t>(k) * runs / piece_size[p]);
        };
        if (seen[p] == 0 || run_of(seen[p]) != run_of(seen[p] - 1))
            current[p] = out.count++;
        ++seen[p];
        out.of_vertex[at(v)] = current[p];
    }
    return out;
}

}  // namespace noli
