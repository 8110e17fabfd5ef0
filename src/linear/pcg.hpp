// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Preconditioned conjugate gradients on BlockMatrix + LowRankTerms. This text runs on
/// the CPU; a device takes that of device_pcg.hpp, which does not ask the host for
/// scalars.
///
/// Fixed unknowns are eliminated without touching the matrix: the preconditioner returns
/// 0 there, so the search directions and x stay 0, and whatever the product writes there
/// never enters a dot product.
///
/// Vector operations are a third of an iteration when written one by one, so all updates
/// and the dot product that follows them share one pass: Exec::sum calls its kernel once
/// per index, and the kernel may write.

#if !defined(__CUDACC__)
#include "exec/cpu.hpp"
#endif
#include "linear/block_jacobi.hpp"
#include "linear/device_pcg.hpp"
#include "linear/pcg_options.hpp"
#include "linear/sweep_cg.hpp"

namespace noli {

namespace detail {

/// x = 0, r = b, z = p = P⁻¹ r; returns r.z.
template <class Exec>
double pcg_start(Exec& exec,
                 View<const SymMat3d> inverse,
                 View<const Vec3d> b,
                 View<Vec3d> x,
                 View<Vec3d> r,
                 View<Vec3d> p) {
    return exec.sum("linear/pcg_start", x.size, [=] NOLI_HD(int i) {
        const Vec3d z = inverse[i] * b[i];
        x[i] = {0, 0, 0};
        r[i] = b[i];
        p[i] = z;
        return dot(b[i], z);
    });
}

/// x += alpha p, r -= alpha q, z = P⁻¹ r; returns r.z.
template <class Exec>
double pcg_update(Exec& exec,
                  View<const SymMat3d> inverse,
                  double alpha,
                  View<const Vec3d> p,
                  View<const Vec3d> q,
                  View<Vec3d> x,
                  View<Vec3d> r,
                  View<Vec3d> z) {
    return exec.sum("linear/pcg_update", x.size, [=] NOLI_HD(int i) {
        x[i] += alpha * p[i];
        r[i] -= alpha * q[i];
        z[i] = inverse[i] * r[i];
        return dot(r[i], z[i]);
    });
}

/// p = z + beta p
template <class Exec>
void pcg_direction(Exec& exec, double beta, View<const Vec3d> z, View<Vec3d> p) {
    exec.for_each("linear/pcg_direction", p.size, [=] NOLI_HD(int i) {
        p[i] = z[i] + beta * p[i];
    });
}

template <class Exec>
double dot_product(Exec& exec, View<const Vec3d> a, View<const Vec3d> b) {
    return exec.sum("linear/dot", a.size, [=] NOLI_HD(int i) { return dot(a[i], b[i]); });
}

}  // namespace detail

#if !defined(__CUDACC__)
extern template class DevicePcg<CpuExec>;  // device_pcg_cpu.cpp
#endif

/// Conjugate gradient solver; keeps its work arrays from one solve to the next.
template <class Exec>
class Pcg {
  public:
    /// Solves (matrix + terms) x = b on the free unknowns, starting from x = 0.
    ///
    /// In:   b      (num_rows) right-hand side; ignored at fixed vertices
    ///       fixed  (num_rows) non-zero where x is held at 0
    /// Out:  x      (num_rows) the last iterate, whatever the outcome
    PcgResult solve(Exec& exec,
                    const BlockMatrix<Exec>& matrix,
                    LowRankTerms<Exec>& terms,
                    View<const Vec3d> b,
                    View<const std::uint8_t> fixed,
                    const PcgOptions& options,
                    View<Vec3d> x) {
        if constexpr (!Exec::kIsDevice) {
            const bool sweeps =
                options.preconditioner == PreconditionerKind::GaussSeidel
                || options.preconditioner == PreconditionerKind::IncompleteCholesky;
            if (sweeps && !options.contacts_by_warps)
                return sweeps_.solve(exec, matrix, terms, b, fixed, options, x);
        }
        if (Exec::kIsDevice || options.contacts_by_warps)
            return device_.solve(exec, matrix, terms, b, fixed, options, x);
        [[maybe_unused]] const auto threads = stand_by(exec);
        resize(matrix.num_rows());
        PcgResult result;
        jacobi_.build(exec, matrix, terms, fixed);
        double delta =
            detail::pcg_start(exec, jacobi_.inverse(), b, x, r_.view(), p_.view());
        const double delta_start = delta;
        result.refined = delta == 0.0 && options.refine;  // solved exactly
        if (delta == 0.0) return result;
        result.residual_ratio = 1.0;
        PcgStop stop(options);
        while (!finished(stop, options, x, result)) {
            if (is_set(options.stop)) {
                result.outcome = PcgResult::Outcome::Cancelled;
                return result;
            }
            if (result.iterations == options.max_iterations) {
                result.outcome = PcgResult::Outcome::MaxIterations;
                return result;
            }
            const double curvature = apply(exec, matrix, terms);
            ++result.iterations;
            const double delta_next =
                curvature > 0.0 ? update(exec, delta / curvature, x) : HUGE_VAL;
            if (!(delta_next < HUGE_VAL)) {
                result.outcome = PcgResult::Outcome::Breakdown;
                return result;
            }
            detail::pcg_direction(
                exec, delta_next / delta, View<const Vec3d>(z_.view()), p_.view());
            stop.add(delta * delta / curvature);
            delta = delta_next;
            result.residual_ratio = delta / delta_start;
        }
        return result;
    }

    /// See ColouredOperator::set_order.
    void set_order(std::span<const int> order) {
        if constexpr (Exec::kIsDevice)
            device_.set_order(order);
        else
            sweeps_.set_order(order);
    }

    /// See SweepCg::set_aggregates and DevicePcg::set_aggregates.
    void set_aggregates(RigidAggregates aggregates) {
        if constexpr (Exec::kIsDevice)
            device_.set_aggregates(aggregates);
        else
            sweeps_.set_aggregates(std::move(aggregates));
    }

    /// Forgets what earlier solves have left: the same solves give the same bits again.
    void forget() { sweeps_.forget(); }

    /// State that the incomplete factorisation carries from solve to solve.
    ShiftMemory& shift_memory() { return sweeps_.shift_memory(); }

  private:
    static bool finished(PcgStop& stop,
                         const PcgOptions& options,
                         View<const Vec3d> x,
                         PcgResult& result) {
        if (!stop.reached(result.residual_ratio)) return false;
        if (result.refined || !options.refine || !options.refine(x)) return true;
        result.refined = true;
        stop.set_tolerance(options.fine_tolerance);
        return stop.reached(result.residual_ratio);
    }

    static auto stand_by(Exec& exec) {
        if constexpr (Exec::kIsDevice)
            return 0;
        else
            return exec.stand_by();
    }

    void resize(int n) {
        r_.resize(n);
        z_.resize(n);
        p_.resize(n);
        q_.resize(n);
    }

    /// q = A p; returns p.q.
    double apply(Exec& exec, const BlockMatrix<Exec>& matrix, LowRankTerms<Exec>& terms) {
        const View<const Vec3d> p = p_.view();
        matrix.multiply(exec, p, q_.view());
        terms.multiply_add(exec, p, q_.view());
        return detail::dot_product(exec, p, View<const Vec3d>(q_.view()));
    }

    /// x += alpha p, r -= alpha q, z = P⁻¹ r; returns r.z.
    double update(Exec& exec, double alpha, View<Vec3d> x) {
        const View<const Vec3d> p = p_.view();
        const View<const Vec3d> q = q_.view();
        return detail::pcg_update(
            exec, jacobi_.inverse(), alpha, p, q, x, r_.view(), z_.view());
    }

    BlockJacobi<Exec> jacobi_;
    SweepCg sweeps_;
    DevicePcg<Exec> device_;
    typename Exec::template Buffer<Vec3d> r_, z_, p_, q_;
};

}  // namespace noli
