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
#include "linear/sweep_progress.hpp"
#include "linear/sweep_vectors.hpp"

namespace noli {

class SweepCg {
  public:
    explicit SweepCg(const RowCut& cut = ScaledOperator::kRowCut) : op_(cut) {}
    /// Its parts point to each other.
    SweepCg(const SweepCg&) = delete;
    SweepCg& operator=(const SweepCg&) = delete;

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
        SweepProgress at = start(exec, b, built, stop);
        if (!built || !(at.rr >= 0.0)) {
            result.outcome = PcgResult::Outcome::Breakdown;
            vectors_.finish(exec, 0.0, x);
            return result;
        }
        bool done = at.rr == 0.0;  // solved exactly: as fine as can be
        result.refined = done && bool(options.refine);
        while (!done && result.iterations < options.max_iterations) {
            if (is_set(options.stop)) {
                result.outcome = PcgResult::Outcome::Cancelled;
                break;
            }
            ++result.iterations;
            if (!iterate_timed(exec, at)) {
                result.outcome = PcgResult::Outcome::Breakdown;
                break;
            }
            stop.add(at.decrease);
            done = stop.reached(at.ratio());
            if (done && options.refine && !result.refined) {
                vectors_.finish(exec, at.alpha, x);
                if (!options.refine(x)) break;
                result.refined = true;
                stop.set_tolerance(options.fine_tolerance);
                done = stop.reached(at.ratio());
            }
        }
        vectors_.finish(exec, at.alpha, x);
        result.residual_ratio = at.ratio();
        if (result.outcome == PcgResult::Outcome::Breakdown && op_.single()
            && !options.may_break)
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
        vectors_.resize();
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
            return coarse_.update_values(
                exec,
                op_.rows(),
                use_factor_ ? triangles.lower.view().data : nullptr,
                triangles.upper.view().data,
                op_.scale(),
                positions);
        });
    }

    /// Clears all vectors and finds the first residual.
    template <class Exec>
    SweepProgress start(Exec& exec, View<const Vec3d> b, bool built, PcgStop& stop) {
        vectors_.clear(exec, b);
        SweepProgress at;
        if (!built) return at;
        if (use_coarse_) at.coarse = start_coarse(exec);
        stop.start(at.coarse);
        // The forward sweep solves (I + L') w = s - L' w: w becomes the first residual.
        if (!use_factor_) vectors_.split(exec);
        at.rr = use_factor_ ? vectors_.start_with_s(exec) : vectors_.start_with_w(exec);
        at.first = at.rr + at.coarse;
        return at;
    }

    /// x = Z' E⁻¹ Z'ᵀ b and s = b - A' x; returns what that lowers the energy by, twice.
    template <class Exec>
    double start_coarse(Exec& exec) {
        const double decrease = coarse_.solve_start(exec, vectors_.s());
        vectors_.renew(exec, coarse_, 0.0);
        vectors_.multiply(exec);
        vectors_.take_start(exec);
        return decrease;
    }

    /// An iteration on all threads or on one, whichever is faster at present.
    template <class Exec>
    bool iterate_timed(Exec& exec, SweepProgress& at) {
        const Team* team = Team::current();
        if (team == nullptr || team->threads() == 1) return iterate(exec, at);
        double seconds = 0.0;
        bool positive = false;
        {
            const AloneScope scope(!sharing_.shared());
            const PhaseTimer timer(seconds);
            positive = iterate(exec, at);
        }
        sharing_.took(seconds);
        return positive;
    }

    /// False if the operator is not positive definite.
    template <class Exec>
    bool iterate(Exec& exec, SweepProgress& at) {
        if (use_factor_) return iterate_factor(exec, at);
        return use_coarse_ ? iterate_split(exec, at) : iterate_sweeps(exec, at);
    }

    /// Gauss-Seidel alone.
    template <class Exec>
    bool iterate_sweeps(Exec& exec, SweepProgress& at) {
        vectors_.backward(exec, at.alpha, at.beta);
        vectors_.forward(exec);
        const detail::SweepSums sums = vectors_.total();
        if (!(sums.pq > 0.0)) {
            at.alpha = 0.0;
            return false;
        }
        at.alpha = sums.rr / sums.pq;
        at.decrease = at.alpha * sums.rr;
        at.rr = sums.square_after(at.alpha);
        at.beta = at.rr / sums.rr;
        return true;
    }

    /// Gauss-Seidel with the coarse space.
    template <class Exec>
    bool iterate_split(Exec& exec, SweepProgress& at) {
        vectors_.residual(exec, at.alpha);
        const double rr = vectors_.total().rr;
        if (!at.begin_direction(rr)) return rr == 0.0;
        coarse_.solve_split(exec, vectors_.r(), vectors_.y());
        vectors_.renew_split(exec, coarse_, at.beta);
        vectors_.split(exec);
        const detail::SweepSums sums = vectors_.total();
        if (!at.take_step(sums)) return false;
        at.rr = detail::SweepSums{.rr = rr, .rq = sums.rq, .qq = sums.qq}.square_after(
            at.alpha);
        return true;
    }

    /// IC(0), with the coarse space or without.
    template <class Exec>
    bool iterate_factor(Exec& exec, SweepProgress& at) {
        const bool first = at.last == 0.0;
        vectors_.factor_forward(exec, at.alpha);
        vectors_.factor_backward(exec);
        const double rr = vectors_.total().rr;
        if (first) at.first = rr + at.coarse;
        if (!at.begin_direction(rr)) return rr == 0.0;
        at.rr = rr;
        if (use_coarse_) {
            coarse_.solve_residual(exec, vectors_.r(), vectors_.y());
            vectors_.renew(exec, coarse_, at.beta);
        } else {
            vectors_.renew(exec, at.beta);
        }
        vectors_.multiply(exec);
        return at.take_step(vectors_.total());
    }

    ScaledOperator op_;
    IncompleteCholesky factor_;
    SweepVectors vectors_{op_, factor_};
    CoarseSpace coarse_;
    Sharing sharing_;
    bool use_factor_ = false;
    bool use_coarse_ = false;
    bool coarse_is_current_ = false;  ///< its pattern is that of op_
};

}  // namespace noli
