// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Conjugate gradients on the scaled rows A' = I + L' + L'ᵀ (scaled_operator.hpp), with a
/// preconditioner that sweeps over them: symmetric block Gauss-Seidel or block IC(0),
/// alone or with a coarse space of rigid motions. CPU only.
///
/// **Gauss-Seidel** is P = (D + L) D⁻¹ (D + Lᵀ), (I + L')(I + L'ᵀ) in scaled rows. CG on
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
/// **With a coarse space** (coarse_space.hpp) an iteration is the same two sweeps. The
/// backward one finds y = (I + L'ᵀ)⁻¹ r, which the coarse residual is made of; with the
/// coarse correction c the directions p and t = (I + L'ᵀ)⁻¹ p become
///
///     t = y + Z' c + beta t,   p - t = (r - y) + H c + beta (p - t)
///
/// so that t needs no sweep of its own. CG starts from the coarse solution; its decrease
/// of the energy counts as an iteration before the first.
///
/// **IC(0)** (incomplete_cholesky.hpp) has no such identity: an iteration is one product
/// and the two sweeps of the factor. It takes fewer, and pays where contacts are much
/// stiffer than all else.
///
/// Gauss-Seidel needs no factorisation, no shift, no state between solves, and is always
/// positive definite. Contact couplings are part of L.
///
/// Source: [Eisenstat1981]; [Saad2003] 9.2.2; with a coarse space: [Tang2009] A-DEF2, the
/// split form is ours.

#include "core/timer.hpp"
#include "exec/sharing.hpp"
#include "exec/team.hpp"
#include "linear/coarse_space.hpp"
#include "linear/incomplete_cholesky.hpp"
#include "linear/pcg_options.hpp"
#include "linear/scaled_operator.hpp"

#include <algorithm>

namespace noli {

class SweepCg {
  public:
    /// Same contract as Pcg::solve. IC(0) that cannot be built becomes Gauss-Seidel.
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
        PcgStop stop(options);
        const bool built = build(exec, matrix, terms, fixed, options);
        result.preconditioner = use_factor_ ? PreconditionerKind::IncompleteCholesky
                                            : PreconditionerKind::GaussSeidel;
        Progress at = start(exec, b, built, stop);
        if (!built || !(at.rr >= 0.0)) {
            result.outcome = PcgResult::Outcome::Breakdown;
            finish(exec, 0.0, x);
            return result;
        }
        bool done = at.rr == 0.0;
        while (!done && result.iterations < options.max_iterations) {
            ++result.iterations;
            if (!iterate_timed(exec, at)) {
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
        if (result.outcome == PcgResult::Outcome::Breakdown && op_.single())
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

    /// Forgets what earlier solves have left: the same solves give the same bits again.
    void forget() {
        factor_.memory() = {};
        coarse_.forget_order();
        coarse_is_current_ = false;
    }

    /// State that IC(0) carries from solve to solve.
    ShiftMemory& shift_memory() { return factor_.memory(); }

  private:
    /// Where the iteration stands. `rr` is r.P⁻¹r of the local preconditioner P; with a
    /// coarse space r.z is the same, because residuals are orthogonal to it.
    struct Progress {
        double rr = 0.0;        ///< IC(0): of the residual before the last step
        double first = 0.0;     ///< rr at the start, and `coarse`
        double coarse = 0.0;    ///< what the coarse start lowered the energy by, twice
        double last = 0.0;      ///< the rr that the last direction was made from; 0: none
        double alpha = 0.0;     ///< of the step that x, r still have to take
        double beta = 0.0;      ///< of the sweeps alone
        double decrease = 0.0;  ///< of the last step: alpha r.p

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

    /// False when a diagonal block is not positive or the coarse matrix is not finite.
    template <class Exec>
    bool build(Exec& exec,
               const BlockMatrix<Exec>& matrix,
               const LowRankTerms<Exec>& terms,
               View<const std::uint8_t> fixed,
               const PcgOptions& options) {
        const ScaledOperator::Built built =
            op_.build(exec, matrix, terms, fixed, options.inertia);
        use_factor_ = false;
        resize();
        if (built != ScaledOperator::Built::NewValues) coarse_is_current_ = false;
        use_coarse_ = options.positions.size > 0 && coarse_.available();
        if (built == ScaledOperator::Built::NotPositive) return false;
        use_factor_ = options.preconditioner == PreconditionerKind::IncompleteCholesky
                   && factor_.build(exec, op_);
        return !use_coarse_ || build_coarse(exec, options.positions);
    }

    template <class Exec>
    bool build_coarse(Exec& exec, View<const Vec3d> positions) {
        if (!coarse_is_current_ || (use_factor_ && !coarse_.for_residuals()))
            coarse_.update_pattern(op_.rows(), use_factor_);
        coarse_is_current_ = true;
        return op_.with_triangles([&](const auto& triangles) {
            return coarse_.update_values(exec,
                                         op_.rows(),
                                         use_factor_ ? triangles.lower.data() : nullptr,
                                         triangles.upper.data(),
                                         op_.scale(),
                                         positions);
        });
    }

    /// Clears all vectors and finds the first residual.
    template <class Exec>
    Progress start(Exec& exec, View<const Vec3d> b, bool built, PcgStop& stop) {
        op_.rows().for_rows(exec, [this, b](int i) { clear_row(i, b); });
        Progress at;
        if (!built) return at;
        if (use_coarse_) at.coarse = start_coarse(exec);
        stop.start(at.coarse);
        // The forward sweep solves (I + L') w = s - L' w: w becomes the first residual.
        if (!use_factor_) forward(exec);
        at.rr = exec.sum("linear/sweep_start", op_.rows().num_rows(), [this](int i) {
            return start_row(i);
        });
        at.first = at.rr + at.coarse;
        return at;
    }

    /// x = Z' E⁻¹ Z'ᵀ b and s = b - A' x; returns what that lowers the energy by, twice.
    template <class Exec>
    double start_coarse(Exec& exec) {
        const double decrease = coarse_.solve_start(exec, s_.data());
        renew(exec, 0.0);
        multiply(exec);
        op_.rows().for_rows(exec, [this](int i) { take_start(i); });
        return decrease;
    }

    /// An iteration on all threads or on one, whichever is faster at present.
    template <class Exec>
    bool iterate_timed(Exec& exec, Progress& at) {
        Team* team = Team::current();
        if (team == nullptr || team->threads() == 1) return iterate(exec, at);
        double seconds = 0.0;
        bool positive = false;
        {
            const PhaseTimer timer(seconds);
            team->share(sharing_.shared());
            positive = iterate(exec, at);
            team->share(true);
        }
        sharing_.took(seconds);
        return positive;
    }

    /// False if the operator is not positive definite.
    template <class Exec>
    bool iterate(Exec& exec, Progress& at) {
        if (use_factor_) return iterate_factor(exec, at);
        return use_coarse_ ? iterate_split(exec, at) : iterate_sweeps(exec, at);
    }

    /// Gauss-Seidel alone.
    template <class Exec>
    bool iterate_sweeps(Exec& exec, Progress& at) {
        for_colours_back(exec, [this, &at](int g) { backward(g, at.alpha, at.beta); });
        for_colours(exec, [this](int g) { forward_group(g); });
        const detail::SweepSums sums = total();
        if (!(sums.pq > 0.0)) {
            at.alpha = 0.0;
            return false;
        }
        at.alpha = sums.rr / sums.pq;
        at.decrease = at.alpha * sums.rr;
        at.rr = next_square(sums, at.alpha);
        at.beta = at.rr / sums.rr;
        return true;
    }

    /// Gauss-Seidel with the coarse space.
    template <class Exec>
    bool iterate_split(Exec& exec, Progress& at) {
        for_colours_back(exec, [this, &at](int g) { residual(g, at.alpha); });
        const double rr = total().rr;
        if (!begin_direction(at, rr)) return rr == 0.0;
        coarse_.solve_split(exec, r_.data(), y_.data());
        renew_split(exec, at.beta);
        forward(exec);
        const detail::SweepSums sums = total();
        if (!take_step(at, sums)) return false;
        at.rr = next_square({.rr = rr, .rq = sums.rq, .qq = sums.qq}, at.alpha);
        return true;
    }

    /// IC(0), with the coarse space or without.
    template <class Exec>
    bool iterate_factor(Exec& exec, Progress& at) {
        const bool first = at.last == 0.0;
        for_colours(exec, [this, &at](int g) { factor_forward(g, at.alpha); });
        for_colours_back(exec, [this](int g) { factor_backward(g); });
        const double rr = total().rr;
        if (first) at.first = rr + at.coarse;
        if (!begin_direction(at, rr)) return rr == 0.0;
        at.rr = rr;
        if (use_coarse_) coarse_.solve_residual(exec, r_.data(), y_.data());
        renew(exec, at.beta);
        multiply(exec);
        return take_step(at, total());
    }

    /// beta of the next direction from r.P⁻¹r; false when there is none.
    static bool begin_direction(Progress& at, double rr) {
        at.alpha = 0.0;
        if (!(rr > 0.0)) {
            at.rr = rr;
            at.decrease = 0.0;
            return false;
        }
        at.beta = at.last > 0.0 ? rr / at.last : 0.0;
        at.last = rr;
        return true;
    }

    /// The step along p that lowers the energy most.
    static bool take_step(Progress& at, const detail::SweepSums& sums) {
        if (!(sums.pq > 0.0)) return false;
        at.alpha = sums.rp / sums.pq;
        at.decrease = at.alpha * sums.rp;
        return true;
    }

    /// r.r after a step.
    static double next_square(const detail::SweepSums& sums, double alpha) {
        return std::fmax(0.0, sums.rr + alpha * (alpha * sums.qq - 2.0 * sums.rq));
    }

    template <class Exec, class F>
    void for_colours(Exec& exec, const F& f) const {
        for (int c = 0; c < op_.rows().num_colours(); ++c)
            op_.rows().for_groups(exec, c, [&f](int g) { return f(g), true; });
    }
    template <class Exec, class F>
    void for_colours_back(Exec& exec, const F& f) const {
        for (int c = op_.rows().num_colours() - 1; c >= 0; --c)
            op_.rows().for_groups(exec, c, [&f](int g) { return f(g), true; });
    }

    /// w = s - L' w
    template <class Exec>
    void forward(Exec& exec) {
        for_colours(exec, [this](int g) { split(g); });
    }

    /// w = A' t
    template <class Exec>
    void multiply(Exec& exec) {
        exec.for_each(
            "linear/sweep_multiply",
            op_.rows().num_groups(),
            [this](int g) { multiply_group(g); },
            1);
    }

    template <class Exec, class F>
    void for_parts(Exec& exec, const char* name, const F& f) const {
        constexpr int kRows = 128;
        const int n = op_.rows().num_rows();
        exec.for_each(
            name,
            (n + kRows - 1) / kRows,
            [&f, n](int part) { f(part * kRows, std::min(n, (part + 1) * kRows)); },
            1);
    }

    /// t = y + Z' c + beta t; without a coarse space c is 0.
    template <class Exec>
    void renew(Exec& exec, double beta) {
        for_parts(exec, "linear/sweep_direction", [this, beta](int begin, int end) {
            if (use_coarse_)
                coarse_.renew(y_.data(), beta, begin, end, t_.data());
            else
                renew_rows(beta, begin, end);
        });
    }

    template <class Exec>
    void renew_split(Exec& exec, double beta) {
        for_parts(exec, "linear/sweep_direction", [this, beta](int begin, int end) {
            coarse_.renew_split(
                r_.data(), y_.data(), beta, begin, end, t_.data(), s_.data());
        });
    }

    /// x = C⁻ᵀ (x' + alpha t)
    template <class Exec>
    void finish(Exec& exec, double alpha, View<Vec3d> x) {
        exec.for_each("linear/sweep_finish", x.size, [this, alpha, x](int v) {
            x[v] = result(v, alpha);
        });
    }

    void resize();
    void clear_row(int row, View<const Vec3d> b);
    void take_start(int row);
    double start_row(int row);
    void backward(int group, double alpha, double beta);
    void forward_group(int group);
    void residual(int group, double alpha);
    void split(int group);
    void multiply_group(int group);
    void factor_forward(int group, double alpha);
    void factor_backward(int group);
    void renew_rows(double beta, int begin, int end);
    [[nodiscard]] detail::SweepSums total() const;
    [[nodiscard]] Vec3d result(int vertex, double alpha) const;
    /// f(arrays, first row, end row) of a group.
    template <class F>
    auto with_arrays(int group, const F& f);

    ScaledOperator op_;
    IncompleteCholesky factor_;
    CoarseSpace coarse_;
    Sharing sharing_;
    bool use_factor_ = false;
    bool use_coarse_ = false;
    bool coarse_is_current_ = false;                 ///< its pattern is that of op_
    std::vector<double> x_, r_, p_, t_, w_, y_, s_;  ///< four numbers per row
    std::vector<detail::SweepSums> sums_;            ///< per group
};

}  // namespace noli
