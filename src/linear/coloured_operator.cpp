// SPDX-License-Identifier: Apache-2.0
#include "linear/coloured_operator.hpp"

#include <algorithm>
#include <numeric>

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

/// Calls f(vertex) for everything coupled to a vertex, repeats and itself included.
template <class F>
void for_each_neighbour(const OperatorView& op,
                        View<const int> touched_index,
                        int v,
                        const F& f) {
    for (int b = op.row_begin[v]; b < op.row_begin[v + 1]; ++b)
        f(op.col[b]);
    const int t = touched_index[v];
    if (t < 0) return;
    for (int e = op.touched_begin[t]; e < op.touched_begin[t + 1]; ++e)
        for (const int w : op.vertices[op.slots[e] / kSlotsPerTerm].v)
            if (w >= 0) f(w);
}

/// First colour of each block that no coupled block before it has.
std::vector<int> colour_blocks(const OperatorView& op,
                               View<const int> touched_index,
                               const Numbering& free,
                               int rows_per_block) {
    const int num_rows = static_cast<int>(free.vertex.size());
    std::vector<int> block_of(free.rank.size());
    for (std::size_t v = 0; v < free.rank.size(); ++v)
        block_of[v] = free.rank[v] < 0 ? -1 : free.rank[v] / rows_per_block;

    std::vector<int> colour(at((num_rows + rows_per_block - 1) / rows_per_block), -1);
    std::vector<int> taken;  // taken[c] == b: a neighbour of block b has colour c
    for (int b = 0; b < static_cast<int>(colour.size()); ++b) {
        const int end = std::min(num_rows, (b + 1) * rows_per_block);
        for (int i = b * rows_per_block; i < end; ++i)
            for_each_neighbour(op, touched_index, free.vertex[at(i)], [&](int w) {
                const int other = block_of[at(w)];
                if (other >= 0 && colour[at(other)] >= 0)
                    taken[at(colour[at(other)])] = b;
            });
        const auto first =
            std::find_if(taken.begin(), taken.end(), [b](int t) { return t != b; });
        colour[at(b)] = static_cast<int>(first - taken.begin());
        if (first == taken.end()) taken.push_back(-1);
    }
    return colour;
}

/// Numbers the rows of some blocks of one colour, interleaved.
void append_group(const std::vector<int>& blocks,
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

ColouredRows colour_rows(const OperatorView& op,
                         View<const int> touched_index,
                         View<const std::uint8_t> fixed,
                         std::span<const int> order,
                         int rows_per_block) {
    const Numbering free = number_free_vertices({fixed.data, at(fixed.size)}, order);
    const std::vector<int> colour =
        colour_blocks(op, touched_index, free, rows_per_block);
    const int num_colours =
        colour.empty() ? 0 : 1 + *std::max_element(colour.begin(), colour.end());
    std::vector<std::vector<int>> blocks_of(at(num_colours));
    for (std::size_t b = 0; b < colour.size(); ++b)
        blocks_of[at(colour[b])].push_back(static_cast<int>(b));

    ColouredRows out;
    out.numbering.rank.assign(at(fixed.size), -1);
    out.numbering.vertex.reserve(free.vertex.size());
    out.group_begin.push_back(0);
    for (const std::vector<int>& blocks : blocks_of) {
        out.colour_begin.push_back(static_cast<int>(out.group_begin.size()) - 1);
        for (std::size_t first = 0; first < blocks.size(); first += kBlocksPerGroup) {
            const std::size_t last = std::min(blocks.size(), first + kBlocksPerGroup);
            append_group({blocks.begin() + static_cast<std::ptrdiff_t>(first),
                          blocks.begin() + static_cast<std::ptrdiff_t>(last)},
                         free,
                         rows_per_block,
                         out);
        }
    }
    out.colour_begin.push_back(static_cast<int>(out.group_begin.size()) - 1);
    return out;
}

bool ColouredOperator::changed(const OperatorView& op, View<const std::uint8_t> fixed) {
    if (same(seen_row_begin_, op.row_begin) && same(seen_col_, op.col)
        && same(seen_terms_, op.vertices) && same(seen_fixed_, fixed))
        return false;
    seen_row_begin_.assign(op.row_begin.begin(), op.row_begin.end());
    seen_col_.assign(op.col.begin(), op.col.end());
    seen_terms_.assign(op.vertices.begin(), op.vertices.end());
    seen_fixed_.assign(fixed.begin(), fixed.end());
    return true;
}

void ColouredOperator::transpose() {
    const std::size_t num_off = lower_.col.size() - at(num_rows());
    upper_begin.assign(at(num_rows()) + 1, 0);
    upper_col.resize(num_off);
    upper_place.resize(num_off);
    for (int i = 0; i < num_rows(); ++i)
        for (int p = lower_.row_begin[at(i)]; p < lower_.row_begin[at(i) + 1] - 1; ++p)
            ++upper_begin[at(lower_.col[at(p)]) + 1];
    std::partial_sum(upper_begin.begin(), upper_begin.end(), upper_begin.begin());
    std::vector<int> next(upper_begin.begin(), upper_begin.end() - 1);
    for (int i = 0; i < num_rows(); ++i)
        for (int p = lower_.row_begin[at(i)]; p < lower_.row_begin[at(i) + 1] - 1; ++p) {
            const int to = next[at(lower_.col[at(p)])]++;
            upper_col[at(to)] = i;
            upper_place[at(p - i)] = to;
        }
}

}  // namespace noli
