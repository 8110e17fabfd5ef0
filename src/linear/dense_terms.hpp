// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Contacts as the supplement stores and multiplies them: a dense block per term, four
/// buffers by number of points, and Algorithm 1 (linear/warp_product.hpp) over the
/// entries of each. Made from the modes of LowRankTerms, so that the two operators are
/// the same up to rounding; for comparison, chosen by solver.contact_product.
///
/// Source: supplement section 6, Algorithm 1, corrected

#include "linear/dense_pairs.hpp"

namespace noli {

namespace detail {

/// Block first_block + b = sum of q qᵀ over the modes of term first_term + b, on its
/// first S slots.
template <int S, class Exec>
void fill_dense_blocks(Exec& exec,
                       const TermRun& run,
                       int first_block,
                       View<const Int4> terms,
                       View<const int> first_mode,
                       View<const Mode> modes,
                       View<double> values,
                       View<int> vertices) {
    exec.for_each("linear/fill_dense_blocks", run.count, [=] NOLI_HD(int b) {
        const int term = run.first + b;
        const int block = first_block + b;
        for (int s = 0; s < S; ++s)
            vertices[S * block + s] = terms[term][s];
        double* to = values.data + static_cast<long>(9 * S * S) * block;
        for (int i = 0; i < 3 * S; ++i)
            for (int j = 0; j < 3 * S; ++j) {
                double sum = 0.0;
                for (int m = first_mode[term]; m < first_mode[term + 1]; ++m)
                    sum += modes[m].q[i / 3][i % 3] * modes[m].q[j / 3][j % 3];
                *to++ = sum;
            }
    });
}

/// y += H c, one warp's part of it; nothing where `skip` is set.
template <int S>
struct WarpProductKernel {
    const bool* skip;
    DenseBlockView<3 * S> blocks;
    View<const double> c;
    View<double> y;

    template <class Warp>
    NOLI_HD void operator()(Warp warp, std::uint32_t first) const {
        if (skip != nullptr && *skip) return;
        warp_multiply_add(warp, first, blocks.num_entries(), blocks, c, y);
    }
};

}  // namespace detail

template <class Exec>
class DenseTerms {
  public:
    /// Takes the terms as they are now; they must have `runs`.
    void build(Exec& exec, const LowRankTerms<Exec>& terms) {
        build_blocks(exec, terms, one_);
        build_blocks(exec, terms, two_);
        build_blocks(exec, terms, three_);
        build_blocks(exec, terms, four_);
    }

    /// y += sum of the blocks times x. On a GPU the last bits depend on the order in
    /// which warps arrive. Nothing where `skip`, in the executor's memory, is set.
    void multiply_add(Exec& exec,
                      View<const Vec3d> x,
                      View<Vec3d> y,
                      const bool* skip = nullptr) const {
        multiply_blocks<1>(exec, one_, x, y, skip);
        multiply_blocks<2>(exec, two_, x, y, skip);
        multiply_blocks<3>(exec, three_, x, y, skip);
        multiply_blocks<4>(exec, four_, x, y, skip);
    }

  private:
    template <int S>
    static void build_blocks(Exec& exec,
                             const LowRankTerms<Exec>& terms,
                             DenseBlocks<Exec, S>& to) {
        int num_blocks = 0;
        for (const TermRun& run : terms.runs)
            num_blocks += run.points == S ? run.count : 0;
        to.resize(num_blocks);
        int first_block = 0;
        for (const TermRun& run : terms.runs) {
            if (run.points != S) continue;
            detail::fill_dense_blocks<S>(exec,
                                         run,
                                         first_block,
                                         terms.terms(),
                                         terms.mode_begin(),
                                         terms.mode_view(),
                                         to.values.view(),
                                         to.vertices.view());
            first_block += run.count;
        }
    }

    template <int S>
    static void multiply_blocks(Exec& exec,
                                const DenseBlocks<Exec, S>& blocks,
                                View<const Vec3d> x,
                                View<Vec3d> y,
                                const bool* skip) {
        const DenseBlockView<3 * S> view = blocks.view();
        exec.for_warps(
            "linear/warp_product",
            view.num_entries(),
            detail::WarpProductKernel<S>{skip, view, components(x), components(y)});
    }

    DenseBlocks<Exec, 1> one_;
    DenseBlocks<Exec, 2> two_;
    DenseBlocks<Exec, 3> three_;
    DenseBlocks<Exec, 4> four_;
};

}  // namespace noli
