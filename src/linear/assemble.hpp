// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The whole operator, block matrix + low-rank terms, as one matrix on the host: input of
/// CHOLMOD and of the incomplete factorisation, and the oracle of the matrix-free
/// product.
///
/// Unknowns may be renumbered on the way: `rank` gives each vertex its place in the
/// result, -1 leaves it out (fixed vertices).

#include "linear/block_matrix.hpp"
#include "linear/low_rank.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace noli {

/// Upper triangle of a symmetric matrix by columns (CSC): rows ascending, diagonal last.
struct SparseMatrix {
    int num_rows = 0;
    std::vector<int> col_begin;  ///< num_rows + 1
    std::vector<int> row;
    std::vector<double> value;
};

namespace detail {

/// A block of a merged row: its column, and where in the block matrix it is, or -1.
/// Sorted by columns; of equal ones, the block of the matrix comes first.
struct RowEntry {
    std::uint64_t key;

    RowEntry() = default;
    RowEntry(int col, int source)
        : key(static_cast<std::uint64_t>(static_cast<std::uint32_t>(col)) << 32
              | static_cast<std::uint32_t>(source)) {}
    [[nodiscard]] int col() const { return static_cast<int>(key >> 32); }
    [[nodiscard]] int source() const {
        return static_cast<int>(static_cast<std::uint32_t>(key));
    }
    friend bool operator<(RowEntry a, RowEntry b) { return a.key < b.key; }
};

}  // namespace detail

/// Lower block triangle by rows: columns ascending, diagonal block last in each row.
struct MergedBlocks {
    std::vector<int> row_begin;  ///< num_rows + 1
    std::vector<int> col;
    std::vector<int>
        source;  ///< index of the block in the block matrix, -1 where only terms are
    std::vector<Mat3d> value;  ///< full 3x3 blocks, the diagonal ones too

    [[nodiscard]] int num_rows() const { return static_cast<int>(row_begin.size()) - 1; }
};

/// Buffers of merge_pattern, kept between calls.
struct MergeWork {
    std::vector<int> room;  ///< num_rows + 1: first entry of each row
    std::vector<detail::RowEntry> entries;
};

/// Both parts of the operator in host memory.
struct OperatorView {
    View<const int> row_begin, col;  ///< block matrix, rows of both triangles
    View<const Mat3d> values;
    View<const Int4> vertices;  ///< low-rank terms
    View<const int> first_mode;
    View<const Mode> modes;
    View<const int> touched, touched_begin, slots;
};

/// Where each vertex goes: unknowns keep the order of the vertices, fixed ones are left
/// out.
struct Numbering {
    std::vector<int> rank;    ///< per vertex: its unknown, or -1
    std::vector<int> vertex;  ///< per unknown: its vertex
};

Numbering number_free_vertices(std::span<const std::uint8_t> fixed);

/// The same with unknowns in the order in which `order` lists all vertices.
Numbering number_free_vertices(std::span<const std::uint8_t> fixed,
                               std::span<const int> order);

/// Scalar upper triangle of merged blocks.
SparseMatrix to_sparse(const MergedBlocks& blocks);

namespace detail {

inline View<const int> const_view(const std::vector<int>& v) {
    return {v.data(), static_cast<int>(v.size())};
}

/// Per vertex: its index in the list of touched vertices, or -1.
std::vector<int> touched_of_vertex(const OperatorView& op);

/// At least the number of blocks of one merged row.
int merged_row_bound(const OperatorView& op,
                     View<const int> touched_index,
                     View<const int> rank,
                     int vertex);

/// The blocks of one merged row, columns ascending, diagonal last; returns their number.
int merged_row(const OperatorView& op,
               View<const int> touched_index,
               View<const int> rank,
               int vertex,
               RowEntry* out);

/// Values of the blocks `cols` of one merged row: all of them, or the first ones.
void merged_row_values(const OperatorView& op,
                       View<const int> touched_index,
                       View<const int> rank,
                       int vertex,
                       std::span<const int> cols,
                       std::span<const int> sources,
                       Mat3d* out);

/// A host view of a buffer: itself for CPU executors, a downloaded copy otherwise.
template <class Exec, class T>
View<const T> host_view(Exec& exec, View<const T> from, std::vector<T>& copy) {
    if constexpr (Exec::kIsDevice) {
        exec.download(from, copy);
        return {copy.data(), static_cast<int>(copy.size())};
    } else {
        (void)exec;
        (void)copy;
        return from;
    }
}

}  // namespace detail

/// Host memory behind an OperatorView when the executor is a device.
struct OperatorCopy {
    std::vector<int> row_begin, col, first_mode, touched, touched_begin, slots;
    std::vector<Mat3d> values;
    std::vector<Int4> vertices;
    std::vector<Mode> modes;
};

/// Views of both parts of the operator; `copy` must outlive the result.
template <class Exec>
OperatorView view_operator(Exec& exec,
                           const BlockMatrix<Exec>& matrix,
                           const LowRankTerms<Exec>& terms,
                           OperatorCopy& copy) {
    return {detail::host_view(exec, matrix.row_begin(), copy.row_begin),
            detail::host_view(exec, matrix.col(), copy.col),
            detail::host_view(exec, matrix.values(), copy.values),
            detail::host_view(exec, terms.terms(), copy.vertices),
            detail::host_view(exec, terms.mode_begin(), copy.first_mode),
            detail::host_view(exec, terms.mode_view(), copy.modes),
            detail::host_view(exec, terms.touched(), copy.touched),
            detail::host_view(exec, terms.touched_begin(), copy.touched_begin),
            detail::host_view(exec, terms.slots(), copy.slots)};
}

/// Fills the pattern of the merged lower triangle in the given numbering. `loop(n, f)`
/// runs f(i) for i in [0, n) in any order.
template <class Loop>
void merge_pattern(const Loop& loop,
                   const OperatorView& op,
                   View<const int> touched_index,
                   const Numbering& numbering,
                   MergeWork& work,
                   MergedBlocks& out) {
    const int n = static_cast<int>(numbering.vertex.size());
    const int* vertex = numbering.vertex.data();
    const View<const int> rank = detail::const_view(numbering.rank);
    const auto size = static_cast<std::size_t>(n) + 1;
    std::vector<int>& begin = out.row_begin;
    std::vector<int>& room = work.room;
    room.assign(size, 0);
    loop(n, [&](int i) {
        room[static_cast<std::size_t>(i) + 1] =
            detail::merged_row_bound(op, touched_index, rank, vertex[i]);
    });
    std::partial_sum(room.begin(), room.end(), room.begin());
    if (work.entries.size() < static_cast<std::size_t>(room.back()))
        work.entries.resize(static_cast<std::size_t>(room.back()));
    begin.assign(size, 0);
    loop(n, [&](int i) {
        const auto row = static_cast<std::size_t>(i);
        begin[row + 1] = detail::merged_row(
            op, touched_index, rank, vertex[i], work.entries.data() + room[row]);
    });
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    out.col.resize(static_cast<std::size_t>(begin.back()));
    out.source.resize(out.col.size());
    loop(n, [&](int i) {
        const auto row = static_cast<std::size_t>(i);
        const detail::RowEntry* from = work.entries.data() + room[row];
        const auto end = static_cast<std::size_t>(begin[row + 1]);
        for (auto k = static_cast<std::size_t>(begin[row]); k < end; ++k, ++from) {
            out.col[k] = from->col();
            out.source[k] = from->source();
        }
    });
}

/// Fills the values of a merged lower triangle whose pattern is set.
template <class Loop>
void merge_values(const Loop& loop,
                  const OperatorView& op,
                  View<const int> touched_index,
                  const Numbering& numbering,
                  MergedBlocks& out) {
    out.value.resize(out.col.size());
    const View<const int> rank = detail::const_view(numbering.rank);
    loop(out.num_rows(), [&](int i) {
        const auto row = static_cast<std::size_t>(i);
        const auto begin = static_cast<std::size_t>(out.row_begin[row]);
        const auto count = static_cast<std::size_t>(out.row_begin[row + 1]) - begin;
        detail::merged_row_values(op,
                                  touched_index,
                                  rank,
                                  numbering.vertex[row],
                                  std::span(out.col).subspan(begin, count),
                                  std::span(out.source).subspan(begin, count),
                                  out.value.data() + begin);
    });
}

/// Everything as one sparse matrix over the unknowns of `numbering`, three rows per
/// vertex.
template <class Exec>
SparseMatrix assemble_sparse(Exec& exec,
                             const BlockMatrix<Exec>& matrix,
                             const LowRankTerms<Exec>& terms,
                             const Numbering& numbering) {
    OperatorCopy copy;
    const OperatorView op = view_operator(exec, matrix, terms, copy);
    const std::vector<int> touched = detail::touched_of_vertex(op);
    const auto loop = [](int n, const auto& f) {
        for (int i = 0; i < n; ++i)
            f(i);
    };
    MergeWork work;
    MergedBlocks merged;
    merge_pattern(loop, op, detail::const_view(touched), numbering, work, merged);
    merge_values(loop, op, detail::const_view(touched), numbering, merged);
    return to_sparse(merged);
}

}  // namespace noli
