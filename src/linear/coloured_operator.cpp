// SPDX-License-Identifier: Apache-2.0
#include "linear/coloured_operator.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace noli {

namespace {

constexpr int kBlocksPerGroup = 4;

std::size_t at(int i) {
    return static_cast<std::size_t>(i);
}

template <class T>
bool same(const std::vector<T>& a, View<const T> b) {
    return a.size() == at(b.size) && std::equal(a.begin(), a.end(), b.begin());
}

/// Per block: the blocks before it that terms couple it to, in any order.
struct TermNeighbours {
    std::vector<int> begin;  ///< num_blocks + 1
    std::vector<int> block;

    [[nodiscard]] std::span<const int> of(int b) const {
        return {block.data() + begin[at(b)], block.data() + begin[at(b) + 1]};
    }
};

/// Calls visit(later, earlier) for the pairs of different blocks that terms couple.
template <class Visit>
void visit_term_couplings(const OperatorView& op,
                          const RowBlocksOfMatrix& blocks,
                          const Visit& visit) {
    for (const Int4& term : op.vertices) {
        int of[4];
        for (int s = 0; s < 4; ++s)
            of[s] = term[s] < 0 ? -1 : blocks.block_of(term[s]);
        for (int s = 1; s < 4; ++s)
            for (int k = 0; k < s; ++k)
                if (of[s] >= 0 && of[k] >= 0 && of[s] != of[k])
                    visit(std::max(of[s], of[k]), std::min(of[s], of[k]));
    }
}

TermNeighbours neighbours_by_terms(const OperatorView& op,
                                   const RowBlocksOfMatrix& blocks) {
    TermNeighbours out;
    out.begin.assign(at(blocks.num_blocks()) + 1, 0);
    visit_term_couplings(
        op, blocks, [&out](int later, int) { ++out.begin[at(later) + 1]; });
    std::partial_sum(out.begin.begin(), out.begin.end(), out.begin.begin());
    out.block.resize(at(out.begin.back()));
    std::vector<int> next(out.begin.begin(), out.begin.end() - 1);
    visit_term_couplings(op, blocks, [&](int later, int earlier) {
        out.block[at(next[at(later)]++)] = earlier;
    });
    return out;
}

/// First colour of each block that no coupled block before it has.
std::vector<int> colour_blocks(const OperatorView& op, const RowBlocksOfMatrix& blocks) {
    const TermNeighbours by_terms = neighbours_by_terms(op, blocks);
    std::vector<int> colour(at(blocks.num_blocks()), -1);
    std::vector<int> taken;  // taken[c] == b: a neighbour of block b has colour c
    for (int b = 0; b < blocks.num_blocks(); ++b) {
        for (int k = blocks.begin[at(b)]; k < blocks.begin[at(b) + 1]; ++k)
            taken[at(colour[at(blocks.neighbour[at(k)])])] = b;
        for (const int other : by_terms.of(b))
            taken[at(colour[at(other)])] = b;
        const auto first =
            std::find_if(taken.begin(), taken.end(), [b](int t) { return t != b; });
        colour[at(b)] = static_cast<int>(first - taken.begin());
        if (first == taken.end()) taken.push_back(-1);
    }
    return colour;
}

/// Number of groups that so many blocks of a colour make: even, so that two threads get
/// the same share of them.
std::size_t count_groups(std::size_t num_blocks) {
    const std::size_t groups = (num_blocks + kBlocksPerGroup - 1) / kBlocksPerGroup;
    return num_blocks > 1 ? groups + groups % 2 : groups;
}

/// Numbers the rows of some blocks of one colour, interleaved.
void append_group(std::span<const int> blocks,
                  const Numbering& free,
                  int rows_per_block,
                  ColouredRows& out) {
    const int num_rows = static_cast<int>(free.vertex.size());
    for (int k = 0; k < rows_per_block; ++k)
        for (const int b : blocks) {
            const int i = b * rows_per_block + k;
            if (i >= num_rows) continue;
            const int v = free.vertex[at(i)];
            out.numbering.rank[at(v)] = static_cast<int>(out.numbering.vertex.size());
            out.numbering.vertex.push_back(v);
        }
    out.group_begin.push_back(static_cast<int>(out.numbering.vertex.size()));
}

}  // namespace

RowBlocksOfMatrix cut_rows(const OperatorView& op,
                           View<const std::uint8_t> fixed,
                           std::span<const int> order,
                           int rows_per_block) {
    RowBlocksOfMatrix out{
        .free = number_free_vertices({fixed.data, at(fixed.size)}, order),
        .rows_per_block = rows_per_block,
        .begin = {0},
        .neighbour = {}};
    const int num_rows = static_cast<int>(out.free.vertex.size());
    std::vector<int> seen_by(at((num_rows + rows_per_block - 1) / rows_per_block), -1);
    for (int b = 0; b < static_cast<int>(seen_by.size()); ++b) {
        const int end = std::min(num_rows, (b + 1) * rows_per_block);
        for (int i = b * rows_per_block; i < end; ++i) {
            const int v = out.free.vertex[at(i)];
            for (int k = op.row_begin[v]; k < op.row_begin[v + 1]; ++k) {
                const int other = out.block_of(op.col[k]);
                if (other < 0 || other >= b || seen_by[at(other)] == b) continue;
                seen_by[at(other)] = b;
                out.neighbour.push_back(other);
            }
        }
        out.begin.push_back(static_cast<int>(out.neighbour.size()));
    }
    return out;
}

ColouredRows colour_rows(const OperatorView& op, const RowBlocksOfMatrix& blocks) {
    const Numbering& free = blocks.free;
    const int rows_per_block = blocks.rows_per_block;
    const std::vector<int> colour = colour_blocks(op, blocks);
    const int num_colours =
        colour.empty() ? 0 : 1 + *std::max_element(colour.begin(), colour.end());
    std::vector<std::vector<int>> blocks_of(at(num_colours));
    for (std::size_t b = 0; b < colour.size(); ++b)
        blocks_of[at(colour[b])].push_back(static_cast<int>(b));

    ColouredRows out;
    out.numbering.rank.assign(free.rank.size(), -1);
    out.numbering.vertex.reserve(free.vertex.size());
    out.group_begin.push_back(0);
    for (const std::vector<int>& of_colour : blocks_of) {
        out.colour_begin.push_back(static_cast<int>(out.group_begin.size()) - 1);
        const std::size_t groups = count_groups(of_colour.size());
        for (std::size_t g = 0; g < groups; ++g)
            append_group(
                std::span(of_colour).subspan(
                    of_colour.size() * g / groups,
                    of_colour.size() * (g + 1) / groups - of_colour.size() * g / groups),
                free,
                rows_per_block,
                out);
    }
    out.colour_begin.push_back(static_cast<int>(out.group_begin.size()) - 1);
    out.nearby.reserve(free.vertex.size());
    for (const int v : free.vertex)
        out.nearby.push_back(out.numbering.rank[at(v)]);
    return out;
}

bool ColouredOperator::matrix_changed(const OperatorView& op,
                                      View<const std::uint8_t> fixed) {
    if (same(seen_row_begin_, op.row_begin) && same(seen_col_, op.col)
        && same(seen_fixed_, fixed))
        return false;
    seen_row_begin_.assign(op.row_begin.begin(), op.row_begin.end());
    seen_col_.assign(op.col.begin(), op.col.end());
    seen_fixed_.assign(fixed.begin(), fixed.end());
    return true;
}

bool ColouredOperator::terms_changed(const OperatorView& op) {
    if (same(seen_terms_, op.vertices)) return false;
    seen_terms_.assign(op.vertices.begin(), op.vertices.end());
    return true;
}

void ColouredOperator::count_columns(int part) {
    for (int r = 0; r < num_rows(); ++r)
        place_of(part, r) = 0;
    const int last = num_rows() - 1;
    for (int i = first_row(part); i < first_row(part + 1); ++i)
        for (int p = lower_.row_begin[at(i)]; p < lower_.row_begin[at(i) + 1] - 1; ++p)
            ++place_of(part, last - lower_.col[at(p)]);
}

void ColouredOperator::sum_counts(int part) {
    for (int r = first_row(part); r < first_row(part + 1); ++r) {
        int sum = 0;
        for (int k = 0; k < kParts; ++k)
            sum += place_of(k, r);
        upper_begin[at(r) + 1] = sum;
    }
}

void ColouredOperator::find_places(int part) {
    for (int r = first_row(part); r < first_row(part + 1); ++r) {
        int place = upper_begin[at(r)];
        for (int k = 0; k < kParts; ++k)
            place += std::exchange(place_of(k, r), place);
    }
}

void ColouredOperator::fill_upper(int part) {
    const int last = num_rows() - 1;
    for (int i = first_row(part); i < first_row(part + 1); ++i)
        for (int p = lower_.row_begin[at(i)]; p < lower_.row_begin[at(i) + 1] - 1; ++p) {
            const int to = place_of(part, last - lower_.col[at(p)])++;
            upper_col[at(to)] = i;
            upper_place[at(p - i)] = to;
        }
}

}  // namespace noli
