// SPDX-License-Identifier: Apache-2.0
#include "linear/block_pattern.hpp"

#include "random_system.hpp"

#include <set>

namespace noli {
namespace {

using test::random_system;

std::set<std::pair<int, int>> coupled_pairs(const BlockPattern& p) {
    std::set<std::pair<int, int>> pairs;
    for (int i = 0; i < p.num_rows; ++i)
        for (int k = p.row_begin[static_cast<std::size_t>(i)];
             k < p.row_begin[static_cast<std::size_t>(i) + 1];
             ++k)
            pairs.insert({i, p.col[static_cast<std::size_t>(k)]});
    return pairs;
}

TEST(BlockPattern, HoldsExactlyTheCoupledPairsAndAllDiagonals) {
    const auto s = random_system(37, 61, 0, 1);
    const BlockPattern p = build_block_pattern(s.num_vertices, std::span(s.elements));
    std::set<std::pair<int, int>> expected;
    for (int i = 0; i < s.num_vertices; ++i)
        expected.insert({i, i});
    for (const Int4& e : s.elements)
        for (const int i : e.v)
            for (const int j : e.v)
                expected.insert({i, j});
    EXPECT_EQ(coupled_pairs(p), expected);
    EXPECT_EQ(p.num_blocks(), static_cast<int>(expected.size()));
}

TEST(BlockPattern, HasAscendingRowsWithTheDiagonalWhereItSays) {
    const auto s = random_system(45, 80, 0, 2);
    const BlockPattern p = build_block_pattern(s.num_vertices, std::span(s.elements));
    ASSERT_EQ(p.row_begin.size(), 46u);
    for (std::size_t i = 0; i < 45; ++i) {
        const auto begin = p.col.begin() + p.row_begin[i];
        const auto end = p.col.begin() + p.row_begin[i + 1];
        EXPECT_EQ(std::adjacent_find(begin, end, std::greater_equal<>()), end);
        EXPECT_EQ(p.col[static_cast<std::size_t>(p.diagonal[i])], static_cast<int>(i));
        EXPECT_GE(p.diagonal[i], p.row_begin[i]);
        EXPECT_LT(p.diagonal[i], p.row_begin[i + 1]);
    }
}

TEST(BlockPattern, ListsEachElementBlockOnceInAscendingElements) {
    const auto s = random_system(45, 80, 0, 3);
    const BlockPattern p = build_block_pattern(s.num_vertices, std::span(s.elements));
    constexpr int kFirst[10] = {0, 0, 0, 0, 1, 1, 1, 2, 2, 3};
    constexpr int kSecond[10] = {0, 1, 2, 3, 1, 2, 3, 2, 3, 3};
    std::set<std::pair<int, int>> seen;
    for (std::size_t u = 0; u < p.upper.size(); ++u) {
        const int col = p.col[static_cast<std::size_t>(p.upper[u])];
        const int row = p.col[static_cast<std::size_t>(p.lower[u])];
        EXPECT_LE(row, col);
        int last = -1;
        for (int g = p.gather_begin[u]; g < p.gather_begin[u + 1]; ++g) {
            const auto c = Contribution::unpack(p.gather[static_cast<std::size_t>(g)]);
            const Int4& e = s.elements[static_cast<std::size_t>(c.element)];
            const int i = e[kFirst[c.slot]];
            const int j = e[kSecond[c.slot]];
            EXPECT_EQ(c.transposed ? j : i, row);
            EXPECT_EQ(c.transposed ? i : j, col);
            EXPECT_GT(c.element, last);
            last = c.element;
            EXPECT_TRUE(seen.insert({c.element, c.slot}).second);
        }
    }
    EXPECT_EQ(seen.size(), 10 * s.elements.size());
}

TEST(BlockPattern, OfCouplingsMergesRepeatsAndAddsDiagonals) {
    const std::vector<Int2> couplings = {{{2, 0}}, {{0, 2}}, {{1, 1}}};
    const BlockPattern p = build_block_pattern(4, std::span(couplings));
    EXPECT_EQ(p.row_begin, (std::vector<int>{0, 2, 3, 5, 6}));
    EXPECT_EQ(p.col, (std::vector<int>{0, 2, 1, 0, 2, 3}));
    EXPECT_EQ(p.diagonal, (std::vector<int>{0, 2, 4, 5}));
    EXPECT_TRUE(p.gather.empty());
}

TEST(BlockPattern, IsOnlyDiagonalWithoutElements) {
    const BlockPattern p = build_block_pattern(3, std::span<const Int4>());
    EXPECT_EQ(p.col, (std::vector<int>{0, 1, 2}));
    EXPECT_EQ(build_block_pattern(0, std::span<const Int4>()).num_blocks(), 0);
}

}  // namespace
}  // namespace noli
