// SPDX-License-Identifier: Apache-2.0
#include "linear/rigid_aggregates.hpp"

#include "box_grid.hpp"
#include "core/morton.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

namespace noli {
namespace {

using namespace test;

/// Vertex sets of what the tetrahedra connect, found by spreading labels.
std::vector<int> labels_of_pieces(const TetGrid& grid) {
    std::vector<int> label(grid.x.size());
    for (std::size_t v = 0; v < label.size(); ++v)
        label[v] = static_cast<int>(v);
    bool changed = true;
    while (changed) {
        changed = false;
        for (const Int4& tet : grid.tets) {
            int least = label[static_cast<std::size_t>(tet[0])];
            for (const int v : tet.v)
                least = std::min(least, label[static_cast<std::size_t>(v)]);
            for (const int v : tet.v) {
                int& own = label[static_cast<std::size_t>(v)];
                changed = changed || own != least;
                own = least;
            }
        }
    }
    return label;
}

/// Boxes that overlap in space but share no vertex, and loose vertices among them.
TetGrid boxes_with_loose_vertices() {
    TetGrid all;
    const auto add_loose = [&all](int n) {
        for (int k = 0; k < n; ++k)
            all.x.push_back({0.1 * k, 0.37, 0.2});
    };
    add_loose(3);
    add_box(all, {9, 7, 5}, {0, 0, 0}, 0.125);
    add_loose(7);
    add_box(all, {9, 7, 5}, {0.05, 0.03, 0.02}, 0.125);  // inside each other
    add_box(all, {1, 1, 1}, {0.5, 0.5, 0.3}, 0.125);     // eight vertices
    add_box(all, {20, 1, 1}, {0.0, 0.2, 0.1}, 0.04);
    add_loose(2);
    return all;
}

void expect_sound(const TetGrid& grid, const std::vector<int>& order, int size) {
    const RigidAggregates got = cut_aggregates(grid.tets, order, size);
    ASSERT_EQ(got.of_vertex.size(), grid.x.size());
    std::set<int> elastic;
    for (const Int4& tet : grid.tets)
        elastic.insert(std::begin(tet.v), std::end(tet.v));

    const std::vector<int> piece = labels_of_pieces(grid);
    std::map<int, int> piece_size;
    std::map<int, std::vector<int>> members;
    for (int v = 0; v < static_cast<int>(grid.x.size()); ++v) {
        const int aggregate = got.of_vertex[static_cast<std::size_t>(v)];
        if (elastic.count(v) == 0) {
            EXPECT_EQ(aggregate, -1) << v;
            continue;
        }
        ASSERT_GE(aggregate, 0) << v;
        ASSERT_LT(aggregate, got.count) << v;
        members[aggregate].push_back(v);
        ++piece_size[piece[static_cast<std::size_t>(v)]];
    }
    EXPECT_EQ(members.size(), static_cast<std::size_t>(got.count));  // none is empty
    for (const auto& [aggregate, vertices] : members) {
        const int own = piece[static_cast<std::size_t>(vertices[0])];
        for (const int v : vertices)
            EXPECT_EQ(piece[static_cast<std::size_t>(v)], own);
        const int count = static_cast<int>(vertices.size());
        EXPECT_LE(count, 2 * size);
        EXPECT_GE(2 * count, std::min(size, 2 * piece_size[own]));
    }
}

TEST(CutAggregates, CoversEveryElasticVertexAndJoinsNoTwoPieces) {
    const TetGrid grid = boxes_with_loose_vertices();
    for (const int size : {1, 2, 3, 8, 16, 31, 32, 33, 64, 400, 5000})
        expect_sound(grid, morton_order(grid.x), size);
}

TEST(CutAggregates, DoesSoInAnyOrderOfTheVertices) {
    const TetGrid grid = boxes_with_loose_vertices();
    std::vector<int> order = morton_order(grid.x);
    std::mt19937 rng(3);
    for (int trial = 0; trial < 3; ++trial) {
        std::shuffle(order.begin(), order.end(), rng);
        expect_sound(grid, order, 32);
    }
}

TEST(CutAggregates, AreRunsOfTheOrder) {
    TetGrid grid;
    add_box(grid, {6, 6, 6}, {0, 0, 0}, 0.1);
    const std::vector<int> order = morton_order(grid.x);
    const RigidAggregates got = cut_aggregates(grid.tets, order, 32);
    EXPECT_EQ(got.count, 11);  // 343 vertices
    int last = 0;
    for (const int v : order) {
        const int aggregate = got.of_vertex[static_cast<std::size_t>(v)];
        EXPECT_GE(aggregate, last);
        last = aggregate;
    }
}

TEST(CutAggregates, AreNoneWithoutTetrahedra) {
    const std::vector<int> order{2, 0, 1};
    const RigidAggregates got = cut_aggregates({}, order, 32);
    EXPECT_TRUE(got.empty());
    EXPECT_EQ(got.of_vertex, (std::vector<int>{-1, -1, -1}));
    EXPECT_TRUE(cut_aggregates({}, {}, 32).empty());
}

TEST(AggregateSize, GrowsWithTheMeshSoThatTheCoarseMatrixStaysSmall) {
    EXPECT_EQ(aggregate_size(10), 32);
    EXPECT_EQ(aggregate_size(20000), 32);
    for (const int n : {100000, 300000, 2000000})
        EXPECT_NEAR(static_cast<double>(n) / aggregate_size(n), 1000.0, 25.0);
}

}  // namespace
}  // namespace noli
