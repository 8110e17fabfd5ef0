// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Conjugate gradients preconditioned by symmetric block Gauss-Seidel, at the price of
/// one product per iteration. CPU only.
///
/// With A = D + L + Lᵀ, D the 3x3 diagonal blocks, the preconditioner is
/// P = (D + L) D⁻¹ (D + Lᵀ). Take D = C Cᵀ and scale: A' = C⁻¹ A C⁻ᵀ = I + L' + L'ᵀ. Then
/// CG on
///
///     (I + L')⁻¹ A' (I + L'ᵀ)⁻¹
///
/// is CG on A with P, and Eisenstat's identity turns its product into two triangular
/// sweeps that read each block once, without a product with A:
///
///     t = (I + L'ᵀ)⁻¹ p,   q = t + (I + L')⁻¹ (p - t)
///
/// An iteration is those two sweeps and nothing else: the backward one also moves x, r
/// and p on, the forward one also gives p.q, r.q and q.q, and with these the next r.r is
/// known before r is:
///
///     r'.r' = r.r - 2 alpha r.q + alpha^2 q.q
///
/// which only decides when to stop and beta; alpha takes the r.r that is summed from r
/// itself.
///
/// Measured on real systems: about as many iterations as a block incomplete
/// factorisation, a third of block Jacobi's, with no factorisation, no shift, no state
/// between solves, and always positive definite. Contact couplings are part of L.
///
/// Source: [Eisenstat1981]; [Saad2003] 9.2.2

#include "exec/buffer.hpp"
#include "linear/coloured_operator.hpp"
#include "linear/pcg_options.hpp"

#include <cmath>

namespace noli {

namespace detail {

/// Vectors in row order, four doubles per row of which the last stays 0.
struct SweepArrays {
    View<const int> lower_begin, lower_col;  ///< with diagonal entries, which are skipped
    View<const int> upper_begin, upper_col;
    const double* lower;  ///< L', column-major 3x3 blocks
    const double* upper;  ///< L'ᵀ, column-major 3x3 blocks
    double *x, *r, *p, *t, *w;
};

/// Dot products over the rows of one group.
struct SweepSums {
    double rr =
        0.0;  ///< r.r, from the backward sweep; the others are from the forward sweep
    double pq = 0.0, rq = 0.0, qq = 0.0;
};

/// For rows end-1 down to begin: x += alpha t, r -= alpha (t + w), p = r + beta p and
/// t = p - L'ᵀ t. Returns r.r.
double sweep_backward(
    const SweepArrays& s, double alpha, double beta, int begin, int end);

/// w = p - t - L' w for rows begin to end-1. Sets the sums over q = t + w.
void sweep_forward(const SweepArrays& s, int begin, int end, SweepSums& sums);

}  // namespace detail

/// Inverse of the Cholesky factor of a 3x3 block, lower triangular, by columns padded to
/// four.
struct alignas(32) InverseFactor {
    double c0[4];  ///< (i00, i10, i20, 0)
    double c1[4];  ///< (0, i11, i21, 0)
    double c2[4];  ///< (0, 0, i22, 0)
};

/// In:   m  (3,3) symmetric
/// Out:  C⁻¹ with C Cᵀ = m; zero where m has no positive diagonal entry (an unknown that
/// cannot
///       move). Pivots within rounding of 0 are raised; false when one is below that or
///       NaN.
bool invert_factor(const Mat3d& m, InverseFactor& out);

class GaussSeidelCg {
  public:
    static constexpr int kRowsPerBlock = 16;  ///< of the row order, see ColouredOperator

    /// Same contract as Pcg::solve.
    template <class Exec>
    PcgResult solve(Exec& exec,
                    const BlockMatrix<Exec>& matrix,
                    const LowRankTerms<Exec>& terms,
                    View<const Vec3d> b,
                    View<const std::uint8_t> fixed,
                    const PcgOptions& options,
                    View<Vec3d> x) {
        PcgResult result;
        result.preconditioner = PreconditionerKind::GaussSeidel;
        bool broken = !build(exec, matrix, terms, fixed);
        const double delta_start = start(exec, b);
        double delta = delta_start;
        double alpha = 0.0;
        double beta = 0.0;
        while (!broken && delta > options.tolerance * delta_start
               && result.iterations < options.max_iterations) {
            const detail::SweepSums sums = sweep(exec, alpha, beta);
            ++result.iterations;
            alpha = sums.rr / sums.pq;
            broken = !(sums.pq > 0.0);
            if (broken) alpha = 0.0;
            delta = std::fmax(0.0, sums.rr + alpha * (alpha * sums.qq - 2.0 * sums.rq));
            beta = delta / sums.rr;
        }
        finish(exec, alpha, x);
        result.residual_ratio = delta_start > 0.0 ? delta / delta_start : 0.0;
        if (broken || !(delta_start >= 0.0))
            result.outcome = PcgResult::Outcome::Breakdown;
        else if (delta > options.tolerance * delta_start)
            result.outcome = PcgResult::Outcome::MaxIterations;
        return result;
    }

    [[nodiscard]] int num_colours() const { return op_.num_colours(); }

  private:
    /// Scaled triangles of the operator; false when a diagonal block is not positive.
    template <class Exec>
    bool build(Exec& exec,
               const BlockMatrix<Exec>& matrix,
               const LowRankTerms<Exec>& terms,
               View<const std::uint8_t> fixed) {
        OperatorCopy copy;
        const OperatorView op = view_operator(exec, matrix, terms, copy);
        if (op_.update_pattern(exec, op, fixed)) resize();
        diagonal_.resize(matrix.num_rows());
        matrix.diagonal_blocks(exec, diagonal_.view());
        terms.add_diagonal(exec, diagonal_.view());
        const View<const Mat3d> diagonal = diagonal_.view();
        std::atomic<bool> positive = true;
        op_.for_rows(exec, [&, this](int i) {
            if (!scale_row(i, diagonal)) positive.store(false, std::memory_order_relaxed);
        });
        op_.for_rows(exec, [&, this](int i) { fill_row(op, i); });
        return positive;
    }

    /// x' = 0, p = t = w = 0, r = (I + L')⁻¹ C⁻¹ b; returns r.r.
    template <class Exec>
    double start(Exec& exec, View<const Vec3d> b) {
        op_.for_rows(exec, [this, b](int i) { start_row(i, b); });
        for (int c = 0; c < op_.num_colours(); ++c)
            op_.for_groups(exec, c, [this](int g) { return forward(g), true; });
        return exec.sum(
            "linear/gs_start", op_.num_rows(), [this](int i) { return start_result(i); });
    }

    /// One iteration up to its dot products.
    template <class Exec>
    detail::SweepSums sweep(Exec& exec, double alpha, double beta) {
        for (int c = op_.num_colours() - 1; c >= 0; --c)
            op_.for_groups(exec, c, [this, alpha, beta](int g) {
                return backward(g, alpha, beta), true;
            });
        for (int c = 0; c < op_.num_colours(); ++c)
            op_.for_groups(exec, c, [this](int g) { return forward(g), true; });
        return total();
    }

    /// x = C⁻ᵀ (x' + alpha t)
    template <class Exec>
    void finish(Exec& exec, double alpha, View<Vec3d> x) {
        exec.for_each("linear/gs_finish", x.size, [this, alpha, x](int v) {
            x[v] = result(v, alpha);
        });
    }

    void resize();
    bool scale_row(int row, View<const Mat3d> diagonal);
    void fill_row(const OperatorView& op, int row);
    void start_row(int row, View<const Vec3d> b);
    double start_result(int row);
    void backward(int group, double alpha, double beta);
    void forward(int group);
    [[nodiscard]] detail::SweepSums total() const;
    [[nodiscard]] Vec3d result(int vertex, double alpha) const;
    [[nodiscard]] detail::SweepArrays arrays();

    ColouredOperator op_{kRowsPerBlock};
    HostBuffer<Mat3d> diagonal_;
    std::vector<InverseFactor> scale_;  ///< C⁻¹ per row
    std::vector<double> lower_,
        upper_;  ///< L' and L'ᵀ: column-major blocks, padded by one number
    std::vector<double> x_, r_, p_, t_, w_;
    std::vector<detail::SweepSums> sums_;  ///< per group
};

}  // namespace noli
