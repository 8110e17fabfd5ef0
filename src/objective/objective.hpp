// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The incremental potential of one time step,
///
///     E(x) = inertia + h^2 (elastic + damping) + barrier + friction,
///
/// its value, gradient and Hessian operator. This room adds terms up; formulas are in
/// energy/. h^2 is dt^2 for every integrator: what makes them differ is the weight of
/// inertia and x~. The barrier is not scaled by h^2: kappa absorbs it. Source: MATH 7.

#include "contact/pairs.hpp"
#include "core/timer.hpp"
#include "linear/block_matrix.hpp"
#include "objective/contact_terms.hpp"
#include "objective/elastic_assembly.hpp"
#include "objective/inertia.hpp"
#include "objective/vector_loops.hpp"
#include "objective/viscosity.hpp"

#include <array>
#include <utility>
#include <vector>

namespace noli {

/// What stays the same during one step.
struct StepScales {
    double h_sq = 0.0;               ///< s^2
    double mass_damping = 0.0;       ///< dt alpha
    double stiffness_damping = 0.0;  ///< beta / dt: factor of the viscous energy
    double friction_eps = 0.0;       ///< epsv dt, m
};

/// Where assembly spends its time: energies' gradients and projected Hessians, s; on the
/// CPU `elastic` includes their sum into the matrix.
struct AssemblySeconds {
    double elastic = 0.0, barrier = 0.0, friction = 0.0;
};

/// The parts of an energy, on their way to the host; 0 where there is none.
struct EnergyParts {
    Later inertia, elastic, damping, friction;
    std::array<Later, 6> barrier;  ///< PP, PE, PT, EE, mollified, walls
};

template <class Exec>
class Objective {
  public:
    template <class T>
    using Buffer = typename Exec::template Buffer<T>;

    Objective(Exec& exec, const Model& model, const BlockPattern& pattern)
        : elasticity_(model, pattern) {
        device_.upload(exec, model);
        matrix_.set_pattern(exec, pattern);
        contacts_.upload(exec, model);
        const int n = model.num_vertices;
        gradient_.resize(n);
        diagonal_.resize(n);
        mass_.resize(n);
        weight_.resize(n);
        x_start_.resize(n);
        x_tilde_.resize(n);
        scratch_.resize(n);
        model_ = &model;
        pattern_ = &pattern;
    }

    /// Starts a step: x_start (x^n), x_tilde with the weights of inertia, and which
    /// vertices are prescribed.
    void begin_step(Exec& exec,
                    const StepScales& scales,
                    View<const Vec3d> x_start,
                    View<const Vec3d> x_tilde,
                    View<const double> weight,
                    View<const std::uint8_t> fixed) {
        scales_ = scales;
        exec.copy(x_start, x_start_.view());
        set_prediction(exec, x_tilde, weight);
        exec.copy(View<const double>(device_.mass.view()), mass_.view());
        fixed_ = fixed;
        contacts_.begin_step(x_start_.view(), scales.friction_eps);
        viscosity_.begin_step(exec,
                              *model_,
                              *pattern_,
                              View<const Vec3d>(x_start_.view()),
                              scales.h_sq * scales.stiffness_damping);
    }

    /// Another prediction within the step; not after yield.
    void set_prediction(Exec& exec,
                        View<const Vec3d> x_tilde,
                        View<const double> weight) {
        exec.copy(x_tilde, x_tilde_.view());
        exec.copy(weight, weight_.view());
    }

    /// From now on in this step the vertices of `was_fixed` that are not in `fixed` are
    /// held by springs to their targets instead of being eliminated: as inertia of
    /// kYieldWeight times their mass.
    void yield(Exec& exec,
               View<const std::uint8_t> was_fixed,
               View<const std::uint8_t> fixed,
               View<const Vec3d> target) {
        detail::hold_by_springs(
            exec, was_fixed, fixed, target, x_tilde_.view(), mass_.view());
        fixed_ = fixed;
    }

    /// Freezes friction at x for the given active pairs.
    void lag_friction_at(Exec& exec,
                         const PairSet<Exec>& pairs,
                         View<const Vec3d> x,
                         const ContactLaw& law) {
        contacts_.lag_friction_at(exec, device_, pairs, x, law.barrier);
    }

    /// After a Newton step to x, see ContactTerms::advance_friction.
    void advance_friction(Exec& exec, View<const Vec3d> x, FrictionHessian how) {
        contacts_.advance_friction(exec, x, how);
    }

    /// Per body the sum of mu lambda_N of the frozen friction, N h^2.
    void sum_friction(Exec& exec, typename Exec::template Buffer<double>& out) {
        out.resize(device_.num_bodies);
        contacts_.sum_friction(exec, device_.body.view(), out.view());
    }

    /// E(x) with the active pairs of x, J times h^2-scale.
    EnergyParts energy_later(Exec& exec,
                             View<const Vec3d> x,
                             const PairSet<Exec>& pairs,
                             const ContactLaw& law) {
        EnergyParts out;
        out.inertia = detail::inertia_energy_sum(exec, inertia(), x);
        out.elastic = elastic_energy_sum(exec, device_, x, scales_.h_sq, per_tet_);
        if (viscosity_.acts()) out.damping = viscosity_.energy_later(exec, x);
        out.friction = contacts_.friction_energy_later(exec, x);
        out.barrier = contacts_.barrier_energy_later(exec, x, pairs, law.barrier);
        return out;
    }
    double total(Exec& exec, const EnergyParts& parts) const {
        double sum = exec.value(parts.inertia) + exec.value(parts.elastic);
        sum += exec.value(parts.damping);
        sum += exec.value(parts.friction);
        return sum + total(exec, parts.barrier);
    }
    double energy(Exec& exec,
                  View<const Vec3d> x,
                  const PairSet<Exec>& pairs,
                  const ContactLaw& law) {
        return total(exec, energy_later(exec, x, pairs, law));
    }

    /// Sum of kappa b over all active pairs, J.
    double barrier_energy(Exec& exec,
                          View<const Vec3d> x,
                          const PairSet<Exec>& pairs,
                          BarrierParams params) {
        return total(exec, contacts_.barrier_energy_later(exec, x, pairs, params));
    }

    /// Gradient and Hessian at x: fills gradient(), matrix() and terms(). `project` =
    /// false takes elastic Hessians as they are: the sum need not be positive definite.
    void assemble(Exec& exec,
                  View<const Vec3d> x,
                  const PairSet<Exec>& pairs,
                  const ContactLaw& law,
                  bool project = true) {
        detail::inertia_gradients(exec, inertia(), x, gradient_.view());
        detail::inertia_diagonals(exec, inertia(), diagonal_.view());
        {
            const PhaseTimer timer(elastic_seconds_);
            elasticity_.assemble(exec,
                                 device_,
                                 x,
                                 scales_.h_sq,
                                 diagonal_.view(),
                                 gradient_.view(),
                                 matrix_,
                                 project);
        }
        if (viscosity_.acts()) {
            viscosity_.add_gradient(exec, x, gradient_.view());
            matrix_.axpy(exec, 1.0, viscosity_.matrix_at(exec, x));
        }
        contacts_.fill_terms(exec, x, pairs, law, /*with_friction=*/true);
        contacts_.add_gradients(exec, gradient_.view());
    }

    /// Gradients of everything but the barrier (`other`) and of the barrier with kappa =
    /// 1
    /// (`barrier`), for the stiffness balance. Source: MATH 8.2.
    void split_gradients(Exec& exec,
                         View<const Vec3d> x,
                         const PairSet<Exec>& pairs,
                         ContactLaw law,
                         View<Vec3d> other,
                         View<Vec3d> barrier) {
        elastic_gradients(exec, device_, x, scales_.h_sq, corners_);
        detail::inertia_gradients(exec, inertia(), x, other);
        gather_corners(exec, device_, corners_.view(), other);
        if (viscosity_.acts()) viscosity_.add_gradient(exec, x, other);
        law.barrier.kappa = 1.0;
        law.hessian = ContactHessian::GaussNewton;
        contacts_.fill_terms(exec, x, pairs, law, /*with_friction=*/false);
        detail::set_zero(exec, barrier);
        contacts_.add_gradients(exec, barrier);
    }

    /// Largest friction_unrest (energy/friction.hpp) of the direction p at x among the
    /// terms with mu lambda_N of at least `weak` (J/m).
    Later friction_unrest(Exec& exec,
                          View<const Vec3d> x,
                          View<const Vec3d> p,
                          double weak) {
        return contacts_.friction_unrest(exec, x, p, weak);
    }

    /// Vertices of the term that has it.
    Int4 vertices_with_unrest(
        Exec& exec, View<const Vec3d> x, View<const Vec3d> p, double weak, double most) {
        return contacts_.vertices_with_unrest(exec, x, p, weak, most);
    }

    InversionLater inversion_bound_along(Exec& exec,
                                         View<const Vec3d> x,
                                         View<const Vec3d> p,
                                         double keep) {
        return inversion_step_bound(exec, device_, x, p, keep, per_tet_);
    }

    /// Seconds of all assemblies since the last call.
    AssemblySeconds take_seconds() {
        const ContactSeconds contact = contacts_.take_seconds();
        return {std::exchange(elastic_seconds_, 0.0), contact.barrier, contact.friction};
    }
    [[nodiscard]] View<const Vec3d> gradient() const { return gradient_.view(); }
    BlockMatrix<Exec>& matrix() { return matrix_; }
    LowRankTerms<Exec>& terms() { return contacts_.terms(); }
    /// Per vertex: the multiple of the identity in matrix() that inertia puts there.
    [[nodiscard]] InertiaViews inertia() const {
        return {mass_.view(),
                weight_.view(),
                fixed_,
                x_tilde_.view(),
                x_start_.view(),
                scales_.mass_damping};
    }
    [[nodiscard]] View<const double> inertia_diagonal() const { return diagonal_.view(); }
    [[nodiscard]] const DeviceModel<Exec>& device() const { return device_; }
    [[nodiscard]] const StepScales& scales() const { return scales_; }
    /// Of the pairs that friction was frozen for.
    [[nodiscard]] View<const FrictionTerm> friction_terms() const {
        return contacts_.friction_terms();
    }
    [[nodiscard]] int num_friction_terms() const {
        return contacts_.num_friction_terms();
    }

    /// Minus the barrier and friction gradients per vertex over h^2: contact forces, N; 0
    /// before the first step.
    void contact_forces(Exec& exec,
                        View<const Vec3d> x,
                        const PairSet<Exec>& pairs,
                        const ContactLaw& law,
                        View<Vec3d> out) {
        contacts_.fill_terms(exec, x, pairs, law, /*with_friction=*/true);
        detail::set_zero(exec, out);
        if (scales_.h_sq <= 0.0) return;
        detail::set_zero(exec, scratch_.view());
        contacts_.add_gradients(exec, scratch_.view());
        detail::add_scaled(
            exec, -1.0 / scales_.h_sq, View<const Vec3d>(scratch_.view()), out);
    }

    /// Elastic energy at x, J (not scaled by h^2).
    double elastic_energy_at(Exec& exec, View<const Vec3d> x) {
        return exec.value(elastic_energy_sum(exec, device_, x, 1.0, per_tet_));
    }

    /// Gradient of the elastic energy at x, N (not scaled by h^2).
    void elastic_gradient_at(Exec& exec, View<const Vec3d> x, View<Vec3d> out) {
        elastic_gradients(exec, device_, x, 1.0, corners_);
        detail::set_zero(exec, out);
        gather_corners(exec, device_, corners_.view(), out);
    }

  private:
    static double total(Exec& exec, const std::array<Later, 6>& parts) {
        double sum = 0.0;
        for (const Later& part : parts)
            sum += exec.value(part);
        return sum;
    }

    double elastic_seconds_ = 0.0;
    DeviceModel<Exec> device_;
    ElasticAssembly<Exec> elasticity_;
    StepScales scales_;
    const Model* model_ = nullptr;
    const BlockPattern* pattern_ = nullptr;
    BlockMatrix<Exec> matrix_;
    Viscosity<Exec> viscosity_;
    ContactTerms<Exec> contacts_;
    Buffer<Vec3d> gradient_, x_start_, x_tilde_, scratch_, corners_;
    Buffer<double> mass_, weight_, diagonal_, per_tet_;
    View<const std::uint8_t> fixed_{};
};

}  // namespace noli
