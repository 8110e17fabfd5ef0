// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Preconditioned conjugate gradients without a word from the host: the same iteration as
/// pcg.hpp, with its scalars in the memory of the device (pcg_state.hpp).
///
/// The host queues iterations in batches, as one recording that is replayed, and looks at
/// the state once per batch; iterations behind the last one do nothing. So a solve needs
/// one small download per batch, whatever the number of iterations.
///
/// Runs on every executor; on those of the CPU it gives the bits of pcg.hpp with block
/// Jacobi. Its loops are in device_pcg_loops.hpp.

#include "linear/block_jacobi.hpp"
#include "linear/dense_terms.hpp"
#include "linear/device_pcg_loops.hpp"
#include "linear/pcg_options.hpp"
#include "linear/rigid_coarse.hpp"
#include "linear/schwarz_banks.hpp"

#include <algorithm>
#include <span>
#include <vector>

namespace noli {

template <class Exec>
class DevicePcg {
  public:
    /// Same contract as Pcg::solve.
    ///
    /// Preconditioner: GaussSeidel or BlockJacobi: block Jacobi; Schwarz: banks of 32
    /// vertices; either with rigid motions of aggregates where there are such and
    /// options.positions are given.
    PcgResult solve(Exec& exec,
                    const BlockMatrix<Exec>& matrix,
                    LowRankTerms<Exec>& terms,
                    View<const Vec3d> b,
                    View<const std::uint8_t> fixed,
                    const PcgOptions& options,
                    View<Vec3d> x) {
        build(exec, matrix, terms, fixed, options);
        start(exec, b, fixed, options, x);
        iterate(exec, matrix, terms, fixed, x);  // all kernels loaded, all buffers sized
        exec.record(recording_, x.size, [&] { iterate(exec, matrix, terms, fixed, x); });
        bool refined = false;
        int batch = kFirstBatch - 1;
        while (true) {
            if (is_set(options.stop)) return {.outcome = PcgResult::Outcome::Cancelled};
            for (int k = 0; k < batch; ++k)
                exec.replay(recording_);
            batch = kBatch;
            const PcgState now = exec.read(View<const PcgState>(state_.view()), 0);
            if (now.status == PcgState::Status::Reached && wants_finer(options, now)
                && !refined && options.refine(x)) {
                refined = true;
                detail::device_refine(exec, state_.view(), options.fine_tolerance);
            } else if (now.status != PcgState::Status::Running) {
                return result(now, refined || (options.refine && now.delta_start == 0.0));
            }
        }
    }

    /// Banks are cut from this order of the vertices.
    void set_order(std::span<const int> order) { banks_.set_order(order); }

    /// See RigidCoarse::set_aggregates.
    void set_aggregates(const RigidAggregates& aggregates,
                        int most_dense_nodes = kMostDenseNodes) {
        coarse_.set_aggregates(aggregates, most_dense_nodes);
    }

  private:
    /// Iterations before the host looks at the state, the first time and then; on the CPU
    /// a look costs nothing.
    static constexpr int kFirstBatch = Exec::kIsDevice ? 16 : 1;
    static constexpr int kBatch = Exec::kIsDevice ? 32 : 1;

    /// A right-hand side of 0 has been solved exactly.
    static bool wants_finer(const PcgOptions& options, const PcgState& now) {
        return options.refine && now.delta_start != 0.0;
    }

    [[nodiscard]] PcgResult result(const PcgState& now, bool refined) const {
        PcgResult out;
        out.iterations = now.iterations;
        out.refined = refined;
        out.residual_ratio = now.ratio;
        out.preconditioner =
            use_banks_ ? PreconditionerKind::Schwarz : PreconditionerKind::BlockJacobi;
        if (now.status == PcgState::Status::MaxIterations)
            out.outcome = PcgResult::Outcome::MaxIterations;
        if (now.status == PcgState::Status::Breakdown)
            out.outcome = PcgResult::Outcome::Breakdown;
        return out;
    }

    void build(Exec& exec,
               const BlockMatrix<Exec>& matrix,
               LowRankTerms<Exec>& terms,
               View<const std::uint8_t> fixed,
               const PcgOptions& options) {
        const int n = matrix.num_rows();
        r_.resize(n);
        z_.resize(n);
        p_.resize(n);
        q_.resize(n);
        use_banks_ = options.preconditioner == PreconditionerKind::Schwarz;
        use_coarse_ = options.positions.size > 0 && coarse_.available();
        use_dense_ = options.contacts_by_warps;
        if (use_dense_) dense_.build(exec, terms);
        if (!use_banks_) jacobi_.build(exec, matrix, terms, fixed);
        if (!use_banks_ && !use_coarse_) return;
        const OperatorRows op = operator_rows(exec, matrix, terms, fixed, touched_index_);
        if (use_banks_) banks_.build(exec, op);
        if (use_coarse_) coarse_.build(exec, op, fixed, options.positions);
    }

    void start(Exec& exec,
               View<const Vec3d> b,
               View<const std::uint8_t> fixed,
               const PcgOptions& options,
               View<Vec3d> x) {
        PcgState state;
        state.stop = PcgStop(options);
        state.max_iterations = options.max_iterations;
        state_.resize(1);
        detail::device_set_state(exec, state, state_.view());
        detail::device_clear(exec, b, x, r_.view());
        if (use_banks_ || use_coarse_)
            precondition(exec, true, fixed, p_.view());
        else
            detail::device_begin(exec,
                                 state_.view(),
                                 jacobi_.inverse(),
                                 View<const Vec3d>(r_.view()),
                                 p_.view());
    }

    /// One iteration: product, alpha, step, preconditioner, beta, direction.
    void iterate(Exec& exec,
                 const BlockMatrix<Exec>& matrix,
                 LowRankTerms<Exec>& terms,
                 View<const std::uint8_t> fixed,
                 View<Vec3d> x) {
        const View<const Vec3d> p = p_.view();
        const View<const Vec3d> q = q_.view();
        const View<const PcgState> state = state_.view();
        exec.for_lanes(
            "linear/device_product",
            matrix.num_rows(),
            detail::GuardedProductKernel{
                state,
                {matrix.row_begin(), matrix.col(), matrix.values(), p, q_.view()}});
        const bool* skip = &state_.view().data->skip;
        if (use_dense_)
            dense_.multiply_add(exec, p, q_.view(), skip);
        else
            terms.multiply_add(exec, p, q_.view(), skip);
        detail::device_curvature(exec, state_.view(), p, q);
        if (use_banks_ || use_coarse_) {
            detail::device_advance(exec, state, p, q, x, r_.view());
            precondition(exec, false, fixed, z_.view());
        } else {
            detail::device_update(
                exec, state_.view(), jacobi_.inverse(), p, q, x, r_.view(), z_.view());
        }
        detail::device_direction(exec, state, View<const Vec3d>(z_.view()), p_.view());
    }

    /// out = P⁻¹ r; then the state knows r.out.
    void precondition(Exec& exec,
                      bool is_first,
                      View<const std::uint8_t> fixed,
                      View<Vec3d> out) {
        const View<const Vec3d> r = r_.view();
        const View<const PcgState> state = state_.view();
        if (use_banks_) banks_.apply(exec, state, r, out);
        typename RigidCoarse<Exec>::Correction correction{};
        if (use_coarse_) {
            coarse_.solve(exec, state, r);
            correction = coarse_.correction();
        }
        detail::device_combine(exec,
                               state_.view(),
                               is_first,
                               use_banks_,
                               use_banks_ ? View<const SymMat3d>{} : jacobi_.inverse(),
                               correction,
                               fixed,
                               r,
                               out);
    }

    BlockJacobi<Exec> jacobi_;
    SchwarzBanks<Exec> banks_;
    RigidCoarse<Exec> coarse_;
    bool use_banks_ = false;
    bool use_coarse_ = false;
    DenseTerms<Exec> dense_;
    bool use_dense_ = false;
    typename Exec::template Buffer<Vec3d> r_, z_, p_, q_;
    typename Exec::template Buffer<int> touched_index_;
    typename Exec::template Buffer<PcgState> state_;
    typename Exec::Recording recording_;
};

}  // namespace noli
