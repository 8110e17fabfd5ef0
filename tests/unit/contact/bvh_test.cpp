// SPDX-License-Identifier: Apache-2.0
#include "contact/bvh.hpp"

#include "contact/group_boxes.hpp"
#include "contact_shapes.hpp"
#include "exec/avx2.hpp"

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
    tree.boxes.refit(
        exec, tree.order, detail::MotionBoxes<StaticBox>{{view_of(x), {}, 0.0}, gap});
    tree.view = tree.boxes.view(tree.order);
    return tree;
}

/// The blocks of one level that a query visits, in the order of the visits.
template <bool kOnDevice, int kLevel>
std::vector<int> visited(const Tree& tree, const StaticBox& query, int first) {
    std::vector<int> blocks;
    visit_blocks<kOnDevice, kLevel>(
        tree.view, query, first, [&](int j) { blocks.push_back(j); });
    return blocks;
}

/// Both texts visit the same blocks from `first` on, each once, and all whose boxes
/// overlap the query.
template <int kLevel>
void expect_all_visited(const Tree& tree, const StaticBox& query, int first) {
    std::vector<int> blocks = visited<false, kLevel>(tree, query, first);
    EXPECT_EQ(blocks, (visited<true, kLevel>(tree, query, first)));
    std::sort(blocks.begin(), blocks.end());
    const int all = tree.view.levels.num_blocks(kLevel);
    for (int j = first; j < all; ++j) {
        bool hit = false;
        for (int k = 0; k < kBlockSize; ++k)
            hit |= overlap(query, load(tree.view.block(kLevel, j), k));
        EXPECT_TRUE(!hit || std::binary_search(blocks.begin(), blocks.end(), j))
            << "level " << kLevel << ", block " << j << " of " << all;
    }
    EXPECT_TRUE(blocks.empty() || all == 1 || blocks.front() >= first);
    EXPECT_TRUE(std::adjacent_find(blocks.begin(), blocks.end()) == blocks.end());
}

TEST(Bvh, LevelsEndInOneBlock) {
    EXPECT_EQ(bvh_levels(0).count, 0);
    EXPECT_EQ(bvh_levels(1).count, 2);
    EXPECT_EQ(bvh_levels(4).count, 2);
    EXPECT_EQ(bvh_levels(16).count, 2);
    EXPECT_EQ(bvh_levels(17).count, 3);
    const BvhLevels levels = bvh_levels(1000000000);
    ASSERT_LE(levels.count, kMaxLevels);
    EXPECT_EQ(levels.offset[levels.count] - levels.offset[levels.count - 1], 1);
    EXPECT_EQ(levels.num_blocks(0), 250000000);
    EXPECT_EQ(levels.num_blocks(levels.count - 1), 1);
    EXPECT_EQ(levels.num_blocks(levels.count), 0);
}

TEST(Bvh, VisitsEveryBlockWhoseBoxOverlapsTheQuery) {
    std::mt19937 rng(1);
    for (const int n : {1, 2, 3, 4, 5, 7, 16, 17, 33, 63, 64, 65, 257, 1001}) {
        std::vector<Vec3d> x;
        for (int i = 0; i < n; ++i)
            x.push_back(random_vector(rng, 1.0));
        const Tree tree = tree_of_points(x, 0.02);
        const auto some_block = [&](int level) {
            return int(rng() % unsigned(tree.view.levels.num_blocks(level)));
        };
        for (int q = 0; q < 40; ++q) {
            StaticBox query = empty_static_box();
            add_point(query, random_vector(rng, 1.0), 0.3);
            expect_all_visited<0>(tree, query, q % 2 == 0 ? 0 : some_block(0));
            expect_all_visited<1>(tree, query, q % 2 == 0 ? 0 : some_block(1));
        }
    }
}

TEST(Bvh, BoxOfABlockIsTheUnionOfItsBoxes) {
    std::mt19937 rng(4);
    for (const int n : {1, 4, 5, 16, 17, 70}) {
        std::vector<Vec3d> x;
        for (int i = 0; i < n; ++i)
            x.push_back(random_vector(rng, 1.0));
        const Tree tree = tree_of_points(x, 0.02);
        for (int level = 0; level < tree.view.levels.count; ++level)
            for (int j = 0; j < tree.view.levels.num_blocks(level); ++j) {
                StaticBox all = empty_static_box();
                for (int k = 0; k < kBlockSize; ++k)
                    merge_into(all, load(tree.view.block(level, j), k));
                const StaticBox box = box_of_block(tree.view, level, j);
                EXPECT_EQ(std::memcmp(&all, &box, sizeof box), 0) << level << ' ' << j;
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

/// Four boxes with coarse coordinates, so that touching ones are common.
MovingBlock random_block(std::mt19937& rng) {
    MovingBlock block;
    const auto coarse = [&] {
        const Vec3d v = random_vector(rng, 3.0);
        return Vec3d{std::round(v.x), std::round(v.y), std::round(v.z)};
    };
    for (int j = 0; j < kBlockSize; ++j) {
        MovingBox box;
        make_empty(box);
        for (int k = 0; k < 2; ++k) {
            add_point(box.start, coarse(), 0.0);
            add_point(box.end, coarse(), 0.0);
        }
        store(block, j, box);
    }
    return block;
}

IdBlock<Int3> random_ids(std::mt19937& rng) {
    std::uniform_int_distribution<int> id(0, 6);
    IdBlock<Int3> ids;
    for (auto& corners : ids.v)
        for (int& corner : corners)
            corner = id(rng);
    return ids;
}

TEST(BoxBlock, PackedTestsEqualPlainOnes) {
    std::mt19937 rng(2);
    for (int trial = 0; trial < 20000; ++trial) {
        const MovingBlock block = random_block(rng);
        const IdBlock<Int3> ids = random_ids(rng);
        const MovingBox query = load(block, trial % kBlockSize);
        EXPECT_EQ((overlap_bits<false, MovingBox>(query, block)),
                  (overlap_bits<true, MovingBox>(query, block)));
        EXPECT_EQ((overlap_bits<false, StaticBox>(query.start, block.end)),
                  (overlap_bits<true, StaticBox>(query.start, block.end)));
        EXPECT_EQ((same_vertex_bits<false>(2, ids)), (same_vertex_bits<true>(2, ids)));
    }
}

TEST(GroupBoxes, FindThePairsOfTwoBlocks) {
    using namespace detail;
    std::mt19937 rng(5);
    for (int trial = 0; trial < 20000; ++trial) {
        const MovingBlock a = random_block(rng);
        const MovingBlock b = random_block(rng);
        unsigned moving = 0;
        unsigned still = 0;
        for (int i = 0; i < kBlockSize; ++i)
            for (int j = 0; j < kBlockSize; ++j) {
                const int bit = kBlockSize * i + j;
                moving |= unsigned(overlap(load(a, i), load(b, j))) << bit;
                still |= unsigned(overlap(load(a.start, i), load(b.start, j))) << bit;
            }
        const auto packed = [&] { return GroupBoxes<false, MovingBox>(a).overlaps(b); };
        EXPECT_EQ(packed(), moving);
        EXPECT_EQ(with_avx2(packed), moving);
        EXPECT_EQ((GroupBoxes<true, MovingBox>(a).overlaps(b)), moving);
        EXPECT_EQ((GroupBoxes<false, StaticBox>(a.start).overlaps(b.start)), still);
        EXPECT_EQ((GroupBoxes<true, StaticBox>(a.start).overlaps(b.start)), still);
    }
}

TEST(GroupBoxes, FindThePairsThatShareAVertex) {
    std::mt19937 rng(6);
    for (int trial = 0; trial < 2000; ++trial) {
        const IdBlock<Int3> a = random_ids(rng);
        const IdBlock<Int3> b = random_ids(rng);
        unsigned expected = 0;
        for (int i = 0; i < kBlockSize; ++i)
            for (int j = 0; j < kBlockSize; ++j)
                for (const auto& of_a : a.v)
                    for (const auto& of_b : b.v)
                        expected |= unsigned(of_a[i] == of_b[j]) << (kBlockSize * i + j);
        EXPECT_EQ((detail::shared_bits<false>(a, b)), expected);
        EXPECT_EQ((detail::shared_bits<true>(a, b)), expected);
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
