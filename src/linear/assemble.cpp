// SPDX-License-Identifier: Apache-2.0
#include "linear/assemble.hpp"

#include "exec/lanes.hpp"
#include "linear/wide.hpp"

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

namespace {

/// block += q[slot] q[s]ᵀ of all modes, in their order.
inline __attribute__((always_inline)) void add_modes(
    const Mode* begin, const Mode* end, int slot, int s, Mat3d& block) {
    double* a = block.a;
    Wide rows[3] = {
        {a[0], a[1], a[2], 0.0}, {a[3], a[4], a[5], 0.0}, {a[6], a[7], a[8], 0.0}};
    for (const Mode* m = begin; m != end; ++m) {
        const Vec3d& u = m->q[slot];
        const Vec3d& v = m->q[s];
        const Wide w{v.x, v.y, v.z, 0.0};
        rows[0] += u.x * w;
        rows[1] += u.y * w;
        rows[2] += u.z * w;
    }
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
            a[3 * r + c] = rows[r][c];
}

/// Asks for all modes at a touched vertex: they lie scattered, and each is found through
/// two other loads.
inline __attribute__((always_inline)) void fetch_modes(const OperatorView& op,
                                                       int touched) {
    constexpr std::ptrdiff_t kLine = 64;
    for (int e = op.touched_begin[touched]; e < op.touched_begin[touched + 1]; ++e) {
        const int term = op.slots[e] / kSlotsPerTerm;
        __builtin_prefetch(&op.vertices[term]);
        const auto at = [&](int t) {
            return reinterpret_cast<const char*>(op.modes.data + op.first_mode[t]);
        };
        for (const char* line = at(term); line < at(term + 1); line += kLine)
            __builtin_prefetch(line);
    }
}

/// Place of a column in a short ascending list: counted, because a search would guess
/// wrong at every other step.
inline __attribute__((always_inline)) int place_in(std::span<const int> cols, int col) {
    int place = 0;
    for (const int c : cols)
        place += c < col ? 1 : 0;
    return place;
}

inline __attribute__((always_inline)) void add_term_values(const OperatorView& op,
                                                           View<const int> rank,
                                                           int touched,
                                                           std::span<const int> cols,
                                                           Mat3d* out) {
    fetch_modes(op, touched);
    const int last = cols.empty() ? -1 : cols.back();
    for (int e = op.touched_begin[touched]; e < op.touched_begin[touched + 1]; ++e) {
        const int term = op.slots[e] / kSlotsPerTerm;
        const int slot = op.slots[e] % kSlotsPerTerm;
        for (int s = 0; s < kSlotsPerTerm; ++s) {
            const int v = op.vertices[term][s];
            if (v < 0 || rank[v] < 0 || rank[v] > last) continue;
            add_modes(op.modes.data + op.first_mode[term],
                      op.modes.data + op.first_mode[term + 1],
                      slot,
                      s,
                      out[place_in(cols, rank[v])]);
        }
    }
}

#if defined(__x86_64__)
__attribute__((target("avx2"), flatten)) void add_term_values_avx2(
    const OperatorView& op,
    View<const int> rank,
    int touched,
    std::span<const int> cols,
    Mat3d* out) {
    add_term_values(op, rank, touched, cols, out);
}
#endif

}  // namespace

void merged_row_values(const OperatorView& op,
                       View<const int> touched_index,
                       View<const int> rank,
                       int vertex,
                       std::span<const int> cols,
                       std::span<const int> sources,
                       Mat3d* out) {
    for (std::size_t k = 0; k < cols.size(); ++k)
        out[k] = sources[k] >= 0 ? op.values[sources[k]] : zero3();
    const int touched = touched_index[vertex];
    if (touched < 0) return;
#if defined(__x86_64__)
    if (lane_dispatch() != LaneDispatch::Width2)
        return add_term_values_avx2(op, rank, touched, cols, out);
#endif
    add_term_values(op, rank, touched, cols, out);
}

}  // namespace detail

}  // namespace noli
