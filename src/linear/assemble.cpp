// SPDX-License-Identifier: Apache-2.0
#include "linear/assemble.hpp"

namespace noli {

Numbering number_free_vertices(std::span<const std::uint8_t> fixed) {
    Numbering numbering;
    numbering.rank.assign(fixed.size(), -1);
    for (std::size_t v = 0; v < fixed.size(); ++v) {
        if (fixed[v] != 0) continue;
        numbering.rank[v] = static_cast<int>(numbering.vertex.size());
        numbering.vertex.push_back(static_cast<int>(v));
    }
    return numbering;
}

Numbering number_free_vertices(std::span<const std::uint8_t> fixed,
                               std::span<const int> order) {
    if (order.empty()) return number_free_vertices(fixed);
    Numbering numbering;
    numbering.rank.assign(fixed.size(), -1);
    for (const int v : order) {
        if (fixed[static_cast<std::size_t>(v)] != 0) continue;
        numbering.rank[static_cast<std::size_t>(v)] =
            static_cast<int>(numbering.vertex.size());
        numbering.vertex.push_back(v);
    }
    return numbering;
}

namespace {

/// Appends row k of a block row, which is a column of the upper triangle.
void append_column(const MergedBlocks& blocks, int r, int k, SparseMatrix& out) {
    for (int b = blocks.row_begin[static_cast<std::size_t>(r)];
         b < blocks.row_begin[static_cast<std::size_t>(r) + 1];
         ++b) {
        const int c = blocks.col[static_cast<std::size_t>(b)];
        const int length = c == r ? k + 1 : 3;
        for (int l = 0; l < length; ++l) {
            out.row.push_back(3 * c + l);
            out.value.push_back(blocks.value[static_cast<std::size_t>(b)](k, l));
        }
    }
    out.col_begin.push_back(static_cast<int>(out.row.size()));
}

}  // namespace

SparseMatrix to_sparse(const MergedBlocks& blocks) {
    SparseMatrix out;
    out.num_rows = 3 * blocks.num_rows();
    out.col_begin.push_back(0);
    out.row.reserve(9 * blocks.col.size());
    out.value.reserve(9 * blocks.col.size());
    for (int r = 0; r < blocks.num_rows(); ++r)
        for (int k = 0; k < 3; ++k)
            append_column(blocks, r, k, out);
    return out;
}

namespace detail {

std::vector<int> touched_of_vertex(const OperatorView& op) {
    std::vector<int> index(static_cast<std::size_t>(op.row_begin.size) - 1, -1);
    for (int t = 0; t < op.touched.size; ++t)
        index[static_cast<std::size_t>(op.touched[t])] = t;
    return index;
}

int merged_row_bound(const OperatorView& op,
                     View<const int> touched_index,
                     View<const int> rank,
                     int vertex) {
    const auto own = static_cast<unsigned>(rank[vertex]);
    int bound = 0;  // -1, a vertex that is left out, is a large unsigned number
    for (int b = op.row_begin[vertex]; b < op.row_begin[vertex + 1]; ++b)
        bound += static_cast<unsigned>(rank[op.col[b]]) <= own ? 1 : 0;
    if (const int t = touched_index[vertex]; t >= 0)
        bound += (kSlotsPerTerm - 1) * (op.touched_begin[t + 1] - op.touched_begin[t]);
    return bound;
}

int merged_row(const OperatorView& op,
               View<const int> touched_index,
               View<const int> rank,
               int vertex,
               RowEntry* out) {
    constexpr int kNowhere = -1;  // the largest source as an unsigned number
    const int own = rank[vertex];
    RowEntry* end = out;
    for (int b = op.row_begin[vertex]; b < op.row_begin[vertex + 1]; ++b) {
        const int c = rank[op.col[b]];
        if (c >= 0 && c <= own) *end++ = RowEntry(c, b);
    }
    const int t = touched_index[vertex];
    if (t >= 0)
        for (int e = op.touched_begin[t]; e < op.touched_begin[t + 1]; ++e)
            for (const int v : op.vertices[op.slots[e] / kSlotsPerTerm].v)
                if (v >= 0 && rank[v] >= 0 && rank[v] < own)
                    *end++ = RowEntry(rank[v], kNowhere);
    std::sort(out, end);
    if (t >= 0)
        end = std::unique(
            out, end, [](RowEntry a, RowEntry b) { return a.col() == b.col(); });
    return static_cast<int>(end - out);
}

void merged_row_values(const OperatorView& op,
                       View<const int> touched_index,
                       View<const int> rank,
                       int vertex,
                       std::span<const int> cols,
                       std::span<const int> sources,
                       Mat3d* out) {
    for (std::size_t k = 0; k < cols.size(); ++k)
        out[k] = sources[k] >= 0 ? op.values[sources[k]] : zero3();
    const int t = touched_index[vertex];
    if (t < 0) return;
    for (int e = op.touched_begin[t]; e < op.touched_begin[t + 1]; ++e) {
        const int term = op.slots[e] / kSlotsPerTerm;
        const int slot = op.slots[e] % kSlotsPerTerm;
        for (int s = 0; s < kSlotsPerTerm; ++s) {
            const int v = op.vertices[term][s];
            if (v < 0 || rank[v] < 0 || rank[v] > rank[vertex]) continue;
            Mat3d& block =
                out[std::lower_bound(cols.begin(), cols.end(), rank[v]) - cols.begin()];
            for (int m = op.first_mode[term]; m < op.first_mode[term + 1]; ++m)
                block += outer(op.modes[m].q[slot], op.modes[m].q[s]);
        }
    }
}

}  // namespace detail

}  // namespace noli
