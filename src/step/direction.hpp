// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The Newton direction: solves H p = -g on the free vertices, with the prescribed
/// vertices moving by what is left of their motion in this step (elimination, never a
/// penalty).

#include "core/morton.hpp"
#include "linear/cholmod_solver.hpp"
#include "linear/pcg.hpp"
#include "objective/objective.hpp"
#include "step/boundary_path.hpp"
#include "step/settings.hpp"
#include "step/single_axes.hpp"
#include "step/sound_travel.hpp"

namespace noli {

struct DirectionResult {
    int iterations = 0;  ///< of PCG; 1 for a direct solve
    bool fine = true;    ///< found to the fine tolerance
    bool ok = true;
    bool cancelled = false;  ///< on request, in the middle of it
    std::string trouble;     ///< why not ok
};

namespace detail {

template <class Exec>
void remaining_motion(Exec& exec,
                      View<const std::uint8_t> fixed,
                      View<const Vec3d> target,
                      View<const Vec3d> x,
                      View<Vec3d> out) {
    exec.for_each("step/remaining_motion", x.size, [=] NOLI_HD(int i) {
        out[i] = fixed[i] ? target[i] - x[i] : Vec3d{0.0, 0.0, 0.0};
    });
}

template <class Exec>
void right_hand_side(Exec& exec,
                     View<const std::uint8_t> fixed,
                     View<const Vec3d> gradient,
                     View<const Vec3d> pushed,
                     View<Vec3d> out) {
    exec.for_each("step/right_hand_side", out.size, [=] NOLI_HD(int i) {
        out[i] = fixed[i] ? Vec3d{0.0, 0.0, 0.0} : -gradient[i] - pushed[i];
    });
}

template <class Exec>
void free_residual(Exec& exec,
                   View<const std::uint8_t> fixed,
                   double scale,
                   View<const Vec3d> gradient,
                   View<Vec3d> out) {
    exec.for_each("step/free_residual", out.size, [=] NOLI_HD(int i) {
        out[i] = fixed[i] ? Vec3d{0.0, 0.0, 0.0} : scale * gradient[i];
    });
}

template <class Exec>
Later max_component(Exec& exec, View<const Vec3d> a) {
    return exec.max_later(
        "step/max_component", a.size, [=] NOLI_HD(int i) { return max_abs(a[i]); });
}

template <class Exec>
Later max_free_component(Exec& exec,
                         View<const Vec3d> a,
                         View<const std::uint8_t> fixed) {
    return exec.max_later("step/max_free_component", a.size, [=] NOLI_HD(int i) {
        return fixed[i] ? 0.0 : max_abs(a[i]);
    });
}

}  // namespace detail

template <class Exec>
class DirectionSolver {
  public:
    DirectionSolver(const Model& model, double dt, LinearSolver linear) {
        const int num_vertices = model.num_vertices;
        const std::vector<int> order = morton_order(model.places());
        pcg_.set_order(order);
        const int size = piece_size(model, dt, linear, Exec::kIsDevice);
        if (size > 0) pcg_.set_aggregates(cut_aggregates(model.tets, order, size));
        rhs_.resize(num_vertices);
        prescribed_.resize(num_vertices);
        pushed_.resize(num_vertices);
    }

    /// Forgets what solves of earlier steps have left, for a resumed run has none of it.
    /// axes: of vertices that are prescribed on single axes (single_axes.hpp).
    void begin_step(View<const std::uint8_t> axes = {}) {
        pcg_.forget();
        axes_ = axes;
    }

    /// Starts to look how far the prescribed vertices are from the end of the leg that
    /// they are on; before find_remaining.
    void look_ahead(Exec& exec,
                    View<const std::uint8_t> fixed,
                    const BoundaryPath& path,
                    View<const Vec3d> x) {
        detail::remaining_motion(exec, fixed, path.target(), x, prescribed_.view());
        if (axes_.size > 0)
            detail::remaining_on_axes(exec, axes_, path.target(), x, prescribed_.view());
        ahead_ = detail::max_component(exec, View<const Vec3d>(prescribed_.view()));
    }

    /// Largest component of what they still have to move, m; 0 at the end of the path
    /// only.
    double find_remaining(Exec& exec,
                          View<const std::uint8_t> fixed,
                          BoundaryPath& path,
                          View<const Vec3d> x) {
        remaining_ = exec.value(ahead_);
        while (remaining_ == 0.0 && path.next_leg()) {
            look_ahead(exec, fixed, path, x);
            remaining_ = exec.value(ahead_);
        }
        return remaining_;
    }

    /// Keeps the prescribed vertices where they are in the next direction.
    void hold_prescribed() { remaining_ = 0.0; }

    /// p from the objective's gradient, matrix and terms; call find_remaining before.
    DirectionResult solve(Exec& exec,
                          Objective<Exec>& objective,
                          View<const std::uint8_t> fixed,
                          const SolverSettings& settings,
                          const PcgOptions& pcg,
                          typename Exec::template Buffer<Vec3d>& p) {
        detail::set_zero(exec, pushed_.view());
        if (remaining_ > 0.0) {
            objective.matrix().multiply(
                exec, View<const Vec3d>(prescribed_.view()), pushed_.view());
            objective.terms().multiply_add(
                exec, View<const Vec3d>(prescribed_.view()), pushed_.view());
        }
        if (axes_.size > 0)
            detail::decouple_axes(exec, axes_, objective.matrix(), objective.terms());
        detail::right_hand_side(exec,
                                fixed,
                                objective.gradient(),
                                View<const Vec3d>(pushed_.view()),
                                rhs_.view());
        if (axes_.size > 0) detail::zero_axes(exec, axes_, rhs_.view());
        DirectionResult result = settings.linear == LinearSolver::Cholmod
                                   ? solve_cholmod(exec, objective, fixed, p)
                                   : solve_pcg(exec, objective, fixed, pcg, p.view());
        if (axes_.size > 0) detail::zero_axes(exec, axes_, p.view());
        if (remaining_ > 0.0)
            detail::add_scaled(
                exec, 1.0, View<const Vec3d>(prescribed_.view()), p.view());
        return result;
    }

  private:
    DirectionResult solve_pcg(Exec& exec,
                              Objective<Exec>& objective,
                              View<const std::uint8_t> fixed,
                              const PcgOptions& options,
                              View<Vec3d> p) {
        const PcgResult solved = pcg_.solve(exec,
                                            objective.matrix(),
                                            objective.terms(),
                                            View<const Vec3d>(rhs_.view()),
                                            fixed,
                                            options,
                                            p);
        DirectionResult out{.iterations = solved.iterations,
                            .fine = solved.refined || !options.refine};
        out.cancelled = solved.outcome == PcgResult::Outcome::Cancelled;
        if (solved.outcome == PcgResult::Outcome::Breakdown) {
            out.ok = false;
            out.trouble =
                "PCG broke down: the Hessian is not positive definite or not finite";
        }
        if (solved.outcome == PcgResult::Outcome::MaxIterations) {
            out.ok = false;
            out.trouble = "PCG did not converge in " + std::to_string(solved.iterations)
                        + " iterations (solver.max_pcg); the system is badly conditioned";
        }
        return out;
    }

    DirectionResult solve_cholmod(Exec& exec,
                                  Objective<Exec>& objective,
                                  View<const std::uint8_t> fixed,
                                  typename Exec::template Buffer<Vec3d>& p) {
        using Solved = CholmodSolver::Outcome;
        const Solved outcome = solve_direct(exec,
                                            cholmod_,
                                            objective.matrix(),
                                            objective.terms(),
                                            View<const Vec3d>(rhs_.view()),
                                            fixed,
                                            p);
        DirectionResult out{
            .iterations = 1, .fine = true, .ok = outcome == Solved::Solved};
        if (outcome == Solved::NotPositiveDefinite)
            out.trouble = "CHOLMOD: the Hessian is not positive definite or not finite";
        if (outcome == Solved::Failed) out.trouble = "CHOLMOD ran out of memory";
        if (outcome == Solved::NotAvailable) out.trouble = "this build has no CHOLMOD";
        return out;
    }

    typename Exec::template Buffer<Vec3d> rhs_, prescribed_, pushed_;
    Pcg<Exec> pcg_;
    CholmodSolver cholmod_;
    View<const std::uint8_t> axes_{};
    Later ahead_;
    double remaining_ = 0.0;
};

}  // namespace noli
