// SPDX-License-Identifier: Apache-2.0
#include "contact/bvh.hpp"

#include "contact_shapes.hpp"

#include <cstring>
#include <numeric>

namespace noli {
namespace {

using namespace contact_test;

struct Tree {
    BvhOrder<SerialExec, int> order;
    BvhBoxes<SerialExec, StaticBox, int> boxes;
    BvhView<StaticBox, int> view;
};

Tree tree_of_points(const std::vector<Vec3d>& x, double gap) {
    SerialExec exec;
    std::vector<int> ids(x.size());
    std::iota(ids.begin(), ids.end(), 0);
    const View<const int> id_view{ids.data(), int(ids.size())};
    Tree tree;
    tree.order.sort(
        exec, id_view, detail::grid_around(exec, id_view, view_of(x)), view_of(x));
    tree.boxes.refit(exec, tree.order, Motion{view_of(x), {}, 0.0}, gap);
    tree.view = tree.boxes.view(tree.order);
    return tree;
}

struct LeafList {
    std::vector<int> leaves;
    void operator()(int leaf) { leaves.push_back(leaf); }
};

TEST(Bvh, LevelsEndInOneBlock) {
    EXPECT_EQ(bvh_levels(0).count, 0);
    EXPECT_EQ(bvh_levels(1).count, 1);
    EXPECT_EQ(bvh_levels(4).count, 1);
    EXPECT_EQ(bvh_levels(5).count, 2);
    const BvhLevels levels = bvh_levels(1000000000);
    ASSERT_LE(levels.count, kMaxLevels);
    EXPECT_EQ(levels.offset[levels.count] - levels.offset[levels.count - 1], 1);
    EXPECT_EQ(levels.num_leaves(), 250000000);
}

TEST(Bvh, VisitsEveryLeafWhoseBoxOverlapsTheQuery) {
    std::mt19937 rng(1);
    for (const int n : {1, 2, 3, 4, 5, 7, 16, 17, 33, 63, 64, 65, 257, 1001}) {
        std::vector<Vec3d> x;
        for (int i = 0; i < n; ++i)
            x.push_back(random_vector(rng, 1.0));
        const Tree tree = tree_of_points(x, 0.02);
        const int leaves = tree.view.levels.num_leaves();
        for (int q = 0; q < 40; ++q) {
            StaticBox query = empty_static_box();
            add_point(query, random_vector(rng, 1.0), 0.3);
            const int first_leaf = q % 2 == 0 ? 0 : int(rng() % unsigned(leaves));
            LeafList packed;
            LeafList plain;
            visit_leaves<false>(tree.view, query, first_leaf, packed);
            visit_leaves<true>(tree.view, query, first_leaf, plain);
            EXPECT_EQ(packed.leaves, plain.leaves);
            std::sort(packed.leaves.begin(), packed.leaves.end());
            for (int leaf = first_leaf; leaf < leaves; ++leaf) {
                bool hit = false;
                for (int k = 0; k < kBlockSize; ++k)
                    hit |= overlap(query, load(tree.view.block(0, leaf), k));
                const bool visited =
                    std::binary_search(packed.leaves.begin(), packed.leaves.end(), leaf);
                EXPECT_TRUE(visited || !hit) << n << " points, leaf " << leaf;
            }
            const bool none_before = packed.leaves.empty() || leaves == 1
                                  || packed.leaves.front() >= first_leaf;
            EXPECT_TRUE(none_before);
            EXPECT_TRUE(std::adjacent_find(packed.leaves.begin(), packed.leaves.end())
                        == packed.leaves.end());
        }
    }
}

TEST(Bvh, OrderIsAPermutationAlsoForEqualAndInvalidPoints) {
    const double nan = std::nan("");
    for (const Vec3d& odd : {Vec3d{0.5, 0.5, 0.5}, Vec3d{nan, 0.0, INFINITY}}) {
        std::vector<Vec3d> x(37, Vec3d{0.5, 0.5, 0.5});
        x[11] = odd;
        const Tree tree = tree_of_points(x, 0.0);
        std::vector<int> order(tree.view.order.begin(), tree.view.order.end());
        std::sort(order.begin(), order.end());
        for (int i = 0; i < 37; ++i)
            EXPECT_EQ(order[std::size_t(i)], i);
    }
}

TEST(Bvh, MortonCodeInterleavesTheCells) {
    EXPECT_EQ(morton_code({1, 0, 0}), 1U);
    EXPECT_EQ(morton_code({0, 1, 0}), 2U);
    EXPECT_EQ(morton_code({0, 0, 1}), 4U);
    EXPECT_EQ(morton_code({3, 0, 2}), 0b101001U);
    EXPECT_EQ(morton_code({1e9, 1e9, 1e9}), 0x7FFFFFFFFFFFFFFFULL);
    EXPECT_EQ(morton_code({-5.0, -1e300, 0.5}), 0U);
}

TEST(BoxBlock, PackedTestsEqualPlainOnes) {
    std::mt19937 rng(2);
    std::uniform_int_distribution<int> id(0, 6);
    for (int trial = 0; trial < 20000; ++trial) {
        MovingBlock block;
        IdBlock<Int3> ids;
        for (int j = 0; j < kBlockSize; ++j) {
            MovingBox box;
            make_empty(box);
            // Coarse coordinates: touching boxes are common.
            const auto coarse = [&] {
                const Vec3d v = random_vector(rng, 3.0);
                return Vec3d{std::round(v.x), std::round(v.y), std::round(v.z)};
            };
            for (int k = 0; k < 2; ++k) {
                add_point(box.start, coarse(), 0.0);
                add_point(box.end, coarse(), 0.0);
            }
            store(block, j, box);
            for (auto& corners : ids.v)
                corners[j] = id(rng);
        }
        const MovingBox query = load(block, trial % kBlockSize);
        EXPECT_EQ((overlap_bits<false, MovingBox>(query, block)),
                  (overlap_bits<true, MovingBox>(query, block)));
        EXPECT_EQ((overlap_bits<false, StaticBox>(query.start, block.end)),
                  (overlap_bits<true, StaticBox>(query.start, block.end)));
        EXPECT_EQ((same_vertex_bits<false>(2, ids)), (same_vertex_bits<true>(2, ids)));
    }
}

TEST(MovingBox, FloatsAreRoundedOutwards) {
    std::mt19937 rng(3);
    std::uniform_real_distribution<double> exponent(-45.0, 35.0);
    for (int i = 0; i < 20000; ++i) {
        const double v = (i % 2 == 0 ? 1.0 : -1.0) * std::pow(10.0, exponent(rng));
        EXPECT_LE(double(round_down(v)), v);
        EXPECT_GE(double(round_up(v)), v);
    }
    EXPECT_LE(round_down(0.0), 0.0F);
    EXPECT_NEAR(round_up(1.0), 1.0, 1e-6);
}

}  // namespace
}  // namespace noli
