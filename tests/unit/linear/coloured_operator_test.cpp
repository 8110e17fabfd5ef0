// SPDX-License-Identifier: Apache-2.0
#include "linear/coloured_operator.hpp"

#include "random_system.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace noli {
namespace {

using namespace test;

constexpr RowCut kBlocks{.rows_per_block = 16};
constexpr RowCut kRegions{.rows_per_block = 16, .blocks_per_region = 8, .region_rows = 0};

struct Coloured {
    RandomSystem system;
    std::vector<std::uint8_t> fixed;
    SerialExec exec;
    LoadedSystem<SerialExec> loaded;
    OperatorCopy copy;
    ColouredOperator op;

    Coloured(int num_vertices, int num_terms, const RowCut& cut)
        : system(random_system(num_vertices, 3 * num_vertices, num_terms, num_vertices)),
          fixed(static_cast<std::size_t>(num_vertices), 0),
          loaded(load(exec, system)),
          op(cut) {
        for (std::size_t i = 3; i < fixed.size(); i += 11)
            fixed[i] = 1;
        op.update_pattern(exec, view(), view_of(fixed));
    }
    OperatorView view() { return view_operator(exec, loaded.matrix, loaded.terms, copy); }
};

/// Index of the interval that i lies in.
int interval_of(const std::vector<int>& begin, int i) {
    return static_cast<int>(std::upper_bound(begin.begin(), begin.end(), i)
                            - begin.begin())
         - 1;
}

TEST(ColouredOperator, NumbersEveryFreeVertexOnce) {
    Coloured c(205, 40, kBlocks);
    const Numbering& numbering = c.op.numbering();
    std::size_t num_free = 0;
    for (std::size_t v = 0; v < c.fixed.size(); ++v) {
        const int rank = numbering.rank[v];
        if (c.fixed[v] != 0) {
            EXPECT_EQ(rank, -1);
            continue;
        }
        ++num_free;
        ASSERT_GE(rank, 0);
        EXPECT_EQ(numbering.vertex[static_cast<std::size_t>(rank)], static_cast<int>(v));
    }
    EXPECT_EQ(numbering.vertex.size(), num_free);
    EXPECT_EQ(c.op.rows().group_begin.back(), static_cast<int>(num_free));
}

TEST(ColouredOperator, CoupledRowsOfDifferentGroupsHaveDifferentColours) {
    for (const RowCut& cut :
         {RowCut{1}, kBlocks, RowCut{64}, kRegions, RowCut{4, 3, 0}, RowCut{1, 64, 0}}) {
        Coloured c(4999, 30, cut);
        const MergedBlocks& lower = c.op.lower();
        int couplings_between_groups = 0;
        for (int i = 0; i < c.op.num_rows(); ++i)
            for (int p = lower.row_begin[static_cast<std::size_t>(i)];
                 p < lower.row_begin[static_cast<std::size_t>(i) + 1];
                 ++p) {
                const int j = lower.col[static_cast<std::size_t>(p)];
                const int group_i = interval_of(c.op.rows().group_begin, i);
                const int group_j = interval_of(c.op.rows().group_begin, j);
                if (group_i == group_j) continue;
                ++couplings_between_groups;
                EXPECT_NE(interval_of(c.op.rows().colour_begin, group_i),
                          interval_of(c.op.rows().colour_begin, group_j));
            }
        EXPECT_GT(couplings_between_groups, 0);
        EXPECT_GT(c.op.num_groups(), c.op.num_colours());
    }
}

TEST(ColouredOperator, UpperRowsAreTheTransposeOfLowerRows) {
    Coloured c(205, 40, kBlocks);
    const MergedBlocks& lower = c.op.lower();
    ASSERT_EQ(c.op.upper_col.size() + static_cast<std::size_t>(c.op.num_rows()),
              lower.col.size());
    for (int i = 0; i < c.op.num_rows(); ++i)
        for (int p = lower.row_begin[static_cast<std::size_t>(i)];
             p < lower.row_begin[static_cast<std::size_t>(i) + 1] - 1;
             ++p) {
            const int place = c.op.upper_place[static_cast<std::size_t>(p - i)];
            EXPECT_EQ(c.op.upper_col[static_cast<std::size_t>(place)], i);
            const int col = lower.col[static_cast<std::size_t>(p)];
            EXPECT_GE(place, c.op.first_upper(col));
            EXPECT_LT(place, c.op.end_upper(col));
        }
}

TEST(ColouredOperator, UpperRowsFollowEachOtherInTheOrderOfABackwardSweep) {
    Coloured c(205, 40, kBlocks);
    int next = 0;
    for (int i = c.op.num_rows() - 1; i >= 0; --i) {
        EXPECT_EQ(c.op.first_upper(i), next);
        next = c.op.end_upper(i);
    }
    EXPECT_EQ(static_cast<std::size_t>(next), c.op.upper_col.size());
}

TEST(ColouredOperator, CutsLargeSystemsIntoRegions) {
    Coloured c(4999, 30, kRegions);
    const Numbering& numbering = c.op.numbering();
    const auto num_rows = static_cast<std::size_t>(c.op.num_rows());
    std::vector<int> free;
    for (int v = 0; v < 4999; ++v)
        if (numbering.rank[static_cast<std::size_t>(v)] >= 0) free.push_back(v);
    ASSERT_EQ(free.size(), num_rows);
    EXPECT_EQ(c.op.num_groups(), static_cast<int>((num_rows + 127) / 128));
    for (std::size_t k = 0; k < num_rows; k += 128) {
        const int group = interval_of(c.op.rows().group_begin,
                                      numbering.rank[static_cast<std::size_t>(free[k])]);
        for (std::size_t i = k; i < std::min(k + 128, num_rows); ++i)
            EXPECT_EQ(interval_of(c.op.rows().group_begin,
                                  numbering.rank[static_cast<std::size_t>(free[i])]),
                      group);
    }
}

TEST(ColouredOperator, CutsSmallSystemsIntoBlocks) {
    Coloured blocks(900, 100, kBlocks);
    Coloured regions(900, 100, RowCut{16, 8, 1000});
    EXPECT_EQ(blocks.op.numbering().vertex, regions.op.numbering().vertex);
    EXPECT_EQ(blocks.op.rows().group_begin, regions.op.rows().group_begin);
}

/// Two threads get the same number of groups of each colour that has more than one block.
TEST(ColouredOperator, CutsColoursIntoAnEvenNumberOfGroups) {
    for (const int size : {40, 205, 900}) {
        Coloured c(size, size / 5, kBlocks);
        for (int colour = 0; colour < c.op.num_colours(); ++colour) {
            const auto k = static_cast<std::size_t>(colour);
            const auto& begin = c.op.rows().colour_begin;
            const int groups = begin[k + 1] - begin[k];
            EXPECT_TRUE(groups == 1 || groups % 2 == 0) << groups;
        }
    }
}

TEST(ColouredOperator, VisitsRowsNearbyInTheOrderOfTheirVertices) {
    for (const bool reversed : {false, true}) {
        Coloured c(205, 40, kBlocks);
        if (reversed) {
            std::vector<int> order(205);
            std::iota(order.rbegin(), order.rend(), 0);
            c.op.set_order(order);
            c.op.update_pattern(c.exec, c.view(), view_of(c.fixed));
        }
        std::vector<int> visited;
        std::vector<int> announced;
        c.op.for_rows_nearby(c.exec, [&](int row, int ahead) {
            visited.push_back(c.op.numbering().vertex[static_cast<std::size_t>(row)]);
            announced.push_back(c.op.numbering().vertex[static_cast<std::size_t>(ahead)]);
        });
        std::vector<int> expected;
        for (int v = 0; v < 205; ++v)
            if (c.fixed[static_cast<std::size_t>(v)] == 0) expected.push_back(v);
        if (reversed) std::reverse(expected.begin(), expected.end());
        EXPECT_EQ(visited, expected);
        for (std::size_t k = 0; k < visited.size(); ++k)
            EXPECT_EQ(announced[k], expected[std::min(k + 3, expected.size() - 1)]);
    }
}

TEST(ColouredOperator, GroupsOfAColourAreVisitedOnce) {
    Coloured c(900, 100, kBlocks);
    for (int colour = 0; colour < c.op.num_colours(); ++colour) {
        const auto k = static_cast<std::size_t>(colour);
        const auto& begin = c.op.rows().colour_begin;
        std::vector<int> all(static_cast<std::size_t>(begin[k + 1] - begin[k]));
        std::iota(all.begin(), all.end(), begin[k]);
        std::vector<int> visited;
        c.op.for_groups(
            c.exec, colour, [&](int g) { return visited.push_back(g), true; });
        EXPECT_EQ(visited, all);
    }
}

TEST(ColouredOperator, ColoursAreStagesInBothDirections) {
    Coloured c(900, 100, kBlocks);
    ASSERT_EQ(c.op.groups_of_colours().size, c.op.num_colours() + 1);
    std::vector<int> all(static_cast<std::size_t>(c.op.num_groups()));
    std::iota(all.begin(), all.end(), 0);
    for (const bool back : {false, true}) {
        std::vector<int> visited;
        c.exec.for_stages("test/colours", c.op.groups_of_colours(), back, [&](int g) {
            visited.push_back(g);
        });
        EXPECT_EQ(visited, all);
        std::reverse(all.begin(), all.end());
    }
}

TEST(ColouredOperator, KeepsThePatternUntilItChanges) {
    Coloured c(205, 40, kBlocks);
    EXPECT_FALSE(c.op.update_pattern(c.exec, c.view(), view_of(c.fixed)));
    c.fixed[50] ^= 1;
    EXPECT_TRUE(c.op.update_pattern(c.exec, c.view(), view_of(c.fixed)));
    c.loaded.terms.vertices.view()[2] = {{0, 204, -1, -1}};
    c.loaded.terms.build_incidence(c.exec, 205);
    EXPECT_TRUE(c.op.update_pattern(c.exec, c.view(), view_of(c.fixed)));
    EXPECT_FALSE(c.op.update_pattern(c.exec, c.view(), view_of(c.fixed)));
}

}  // namespace
}  // namespace noli
