// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Rigid motions of aggregates as a coarse space of the symmetric Gauss-Seidel sweeps.
///
/// Stiff material couples all of a body: sweeps alone carry a correction a few vertices
/// far per iteration. The coarse space Z holds the six rigid motions of each aggregate at
/// the present positions, and its matrix Z^T A Z, contacts included, is factored. Added
/// to the sweeps' preconditioner P the coarse correction is
///
///     P⁻¹ + Z (Zᵀ A Z)⁻¹ Zᵀ
///
/// and in the split form of gauss_seidel_cg.hpp, U = I + L'ᵀ, Z' = Cᵀ Z:
///
///     I + W (Zᵀ A Z)⁻¹ Wᵀ,   W = U Z',   Zᵀ A Z = Z'ᵀ W + Wᵀ Z' - Z'ᵀ Z'
///
/// so that neither products with A nor further sweeps are needed. W is sparse: a row has
/// a block for its own aggregate and for those of its neighbours in the upper triangle.
///
/// Source: additive coarse correction, [Saad2003] 14.3; rigid modes, [Vanek1996]; the
/// split form is ours.

#include "linear/coarse_cholesky.hpp"
#include "linear/coloured_operator.hpp"
#include "linear/rigid_aggregates.hpp"

#include <span>
#include <vector>

namespace noli {

struct InverseFactor;

class CoarseSpace {
  public:
    static constexpr int kModes = 6;

    void set_aggregates(RigidAggregates aggregates);

    /// False if there are no aggregates.
    [[nodiscard]] bool available() const { return !aggregates_.empty(); }

    /// Sparsity of W and of the coarse matrix; call when the operator's pattern changed.
    void update_pattern(const ColouredOperator& op);

    /// W and the factored coarse matrix. `upper` are the blocks of L'ᵀ, `scale` the
    /// inverse factors per row, `x` the positions of all vertices. False where the coarse
    /// matrix is not finite.
    template <class Exec, class Number>
    bool update_values(Exec& exec,
                       const ColouredOperator& op,
                       const Number* upper,
                       const InverseFactor* scale,
                       View<const Vec3d> x) {
        exec.for_each(
            "linear/coarse_modes",
            num_aggregates(),
            [&, this](int a) { fill_modes(op, scale, x, a); },
            8);
        op.for_rows(exec, [&, this](int i) { fill_row(op, upper, i); });
        exec.for_each(
            "linear/coarse_rows",
            num_aggregates(),
            [this](int a) { fill_coarse_row(a); },
            8);
        return factorize();
    }

    /// c = (Zᵀ A Z)⁻¹ Wᵀ r; returns r . W c. r has four doubles per row.
    template <class Exec>
    double solve(Exec& exec, const double* r) {
        exec.for_each(
            "linear/coarse_restrict",
            num_aggregates(),
            [this, r](int a) { restrict_to(a, r); },
            8);
        return solve_coarse();
    }

    /// p = r + W c + beta p for rows begin to end-1; four doubles per row.
    void renew_direction(
        const double* r, double beta, int begin, int end, double* p) const;

    [[nodiscard]] int num_aggregates() const { return aggregates_.count; }

    /// One block of W.
    struct Entry {
        int aggregate;
        int coarse;  ///< place of (aggregate of the row, aggregate) in coarse_rows_
        float w[4 * kModes];  ///< by columns; the fourth number of each is 0
    };

  private:
    void fill_modes(const ColouredOperator& op,
                    const InverseFactor* scale,
                    View<const Vec3d> x,
                    int aggregate);
    template <class Number>
    void fill_row(const ColouredOperator& op, const Number* upper, int row);
    void fill_coarse_row(int aggregate);
    void find_rows(const ColouredOperator& op);
    void find_entries(const ColouredOperator& op);
    void find_coarse_pattern();
    bool factorize();
    void restrict_to(int aggregate, const double* r);
    double solve_coarse();

    RigidAggregates aggregates_;
    std::vector<int> aggregate_;          ///< per row, or -1
    std::vector<int> rows_begin_, rows_;  ///< rows of each aggregate

    std::vector<int> entry_begin_;  ///< num_rows + 1: the row's own aggregate comes first
    std::vector<Entry> entries_;
    std::vector<int> entry_row_;
    std::vector<int> by_aggregate_begin_, by_aggregate_;  ///< entries of each aggregate

    std::vector<double> modes_;                   ///< Z', 18 per row
    std::vector<int> coarse_begin_, coarse_col_;  ///< Z'ᵀ W by rows
    std::vector<Block6> coarse_rows_, gram_;      ///< Z'ᵀ W and Z'ᵀ Z' per aggregate
    CoarseMatrix matrix_;
    std::vector<int> from_;  ///< per matrix block: places in coarse_rows_, or -1: (row,
                             ///< col) and (col, row)
    CoarseCholesky cholesky_;
    std::vector<double> g_, c_;
};

}  // namespace noli
