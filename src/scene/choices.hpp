// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The words that a scene has for the values of its settings, and what they mean. The
/// command line has the same (value_names of noli/scene.hpp).

#include "noli/scene.hpp"

#include "scene/field_spec.hpp"

#include <array>
#include <span>

namespace noli {

inline constexpr std::array kMaterialModels{
    Choice{Material::Model::StableNeoHookean,
           "stable_neo_hookean",
           "survives inversion, no log term"},
    Choice{Material::Model::NeoHookean, "neo_hookean", "with log term"},
    Choice{
        Material::Model::FixedCorotated, "fixed_corotated", "as IPC scripts call FCR"}};
inline constexpr std::array kBoundaryKinds{
    Choice{BoundaryCondition::Kind::Fixed, "fixed", "held in place"},
    Choice{BoundaryCondition::Kind::Velocity,
           "velocity",
           "moves with `linear` and turns with `angular_deg`"},
    Choice{BoundaryCondition::Kind::Path, "path", "follows `path`"},
    Choice{BoundaryCondition::Kind::Sequence,
           "sequence",
           "takes the positions of a mesh file per step"},
    Choice{
        BoundaryCondition::Kind::Force, "force", "total force `linear`, spread by mass"},
    Choice{
        BoundaryCondition::Kind::Acceleration, "acceleration", "acceleration `linear`"}};
inline constexpr std::array kContainerShapes{
    Choice{Container::Shape::Sphere, "sphere", "the inside of a sphere"},
    Choice{Container::Shape::Cylinder,
           "cylinder",
           "the inside of a cylinder without ends; half-spaces close it"}};
inline constexpr std::array kPrescribedAxes{Choice{1, "x", "x alone"},
                                            Choice{2, "y", "y alone"},
                                            Choice{4, "z", "z alone"},
                                            Choice{3, "xy", "x and y"},
                                            Choice{5, "xz", "x and z"},
                                            Choice{6, "yz", "y and z"},
                                            Choice{kAllAxes, "xyz", "all three"}};
inline constexpr std::array kContactFormulations{
    Choice{ContactFormulation::Gipc, "gipc", "Gauss-Newton barrier, next three keys"},
    Choice{ContactFormulation::Ipc,
           "ipc",
           "that of Li et al. 2020: exponent 1, full Hessians projected numerically; for "
           "comparison"}};
inline constexpr std::array kContactModels{
    Choice{ContactModel::Gn, "gn", "rank one, the paper's; stalls on some scenes"},
    Choice{ContactModel::GnPlus, "gn+", "rank three, robust"},
    Choice{ContactModel::Exact, "exact", "projected to be positive semi-definite"},
    Choice{ContactModel::Numeric,
           "numeric",
           "the same by eigenvectors of the full matrix, slow"}};
inline constexpr std::array kMollifierModels{
    Choice{MollifierModel::TwoMode, "two_mode", "as the authors' program"},
    Choice{MollifierModel::FourMode, "four_mode", "all four modes"},
    Choice{MollifierModel::Exact, "exact", "projected numerically"}};

inline constexpr std::array kProjections{
    Choice{HessianProjection::OnDemand,
           "on_demand",
           "where the exact ones are not positive definite"},
    Choice{HessianProjection::Always, "always", "for comparison"}};

inline constexpr std::array kStarts{
    Choice{NewtonStart::Extrapolated, "extrapolated", "where the last two steps lead"},
    Choice{NewtonStart::Last, "last", "where the bodies are"}};

inline constexpr std::array kFrictionHessians{
    Choice{FrictionHessian::PrimalDual,
           "primal_dual",
           "the direction of the force is an unknown of its own"},
    Choice{FrictionHessian::Newton, "newton", "for comparison"}};
inline constexpr std::array kIntegrators{
    Choice{Integrator::ImplicitEuler, "implicit_euler", "first order, damps"},
    Choice{Integrator::Bdf2, "bdf2", "second order, damps little"},
    Choice{Integrator::Newmark,
           "newmark",
           "second order, keeps energy out of contact with the default beta and gamma"}};
inline constexpr std::array kLinearSolvers{
    Choice{LinearSolver::Pcg, "pcg", "preconditioned conjugate gradients"},
    Choice{LinearSolver::Cholmod, "cholmod", "sparse factorisation, if built in"},
    Choice{LinearSolver::BlockJacobi,
           "block_jacobi",
           "conjugate gradients with block Jacobi, for comparison"},
    Choice{LinearSolver::IncompleteCholesky,
           "incomplete_cholesky",
           "conjugate gradients with block IC(0), fewest iterations; CPU only"}};
inline constexpr std::array kContactProducts{
    Choice{ContactProduct::Modes, "modes", "a few vectors per contact"},
    Choice{
        ContactProduct::Warp,
        "warp",
        "a dense block per contact and Algorithm 1 of the supplement, on a CPU simulated "
        "lane by lane; for comparison"}};

template <class E, std::size_t n>
std::span<const Choice<E>> all(const std::array<Choice<E>, n>& choices) {
    return choices;
}

}  // namespace noli
