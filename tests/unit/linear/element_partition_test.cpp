// SPDX-License-Identifier: Apache-2.0
/// The promise that coloured assembly rests on: every element once, ranges kept apart, no
/// common vertex within a colour.

#include "linear/element_partition.hpp"

#include "linear/element_sums.hpp"
#include "random_system.hpp"

#include <map>
#include <numeric>
#include <set>

namespace noli {
namespace {

using namespace test;

struct Cut {
    std::vector<Int4> elements;
    std::vector<int> range_begin;
    int num_vertices = 0;
    int size = 0;
    ElementPartition partition;

    [[nodiscard]] std::span<const int> block(int b) const {
        const auto k = static_cast<std::size_t>(b);
        return std::span(partition.element)
            .subspan(static_cast<std::size_t>(partition.block_begin[k]),
                     static_cast<std::size_t>(partition.block_begin[k + 1]
                                              - partition.block_begin[k]));
    }
    [[nodiscard]] std::set<int> vertices(int b) const {
        std::set<int> out;
        for (const int e : block(b))
            for (const int v : elements[static_cast<std::size_t>(e)].v)
                out.insert(v);
        return out;
    }
};

std::vector<int> shuffled(int n, std::mt19937& random) {
    std::vector<int> order(static_cast<std::size_t>(n));
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), random);
    return order;
}

Cut cut_random(int num_elements, std::vector<int> range_begin, int size, unsigned seed) {
    std::mt19937 random(seed);
    Cut cut{.range_begin = std::move(range_begin), .size = size};
    cut.num_vertices = std::max(8, num_elements / 4);
    for (int e = 0; e < num_elements; ++e)
        cut.elements.push_back(random_vertices(random, cut.num_vertices, 6));
    cut.partition = partition_elements(cut.num_vertices,
                                       cut.elements,
                                       cut.range_begin,
                                       shuffled(num_elements, random),
                                       size);
    return cut;
}

std::vector<Cut> cuts() {
    return {cut_random(0, {0, 0}, 8, 1),
            cut_random(1, {0, 0, 1, 1}, 8, 2),
            cut_random(103, {0, 103}, 8, 3),
            cut_random(997, {0, 400, 400, 997}, 16, 4),
            cut_random(2048, {0, 7, 1031, 2048}, 64, 5)};
}

TEST(ElementPartition, HasEveryElementInExactlyOneBlock) {
    for (const Cut& cut : cuts()) {
        std::vector<int> seen = cut.partition.element;
        std::sort(seen.begin(), seen.end());
        std::vector<int> all(cut.elements.size());
        std::iota(all.begin(), all.end(), 0);
        EXPECT_EQ(seen, all);
        ASSERT_EQ(cut.partition.block_begin.size(), cut.partition.block_range.size() + 1);
        EXPECT_EQ(cut.partition.block_begin.front(), 0);
        EXPECT_EQ(cut.partition.block_begin.back(),
                  static_cast<int>(cut.elements.size()));
    }
}

TEST(ElementPartition, KeepsRangesApartAndFillsAllBlocksButTheLastOfARange) {
    for (const Cut& cut : cuts()) {
        std::map<int, int> not_full;
        for (int b = 0; b < cut.partition.num_blocks(); ++b) {
            const auto r = static_cast<std::size_t>(
                cut.partition.block_range[static_cast<std::size_t>(b)]);
            EXPECT_GT(cut.block(b).size(), 0U);
            EXPECT_LE(static_cast<int>(cut.block(b).size()), cut.size);
            if (static_cast<int>(cut.block(b).size()) < cut.size)
                ++not_full[static_cast<int>(r)];
            for (const int e : cut.block(b)) {
                EXPECT_GE(e, cut.range_begin[r]);
                EXPECT_LT(e, cut.range_begin[r + 1]);
            }
        }
        for (const auto& [range, count] : not_full)
            EXPECT_EQ(count, 1) << range;
    }
}

TEST(ElementPartition, GivesNoTwoBlocksOfAColourACommonVertex) {
    for (const Cut& cut : cuts()) {
        const ElementPartition& p = cut.partition;
        ASSERT_EQ(p.colour_begin.front(), 0);
        ASSERT_EQ(p.colour_begin.back(), p.num_blocks());
        for (int c = 0; c < p.num_colours(); ++c) {
            const int first = p.colour_begin[static_cast<std::size_t>(c)];
            const int last = p.colour_begin[static_cast<std::size_t>(c) + 1];
            EXPECT_LT(first, last) << "an empty colour";
            std::set<int> taken;
            for (int b = first; b < last; ++b)
                for (const int v : cut.vertices(b))
                    EXPECT_TRUE(taken.insert(v).second) << "vertex " << v;
        }
    }
}

TEST(ElementPartition, FollowsTheOrderWithinABlock) {
    const std::vector<Int4> elements(5, Int4{{0, 1, 2, 3}});
    const std::vector<int> ranges = {0, 2, 5};
    const std::vector<int> order = {4, 1, 3, 0, 2};
    const ElementPartition p = partition_elements(4, elements, ranges, order, 2);
    // All share their vertices: as many colours as blocks.
    EXPECT_EQ(p.element, (std::vector<int>{1, 0, 4, 3, 2}));
    EXPECT_EQ(p.block_begin, (std::vector<int>{0, 2, 4, 5}));
    EXPECT_EQ(p.block_range, (std::vector<int>{0, 1, 1}));
    EXPECT_EQ(p.colour_begin, (std::vector<int>{0, 1, 2, 3}));
}

TEST(ElementPartition, NeedsOneColourForElementsFarApart) {
    std::vector<Int4> elements;
    for (int e = 0; e < 40; ++e)
        elements.push_back({{4 * e, 4 * e + 1, 4 * e + 2, 4 * e + 3}});
    std::vector<int> order(40);
    std::iota(order.begin(), order.end(), 0);
    const std::vector<int> ranges = {0, 40};
    EXPECT_EQ(partition_elements(160, elements, ranges, order, 8).num_colours(), 1);
}

/// Every element block goes to the block of the matrix that the pattern says.
TEST(ElementSums, LeadEveryElementBlockToItsPlace) {
    for (const Cut& cut : cuts()) {
        const BlockPattern pattern =
            build_block_pattern(cut.num_vertices, std::span<const Int4>(cut.elements));
        const ElementSums sums = build_element_sums(cut.partition, pattern);
        for (int b = 0; b < cut.partition.num_blocks(); ++b) {
            const int group = sums.group_begin[static_cast<std::size_t>(b)];
            for (std::size_t k = 0; k < cut.block(b).size(); ++k) {
                const Int4& v = cut.elements[static_cast<std::size_t>(cut.block(b)[k])];
                std::size_t at = 10 * (static_cast<std::size_t>(8 * group) + k);
                for (int i = 0; i < 4; ++i)
                    for (int j = i; j < 4; ++j, ++at) {
                        const SumTarget to = sums.target[static_cast<std::size_t>(
                            sums.sum_begin(b) + sums.slot[at])];
                        const int row = std::min(v[i], v[j]);
                        const int col = std::max(v[i], v[j]);
                        EXPECT_EQ(pattern.col[static_cast<std::size_t>(to.upper)], col);
                        EXPECT_GE(to.upper,
                                  pattern.row_begin[static_cast<std::size_t>(row)]);
                        EXPECT_LT(to.upper,
                                  pattern.row_begin[static_cast<std::size_t>(row) + 1]);
                    }
            }
        }
    }
}

/// In the order of the blocks each target is stored first, then added to, and its
/// transpose is written by the last; other rows are untouched.
TEST(ElementSums, StoreFirstAddLaterAndMirrorLast) {
    for (const Cut& cut : cuts()) {
        const BlockPattern pattern =
            build_block_pattern(cut.num_vertices, std::span<const Int4>(cut.elements));
        const ElementSums sums = build_element_sums(cut.partition, pattern);
        enum class State { Empty, Open, Done };
        std::vector<State> state(pattern.col.size(), State::Empty);
        int num_done = 0;
        for (std::size_t k = 0; k + 1 < sums.kind_begin.size(); ++k)
            for (int t = sums.kind_begin[k]; t < sums.kind_begin[k + 1]; ++t) {
                const SumTarget to = sums.target[static_cast<std::size_t>(t)];
                const int kind = static_cast<int>(k) % sum_kind::kCount;
                State& s = state[static_cast<std::size_t>(to.upper)];
                const bool adds = (kind & sum_kind::kAdds) != 0;
                EXPECT_EQ(s, adds ? State::Open : State::Empty);
                s = (kind & sum_kind::kStays) != 0 ? State::Open : State::Done;
                if (s != State::Done) continue;
                ++num_done;
                if ((kind & sum_kind::kOffDiagonal) == 0) {
                    EXPECT_EQ(pattern.diagonal[static_cast<std::size_t>(to.other)],
                              to.upper);
                    continue;
                }
                EXPECT_EQ(state[static_cast<std::size_t>(to.other)], State::Empty);
                state[static_cast<std::size_t>(to.other)] = State::Done;
            }
        EXPECT_EQ(num_done + static_cast<int>(sums.untouched.size()),
                  pattern.num_upper());
        for (const int row : sums.untouched) {
            const int diagonal = pattern.diagonal[static_cast<std::size_t>(row)];
            EXPECT_EQ(state[static_cast<std::size_t>(diagonal)], State::Empty);
            state[static_cast<std::size_t>(diagonal)] = State::Done;
        }
        for (const State s : state)
            EXPECT_EQ(s, State::Done);
    }
}

}  // namespace
}  // namespace noli
