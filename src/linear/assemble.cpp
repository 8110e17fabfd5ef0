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

void merged_row(const OperatorView& op,
                View<const int> touched_index,
                View<const int> rank,
                int vertex,
                std::vector<std::pair<int, int>>& out) {
    out.clear();
    const int own = rank[vertex];
    for (int b = op.row_begin[vertex]; b < op.row_begin[vertex + 1]; ++b) {
        const int c = rank[op.col[b]];
        if (c >= 0 && c <= own) out.emplace_back(c, b);
    }
    const std::size_t num_matrix = out.size();
    if (const int t = touched_index[vertex]; t >= 0) {
        for (int e = op.touched_begin[t]; e < op.touched_begin[t + 1]; ++e)
            for (const int v : op.vertices[op.slots[e] / kSlotsPerTerm].v)
                if (v >= 0 && rank[v] >= 0 && rank[v] < own)
                    out.emplace_back(rank[v], -1);
    }
    if (num_matrix == out.size()) {
        std::sort(out.begin(), out.end());
        return;
    }
    // Of equal columns, the block of the matrix comes first and stays.
    std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) {
        return a.first != b.first ? a.first < b.first : a.second > b.second;
    });
    const auto same_column = [](const auto& a, const auto& b) {
        return a.first == b.first;
    };
    out.erase(std::unique(out.begin(), out.end(), same_column), out.end());
}

int merged_row_length(const OperatorView& op,
                      View<const int> touched_index,
                      View<const int> rank,
                      int vertex) {
    if (touched_index[vertex] >= 0) {
        thread_local std::vector<std::pair<int, int>> row;
        merged_row(op, touched_index, rank, vertex, row);
        return static_cast<int>(row.size());
    }
    const auto own = static_cast<unsigned>(rank[vertex]);
    int length = 0;  // -1, a vertex that is left out, is a large unsigned number
    for (int b = op.row_begin[vertex]; b < op.row_begin[vertex + 1]; ++b)
        length += static_cast<unsigned>(rank[op.col[b]]) <= own ? 1 : 0;
    return length;
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
