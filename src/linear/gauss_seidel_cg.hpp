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
#include "linear/coarse_space.hpp"
#include "linear/coloured_operator.hpp"
#include "linear/pcg_options.hpp"
#include "linear/sweeps.hpp"

#include <cmath>

namespace noli {

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
        [[maybe_unused]] const auto threads = exec.stand_by();
        PcgResult result;
        result.preconditioner = PreconditionerKind::GaussSeidel;
        bool broken = !build(exec, matrix, terms, fixed, options);
        Progress at;
        at.start(start(exec, b));
        PcgStop stop(options);
        if (broken || !(at.rr >= 0.0)) {
            result.outcome = PcgResult::Outcome::Breakdown;
            finish(exec, 0.0, x);
            return result;
        }
        bool done = at.rr == 0.0;
        if (use_coarse_ && !done) start_coarse(exec, at);
        while (!done && result.iterations < options.max_iterations) {
            ++result.iterations;
            if (!(use_coarse_ ? iterate_coarse(exec, at) : iterate(exec, at))) {
                result.outcome = PcgResult::Outcome::Breakdown;
                break;
            }
            stop.add(at.decrease);
            done = stop.reached(at.ratio());
            if (done && options.refine && !result.refined) {
                finish(exec, at.alpha, x);
                if (!options.refine(x)) break;
                result.refined = true;
                stop.set_tolerance(options.fine_tolerance);
                done = stop.reached(at.ratio());
            }
        }
        finish(exec, at.alpha, x);
        result.residual_ratio = at.ratio();
        if (result.outcome == PcgResult::Outcome::Breakdown && single_)
            return solve_in_double(exec, matrix, terms, b, fixed, options, x);
        if (!done && result.outcome == PcgResult::Outcome::Converged)
            result.outcome = PcgResult::Outcome::MaxIterations;
        return result;
    }

    /// Rigid motions of these aggregates help where PcgOptions::positions are given.
    void set_aggregates(RigidAggregates aggregates) {
        coarse_.set_aggregates(std::move(aggregates));
        coarse_is_current_ = false;
    }

    /// See ColouredOperator::set_order.
    void set_order(std::span<const int> order) { op_.set_order(order); }

    [[nodiscard]] int num_colours() const { return op_.num_colours(); }

  private:
    /// Where the iteration stands. `rr` is r.P⁻¹r of the split system.
    struct Progress {
        double rr = 0.0;
        double first = 0.0;  ///< rr at the start
        double alpha = 0.0;  ///< of the step that x, r still have to take
        double beta = 0.0;
        double decrease = 0.0;  ///< alpha rr of the last iteration

        void start(double r_dot_r) { rr = first = r_dot_r; }
        [[nodiscard]] double ratio() const { return first > 0.0 ? rr / first : 0.0; }
    };

    /// Blocks stored in single precision may no longer be positive definite.
    template <class Exec>
    PcgResult solve_in_double(Exec& exec,
                              const BlockMatrix<Exec>& matrix,
                              const LowRankTerms<Exec>& terms,
                              View<const Vec3d> b,
                              View<const std::uint8_t> fixed,
                              PcgOptions options,
                              View<Vec3d> x) {
        options.inertia = {};
        return solve(exec, matrix, terms, b, fixed, options, x);
    }

    /// One iteration of sweeps alone. False if the operator is not positive definite.
    template <class Exec>
    bool iterate(Exec& exec, Progress& at) {
        const detail::SweepSums sums = sweep(exec, at.alpha, at.beta);
        if (!(sums.pq > 0.0)) {
            at.alpha = 0.0;
            return false;
        }
        at.alpha = sums.rr / sums.pq;
        at.decrease = at.alpha * sums.rr;
        at.rr = std::fmax(0.0, sums.rr + at.alpha * (at.alpha * sums.qq - 2.0 * sums.rq));
        at.beta = at.rr / sums.rr;
        return true;
    }

    /// p = r + W c
    template <class Exec>
    void start_coarse(Exec& exec, Progress& at) {
        const double r_dot_r = at.rr;
        at.start(r_dot_r + coarse_.solve(exec, r_.data()));
        renew_direction(exec, 0.0);
    }

    /// p = r + W c + beta p
    template <class Exec>
    void renew_direction(Exec& exec, double beta) {
        constexpr int kRows = 128;
        const int n = op_.num_rows();
        exec.for_each(
            "linear/gs_direction",
            (n + kRows - 1) / kRows,
            [this, beta, n](int part) {
                coarse_.renew_direction(r_.data(),
                                        beta,
                                        part * kRows,
                                        std::min(n, (part + 1) * kRows),
                                        p_.data());
            },
            1);
    }

    /// One iteration with the coarse correction; at its end x, r and p are up to date.
    template <class Exec>
    bool iterate_coarse(Exec& exec, Progress& at) {
        for (int c = op_.num_colours() - 1; c >= 0; --c)
            op_.for_groups(exec, c, [this](int g) { return backward_alone(g), true; });
        for (int c = 0; c < op_.num_colours(); ++c)
            op_.for_groups(exec, c, [this](int g) { return forward(g), true; });
        const double pq = total().pq;
        if (!(pq > 0.0)) return false;
        const double alpha = at.rr / pq;
        at.decrease = alpha * at.rr;
        const double rr = exec.sum("linear/gs_advance",
                                   op_.num_rows(),
                                   [this, alpha](int i) { return advance(i, alpha); });
        const double next = rr + coarse_.solve(exec, r_.data());
        const double beta = next / at.rr;
        renew_direction(exec, beta);
        at.rr = next;
        return true;
    }

    /// Scaled triangles of the operator; false when a diagonal block is not positive.
    template <class Exec>
    bool build(Exec& exec,
               const BlockMatrix<Exec>& matrix,
               const LowRankTerms<Exec>& terms,
               View<const std::uint8_t> fixed,
               const PcgOptions& options) {
        const View<const double> inertia = options.inertia;
        OperatorCopy copy;
        const OperatorView op = view_operator(exec, matrix, terms, copy);
        if (op_.update_pattern(exec, op, fixed)) {
            resize();
            coarse_is_current_ = false;
        }
        diagonal_.resize(matrix.num_rows());
        matrix.diagonal_blocks(exec, diagonal_.view());
        terms.add_diagonal(exec, diagonal_.view());
        const View<const Mat3d> diagonal = diagonal_.view();
        std::atomic<bool> positive = true;
        const double least =
            exec.min("linear/gs_scale", op_.num_rows(), [&, this](int i) {
                if (!scale_row(i, diagonal))
                    positive.store(false, std::memory_order_relaxed);
                return inertia_share(i, diagonal, inertia);
            });
        choose_precision(inertia.size > 0 ? least : 0.0);
        op_.for_rows(exec, [&, this](int i) { fill_row(op, i); });
        use_coarse_ = options.positions.size > 0 && coarse_.available();
        return positive && (!use_coarse_ || build_coarse(exec, options.positions));
    }

    template <class Exec>
    bool build_coarse(Exec& exec, View<const Vec3d> positions) {
        if (!coarse_is_current_) coarse_.update_pattern(op_);
        coarse_is_current_ = true;
        const InverseFactor* scale = scale_.data();
        return single_ ? coarse_.update_values(
                   exec, op_, single_blocks_.upper.data(), scale, positions)
                       : coarse_.update_values(
                           exec, op_, double_blocks_.upper.data(), scale, positions);
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
    void backward_alone(int group);
    void forward(int group);
    double advance(int row, double alpha);
    [[nodiscard]] detail::SweepSums total() const;
    [[nodiscard]] Vec3d result(int vertex, double alpha) const;
    template <class Number>
    struct Triangles {
        std::vector<Number> lower, upper;  ///< L' and L'ᵀ: column-major blocks, padded
    };

    /// Single precision stores blocks with an error of 6e-8 of the diagonal ones. A
    /// motion that strains nothing sees inertia alone: where that is at least this share
    /// of the diagonal, it is met to 0.1 % or better.
    static constexpr double kSinglePrecisionInertia = 1e-4;

    [[nodiscard]] double inertia_share(int row,
                                       View<const Mat3d> diagonal,
                                       View<const double> inertia) const;
    void choose_precision(double least_inertia);
    template <class Number>
    void scale_row_blocks(Triangles<Number>& to, int row, const Mat3d* blocks);
    template <class Number>
    [[nodiscard]] detail::SweepArrays<Number> arrays(const Triangles<Number>& blocks);

    ColouredOperator op_{kRowsPerBlock};
    HostBuffer<Mat3d> diagonal_;
    std::vector<InverseFactor> scale_;  ///< C⁻¹ per row
    Triangles<double> double_blocks_;
    Triangles<float> single_blocks_;
    bool single_ = false;
    CoarseSpace coarse_;
    bool use_coarse_ = false;
    bool coarse_is_current_ = false;  ///< its pattern is that of op_
    std::vector<double> x_, r_, p_, t_, w_;
    std::vector<detail::SweepSums> sums_;  ///< per group
};

}  // namespace noli
