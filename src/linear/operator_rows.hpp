// SPDX-License-Identifier: Apache-2.0
#pragma once
/// All that couples one vertex to others, block matrix and contact modes together, as
/// kernels of a preconditioner's set-up see it.

#include "linear/block_matrix.hpp"
#include "linear/low_rank.hpp"

#include <cstdint>

namespace noli {

/// Rows of block matrix + low-rank terms.
struct OperatorRows {
    View<const int> row_begin, col;
    View<const Mat3d> values;
    View<const int> touched_index;  ///< per vertex: its place among the touched, or -1
    View<const int> touched_begin, slots;
    View<const Int4> terms;
    View<const int> mode_begin;
    View<const Mode> modes;
    View<const std::uint8_t> fixed;

    /// Calls visit(j, f) for all contributions to row i of uᵀ A, u a vector at vertex i:
    /// the three numbers f add to the row at the free vertex j.
    template <class Visit>
    NOLI_HD void visit_row(int i, const Vec3d& u, Visit& visit) const {
        for (int k = row_begin[i]; k < row_begin[i + 1]; ++k)
            if (fixed[col[k]] == 0) visit(col[k], transposed_product(values[k], u));
        const int at = touched_index[i];
        if (at < 0) return;
        for (int e = touched_begin[at]; e < touched_begin[at + 1]; ++e)
            visit_term(slots[e] / kSlotsPerTerm, slots[e] % kSlotsPerTerm, u, visit);
    }

  private:
    template <class Visit>
    NOLI_HD void visit_term(int term, int slot, const Vec3d& u, Visit& visit) const {
        for (int m = mode_begin[term]; m < mode_begin[term + 1]; ++m) {
            const double amount = dot(modes[m].q[slot], u);
            for (int s = 0; s < kSlotsPerTerm; ++s) {
                const int j = terms[term][s];
                if (j >= 0 && fixed[j] == 0) visit(j, amount * modes[m].q[s]);
            }
        }
    }
    NOLI_HD static Vec3d transposed_product(const Mat3d& m, const Vec3d& u) {
        return {m.a[0] * u.x + m.a[3] * u.y + m.a[6] * u.z,
                m.a[1] * u.x + m.a[4] * u.y + m.a[7] * u.z,
                m.a[2] * u.x + m.a[5] * u.y + m.a[8] * u.z};
    }
};

namespace detail {

template <class Exec>
void fill_ints(Exec& exec, int value, View<int> out) {
    exec.for_each("linear/fill_ints", out.size, [=] NOLI_HD(int i) { out[i] = value; });
}

template <class Exec>
void invert_touched(Exec& exec, View<const int> touched, View<int> index) {
    exec.for_each("linear/invert_touched", touched.size, [=] NOLI_HD(int k) {
        index[touched[k]] = k;
    });
}

}  // namespace detail

/// Rows of the operator; `touched_index` is their memory.
template <class Exec>
OperatorRows operator_rows(Exec& exec,
                           const BlockMatrix<Exec>& matrix,
                           const LowRankTerms<Exec>& terms,
                           View<const std::uint8_t> fixed,
                           typename Exec::template Buffer<int>& touched_index) {
    touched_index.resize(matrix.num_rows());
    detail::fill_ints(exec, -1, touched_index.view());
    detail::invert_touched(exec, terms.touched(), touched_index.view());
    return {matrix.row_begin(),
            matrix.col(),
            matrix.values(),
            touched_index.view(),
            terms.touched_begin(),
            terms.slots(),
            terms.terms(),
            terms.mode_begin(),
            terms.mode_view(),
            fixed};
}

}  // namespace noli
