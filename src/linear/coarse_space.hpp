// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Rigid motions of aggregates as a deflated coarse space of sweep_cg.hpp.
///
/// Stiff material couples all of a body: sweeps alone carry a correction a few vertices
/// far per iteration. The coarse space Z holds the six rigid motions of each aggregate at
/// the present positions, and its matrix E = Zᵀ A Z, contacts included, is factored. With
/// the local preconditioner P⁻¹ the correction of a residual r is
///
///     z = P⁻¹ r + Z E⁻¹ Zᵀ (r - A P⁻¹ r)
///
/// and CG starts from Z E⁻¹ Zᵀ b, so that all residuals stay orthogonal to Z.
///
/// In the scaled rows of scaled_operator.hpp, A' = I + L' + L'ᵀ and Z' = Cᵀ Z. What is
/// stored are sparse rows with one 3x6 block per aggregate that the row is coupled to:
///
///     H = L'ᵀ Z',   V = L' Z',   E = Z'ᵀ Z' + Z'ᵀ H + Hᵀ Z'
///
/// A product with A is never needed. With sweeps in the split form, U = I + L'ᵀ, residual
/// r and y = U⁻¹ r, the residual of the scaled rows is (I + L') r, and A' y = r + L' y,
/// so that the coarse residual is
///
///     Z'ᵀ ((I + L') r - A' y) = Z'ᵀ L' (r - y) = Hᵀ (r - y)
///
/// The correction c moves the direction by U Z' c = Z' c + H c, and what U⁻¹ makes of
/// that is Z' c: the next sweep has nothing left to do. V is for other preconditioners.
///
/// Source: A-DEF2, [Tang2009]; rigid modes, [Vanek1996]; the split form is ours.

#include "linear/coarse_cholesky.hpp"
#include "linear/coarse_pattern.hpp"
#include "linear/rigid_aggregates.hpp"

#include <vector>

namespace noli {

struct InverseFactor;

class CoarseSpace {
  public:
    static constexpr int kModes = 6;
    /// Numbers of a 3x6 block: columns one after the other, and two that pad it.
    static constexpr int kBlock = 20;

    void set_aggregates(RigidAggregates aggregates);

    /// False if there are no aggregates.
    [[nodiscard]] bool available() const { return !aggregates_.empty(); }

    /// The next update_pattern depends on nothing but its operator.
    void forget_order() { cholesky_.forget_order(); }

    /// Sparsity; call when the operator's pattern changed. solve_residual needs
    /// `for_residuals`.
    void update_pattern(const ColouredOperator& op, bool for_residuals);
    [[nodiscard]] bool for_residuals() const { return for_residuals_; }

    /// Z', H, V and the factored E. `lower` and `upper` are the blocks of L' and L'ᵀ,
    /// `scale` the inverse factors per row, `x` the positions of all vertices. Without
    /// `lower` (null) only solve_split works. False where E is not finite.
    template <class Exec, class Number>
    bool update_values(Exec& exec,
                       const ColouredOperator& op,
                       const Number* lower,
                       const Number* upper,
                       const InverseFactor* scale,
                       View<const Vec3d> x) {
        exec.for_each(
            "linear/coarse_modes",
            num_aggregates(),
            [&, this](int a) { fill_modes(op, scale, x, a); },
            8);
        op.for_rows_nearby(exec,
                           [&, this](int row, int) { fill_row(op, lower, upper, row); });
        exec.for_each(
            "linear/coarse_rows",
            num_aggregates(),
            [this](int a) { fill_coarse_row(a); },
            8);
        sum_matrix();
        return cholesky_.factorize(exec, matrix_);
    }

    /// c from the residual r of the split form and y = U⁻¹ r. Vectors have four doubles
    /// per row, the last is 0.
    template <class Exec>
    void solve_split(Exec& exec, const double* r, const double* y) {
        solve_restricted(exec, [this, r, y](int a) { restrict_split(a, r, y); });
    }

    /// c = E⁻¹ Z'ᵀ b; returns c.Ec.
    template <class Exec>
    double solve_start(Exec& exec, const double* b) {
        return solve_restricted(exec, [this, b](int a) { restrict_start(a, b); });
    }

    /// c = E⁻¹ Z'ᵀ (r - A' y)
    template <class Exec>
    void solve_residual(Exec& exec, const double* r, const double* y) {
        solve_restricted(exec, [this, r, y](int a) { restrict_residual(a, r, y); });
    }

    /// For rows begin to end-1: t = y + Z' c + beta t.
    void renew(const double* y, double beta, int begin, int end, double* t) const;

    /// The same, and s = r - y + H c + beta s.
    void renew_split(const double* r,
                     const double* y,
                     double beta,
                     int begin,
                     int end,
                     double* t,
                     double* s) const;

    [[nodiscard]] int num_aggregates() const { return aggregates_.count; }

  private:
    template <class Exec, class Restrict>
    double solve_restricted(Exec& exec, const Restrict& restrict_to) {
        exec.for_each("linear/coarse_restrict", num_aggregates(), restrict_to, 8);
        return solve_coarse();
    }

    void fill_modes(const ColouredOperator& op,
                    const InverseFactor* scale,
                    View<const Vec3d> x,
                    int aggregate);
    template <class Number>
    void fill_row(const ColouredOperator& op,
                  const Number* lower,
                  const Number* upper,
                  int row);
    void fill_coarse_row(int aggregate);
    void sum_matrix();
    void restrict_start(int aggregate, const double* b);
    void restrict_split(int aggregate, const double* r, const double* y);
    void restrict_residual(int aggregate, const double* r, const double* y);
    double solve_coarse();

    RigidAggregates aggregates_;
    CoarsePattern pattern_;
    bool for_residuals_ = false;           ///< whether it has the lower couplings
    std::vector<float> modes_;             ///< Z', a block per row
    std::vector<double> pull_;             ///< H, a block per upper coupling
    std::vector<float> pull_of_;           ///< H by aggregates, in the order of upper.of
    std::vector<float> push_of_;           ///< V by aggregates, in the order of lower.of
    std::vector<Block6> coupling_, gram_;  ///< Z'ᵀ H and Z'ᵀ Z', both transposed
    CoarseMatrix matrix_;
    CoarseCholesky cholesky_;
    std::vector<double> g_, c_;
};

}  // namespace noli
