// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Dense Hessian blocks per contact pair, as the supplement stores them: their buffers,
/// their size next to that of the modes of linear/low_rank.hpp, and their product on
/// executors without atomics. linear/warp_product.hpp has the supplement's own product.

#include "core/stencil.hpp"
#include "linear/low_rank.hpp"
#include "linear/warp_product.hpp"

#include <cstddef>
#include <limits>

namespace noli {

/// out = sum_k q_k q_k^T, row-major, (3 S)^2 numbers.
template <int S, int R>
NOLI_HD inline void dense_block(const StencilModes<S, R>& modes, double* out) {
    for (int i = 0; i < 3 * S; ++i)
        for (int j = 0; j < 3 * S; ++j) {
            double sum = 0.0;
            for (int k = 0; k < modes.rank; ++k)
                sum += modes.q[k][i / 3][i % 3] * modes.q[k][j / 3][j % 3];
            out[3 * S * i + j] = sum;
        }
}

/// The buffer of one pair type on S points.
template <class Exec, int S>
struct DenseBlocks {
    typename Exec::template Buffer<double> values;  ///< (3 S)^2 per block, row-major
    typename Exec::template Buffer<int> vertices;   ///< S per block

    /// Contents are undefined afterwards. At most 14.9 million blocks of 12 x 12: entries
    /// are counted in an int.
    void resize(int num_blocks) {
        NOLI_DCHECK(num_blocks <= std::numeric_limits<int>::max() / (9 * S * S));
        values.resize(9 * S * S * num_blocks);
        vertices.resize(S * num_blocks);
    }
    [[nodiscard]] DenseBlockView<3 * S> view() const {
        return {values.view(), vertices.view()};
    }
    [[nodiscard]] int num_blocks() const { return vertices.size() / S; }
};

/// Bytes stored per pair on S points: dense block and vertices.
template <int S>
inline constexpr std::size_t kDenseBytes = std::size_t{9} * S* S * sizeof(double)
                                         + S * sizeof(int);

/// Bytes that LowRankTerms stores per pair with `rank` modes: modes, vertices, first
/// mode.
constexpr std::size_t low_rank_bytes(int rank) {
    return static_cast<std::size_t>(rank) * sizeof(Mode) + sizeof(Int4) + sizeof(int);
}

namespace detail {

/// The vertices of blocks, as terms of four slots from term `first` on.
template <int S, class Exec>
void copy_block_vertices(Exec& exec,
                         const DenseBlockView<3 * S>& blocks,
                         int first,
                         View<Int4> terms) {
    exec.for_each("linear/block_vertices", blocks.num_blocks(), [=] NOLI_HD(int b) {
        Int4 v{{-1, -1, -1, -1}};
        for (int s = 0; s < S; ++s)
            v[s] = blocks.vertices[S * b + s];
        terms[first + b] = v;
    });
}

/// forces[4 (first + b) + slot] = the block's rows of that slot times the local c
template <int S, class Exec>
void block_forces(Exec& exec,
                  const DenseBlockView<3 * S>& blocks,
                  int first,
                  View<const Vec3d> c,
                  View<Vec3d> forces) {
    exec.for_each("linear/block_forces", blocks.num_blocks(), [=] NOLI_HD(int b) {
        double local[3 * S];
        for (int s = 0; s < S; ++s)
            for (int k = 0; k < 3; ++k)
                local[3 * s + k] = c[blocks.vertices[S * b + s]][k];
        constexpr std::ptrdiff_t kRows = std::ptrdiff_t{9} * S;  // of one slot
        const double* h = blocks.values.data + kRows * S * b;
        for (int s = 0; s < S; ++s, h += kRows) {
            Vec3d sum{0.0, 0.0, 0.0};
            for (int j = 0; j < 3 * S; ++j) {
                sum.x += h[j] * local[j];
                sum.y += h[3 * S + j] * local[j];
                sum.z += h[6 * S + j] * local[j];
            }
            forces[kSlotsPerTerm * (first + b) + s] = sum;
        }
    });
}

}  // namespace detail

/// Dense blocks of all contacts in four buffers by pair type, and their product on an
/// executor without atomics: forces per slot, then a sum per vertex, exactly as
/// LowRankTerms does it, so that the two differ in nothing but how a pair is stored.
/// Whoever owns the pairs fills the buffers and calls build_incidence.
template <class Exec>
class WarpProduct {
  public:
    DenseBlocks<Exec, 2> point_point;
    DenseBlocks<Exec, 3> point_edge;
    DenseBlocks<Exec, 4> point_triangle;
    DenseBlocks<Exec, 4> edge_edge;

    [[nodiscard]] int num_pairs() const { return edge_edge_begin() + ee(); }
    [[nodiscard]] std::size_t bytes() const {
        return static_cast<std::size_t>(pp())
                 * kDenseBytes<
                     2> + static_cast<std::size_t>(pe()) * kDenseBytes<3> + static_cast<std::size_t>(pt() + ee()) * kDenseBytes<4>;
    }

    /// Finds the slots of each touched vertex. Call after vertices changed.
    void build_incidence(Exec& exec, int num_vertices) {
        terms_.resize(num_pairs(), 0);
        forces_.resize(kSlotsPerTerm * num_pairs());
        const View<Int4> to = terms_.vertices.view();
        detail::copy_block_vertices<2>(exec, point_point.view(), 0, to);
        detail::copy_block_vertices<3>(exec, point_edge.view(), pp(), to);
        detail::copy_block_vertices<4>(exec, point_triangle.view(), pp() + pe(), to);
        detail::copy_block_vertices<4>(exec, edge_edge.view(), edge_edge_begin(), to);
        terms_.build_incidence(exec, num_vertices);
    }

    /// y += H c
    void multiply_add(Exec& exec, View<const Vec3d> c, View<Vec3d> y) {
        if (num_pairs() == 0) return;
        const View<Vec3d> f = forces_.view();
        detail::block_forces<2>(exec, point_point.view(), 0, c, f);
        detail::block_forces<3>(exec, point_edge.view(), pp(), c, f);
        detail::block_forces<4>(exec, point_triangle.view(), pp() + pe(), c, f);
        detail::block_forces<4>(exec, edge_edge.view(), edge_edge_begin(), c, f);
        terms_.gather_add(exec, View<const Vec3d>(f), y);
    }

  private:
    [[nodiscard]] int pp() const { return point_point.num_blocks(); }
    [[nodiscard]] int pe() const { return point_edge.num_blocks(); }
    [[nodiscard]] int pt() const { return point_triangle.num_blocks(); }
    [[nodiscard]] int ee() const { return edge_edge.num_blocks(); }
    [[nodiscard]] int edge_edge_begin() const { return pp() + pe() + pt(); }

    LowRankTerms<Exec> terms_;  // no modes: only who touches which vertex
    typename Exec::template Buffer<Vec3d> forces_;
};

}  // namespace noli
