// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Every key of a scene, once: name, place, default, bounds, unit, meaning. See
/// field_spec.hpp.

#include "noli/scene.hpp"

#include "scene/field_spec.hpp"
#include "scene/forms.hpp"

#include <array>
#include <limits>
#include <span>

namespace noli {

inline constexpr int kSceneFormatVersion = 1;

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
inline constexpr std::array kIntegrators{
    Choice{Integrator::ImplicitEuler, "implicit_euler", "first order, damps"},
    Choice{Integrator::Bdf2, "bdf2", "second order, damps little"},
    Choice{Integrator::Newmark,
           "newmark",
           "second order, keeps energy with the default beta and gamma"}};
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

template <class V>
void visit_fields(V& v, Material& m) {
    const Material d;
    v.choice("model", m.model, d.model, all(kMaterialModels), "Elastic energy.");
    v.number("density",
             m.density,
             d.density,
             {.unit = kDensity, .above = 0, .doc = "Mass density."});
    v.number("young",
             m.young,
             d.young,
             {.unit = kPressure, .above = 0, .doc = "Young's modulus: the stiffness."});
    v.number(
        "poisson",
        m.poisson,
        d.poisson,
        {.above = -1,
         .below = 0.5,
         .doc = "Poisson's ratio: 0.5 would keep the volume exactly; above 0.49 linear "
                "tetrahedra lock."});
    v.only_if(m.model == Material::Model::StableNeoHookean,
              "with \"model\": \"stable_neo_hookean\"");
    v.boolean("gipc_lame",
              m.gipc_lame,
              d.gipc_lame,
              "Use the Lame constants of the authors' program, which is a third too "
              "stiff in shear.");
    v.always();
}

template <class V>
void visit_fields(V& v, PathKey& k) {
    const PathKey d;
    v.required("time", "give the time of the key frame in seconds");
    v.number("time",
             k.time,
             std::numeric_limits<double>::quiet_NaN(),
             {.unit = kTime, .at_least = 0, .doc = "Time of the key frame."});
    v.vector("translation",
             k.translation,
             d.translation,
             {.unit = kLength, .doc = "Shift from the placement at the start."});
    v.vector("rotation_deg",
             k.rotation_deg,
             d.rotation_deg,
             {.unit = kAngle,
              .doc = "Turn Rx Ry Rz about the centre, from the placement at the start."});
}

template <class V>
void visit_condition_motion(V& v, BoundaryCondition& b) {
    using Kind = BoundaryCondition::Kind;
    const BoundaryCondition d;
    const bool load = b.kind == Kind::Force || b.kind == Kind::Acceleration;
    const Dimension unit = b.kind == Kind::Force        ? kForce
                         : b.kind == Kind::Acceleration ? kAcceleration
                                                        : kSpeed;
    v.only_if(b.kind == Kind::Velocity || load,
              "with \"kind\": \"velocity\", \"force\" or \"acceleration\"");
    v.vector(
        "linear",
        b.linear,
        d.linear,
        {.unit = unit,
         .doc = "Velocity (m/s), total force (N) or acceleration (m/s^2), by kind."});
    v.only_if(b.kind == Kind::Velocity, "with \"kind\": \"velocity\"");
    v.vector("angular_deg",
             b.angular_deg,
             d.angular_deg,
             {.unit = kAngularSpeed,
              .doc = "Angular velocity; each step turns by Rx Ry Rz about the centre."});
    v.only_if(b.kind == Kind::Velocity || b.kind == Kind::Path,
              "with \"kind\": \"velocity\" or \"path\"");
    v.maybe_vector("center",
                   b.center,
                   {.unit = kLength,
                    .doc = "Centre of rotation; default: the centre of the bounding box "
                           "of the selection."});
    v.only_if(b.kind == Kind::Path, "with \"kind\": \"path\"");
    v.list("path",
           b.path,
           "Key frames in ascending time; linear between them, held after the last.");
    v.only_if(b.kind == Kind::Sequence, "with \"kind\": \"sequence\"");
    v.files("sequence",
            b.sequence,
            "Mesh files with the positions (m, in the world) at the end of steps 1, 2, "
            "...; the last is held.");
    v.always();
}

template <class V>
void visit_fields(V& v, BoundaryCondition& b) {
    using Kind = BoundaryCondition::Kind;
    const BoundaryCondition d;
    v.required("kind", "say what the condition does, for example \"kind\": \"fixed\"");
    v.choice("kind",
             b.kind,
             static_cast<Kind>(-1),
             all(kBoundaryKinds),
             "What the condition does.");
    v.template form<SelectForm>(
        "select", b.selection, "Which vertices it holds; default: all of the body.");
    visit_condition_motion(v, b);
    v.check(b.kind != Kind::Path || !b.path.empty(),
            "path",
            "found no key frames, expected at least one; write [{ \"time\": 0 }, ...]");
    v.check(b.kind != Kind::Sequence || !b.sequence.empty(),
            "sequence",
            "found no usable files, expected at least one mesh file; list them in the "
            "order of the steps");
    for (std::size_t i = 1; i < b.path.size(); ++i)
        v.check(b.path[i].time > b.path[i - 1].time,
                "path",
                "found key frames out of order, expected strictly ascending times; sort "
                "them");
    v.number("t_begin",
             b.t_begin,
             d.t_begin,
             {.unit = kTime,
              .at_least = 0,
              .doc = "Active in steps that start at this time or later."});
    v.template form<EndForm>(
        "t_end",
        b.t_end,
        "Active in steps that start before this time; default: forever.");
    v.check(b.t_end > b.t_begin,
            "t_end",
            "found an end that is not after \"t_begin\", expected a later time; enlarge "
            "\"t_end\"");
    v.template form<UntilForm>(
        "until",
        b.until,
        "Ends the condition for good at the first step that starts with every "
        "vertex beyond a plane.");
}

template <class V>
void visit_fields(V& v, Body& b) {
    const Body d;
    v.template form<NameForm>(
        "name",
        b.name,
        "Name for messages and contact pairs; default: body0, body1, ...");
    v.required(
        "mesh",
        "name a file or a generator, for example \"mesh\": { \"generator\": \"box\" }");
    v.template form<MeshForm>(
        "mesh",
        b.mesh,
        "Mesh file or generator. With tetrahedra the body is elastic; triangles, "
        "segments or points alone are an obstacle.");
    v.template form<TransformForm>("transform", b.transform, "Placement of the mesh.");
    v.template form<MaterialForm>(
        "material", b.material, "Name of a preset, or constants.");
    v.vector(
        "velocity", b.velocity, d.velocity, {.unit = kSpeed, .doc = "Initial velocity."});
    v.vector("angular_velocity_deg",
             b.angular_velocity_deg,
             d.angular_velocity_deg,
             {.unit = kAngularSpeed,
              .doc = "Initial angular velocity about the centre of the bounding box."});
    v.number("friction",
             b.friction,
             d.friction,
             {.at_least = 0,
              .doc = "Coefficient of friction; two bodies use the larger of theirs."});
    v.list("boundary", b.boundary, "Conditions on the motion of its vertices.");
    v.template form<GridForm>("grid", b, "Copies of the body on a grid.");
}

template <class V>
void visit_fields(V& v, HalfSpace& h) {
    const HalfSpace d;
    v.template form<NameForm>(
        "name",
        h.name,
        "Name for messages and contact pairs; default: plane0, plane1, ...");
    v.vector(
        "point", h.point, d.point, {.unit = kLength, .doc = "A point of the plane."});
    v.vector("normal",
             h.normal,
             d.normal,
             {.doc = "Points out of the forbidden side; any length."});
    v.check(h.normal != Vector3{},
            "normal",
            "found [0, 0, 0], expected a direction; write for example [0, 1, 0]");
    v.number("friction",
             h.friction,
             d.friction,
             {.at_least = 0, .doc = "Coefficient of friction of all bodies on it."});
}

template <class V>
void visit_fields(V& v, ContactPairRule& r) {
    v.required("a", "name a body, or write \"*\" for all");
    v.required("b", "name a body or half-space, or write \"*\" for all");
    v.text("a",
           r.a,
           "",
           "Name of a body, of one copy (\"name[i,j,k]\") or half-space; \"*\" is all.");
    v.text("b",
           r.b,
           "",
           "The other one, likewise; may be the same, for contact within a body.");
    v.maybe_number("friction",
                   r.friction,
                   {.at_least = 0, .doc = "Coefficient of friction of the pair."});
    v.maybe_boolean("enabled", r.enabled, "Whether the two touch at all.");
    v.check(r.friction || r.enabled,
            "",
            "found a rule that changes nothing, expected \"friction\" or \"enabled\"; "
            "add one or remove the rule");
}

template <class V>
void visit_fields(V& v, ContactSettings& c) {
    const ContactSettings d;
    v.boolean("enabled", c.enabled, d.enabled, "Whether anything touches anything.");
    v.boolean("self_contact", c.self_contact, d.self_contact, "Contact within one body.");
    v.scaled("dhat",
             c.dhat,
             c.dhat_absolute,
             d.dhat,
             {.unit = kLength,
              .above = 0,
              .doc = "Activation distance: surfaces closer than this repel; "
                     "relative to the diagonal (length_scale)."});
    v.choice(
        "model", c.model, d.model, all(kContactFormulations), "Whose contact model.");
    v.integer(
        "barrier_exponent",
        c.barrier_exponent,
        d.barrier_exponent,
        {.at_least = 1,
         .at_most = 2,
         .doc = "Power of the logarithm in the barrier: 1 as in IPC, 2 as in GIPC."});
    v.choice("hessian",
             c.hessian,
             d.hessian,
             all(kContactModels),
             "Second derivative of the barrier in Newton's method.");
    v.choice("mollifier",
             c.mollifier,
             d.mollifier,
             all(kMollifierModels),
             "The same for nearly parallel edges.");
    v.check(c.model == ContactFormulation::Gipc
                || (c.barrier_exponent == d.barrier_exponent && c.hessian == d.hessian
                    && c.mollifier == d.mollifier),
            "model",
            "found \"ipc\" beside \"barrier_exponent\", \"hessian\" or "
            "\"mollifier\", expected one or the other; \"ipc\" fixes all three");
    v.boolean("strengthen",
              c.strengthen,
              d.strengthen,
              "Whether a solve that makes only short steps moves to a stronger Hessian.");
    v.number("kappa",
             c.kappa,
             d.kappa,
             {.unit = kBarrierStiffness,
              .at_least = 0,
              .doc = "Fixed stiffness of the barrier; 0 adapts it."});
    v.number("kappa_min_multiplier",
             c.kappa_min_multiplier,
             d.kappa_min_multiplier,
             {.above = 0, .doc = "Scales the lower bound of the adaptive stiffness."});
    v.scaled("epsv",
             c.epsv,
             c.epsv_absolute,
             d.epsv,
             {.unit = kSpeed,
              .above = 0,
              .doc = "Sliding speed below which friction counts as static; "
                     "relative to the diagonal (length_scale) per second."});
    v.integer(
        "friction_iterations",
        c.friction_iterations,
        d.friction_iterations,
        {.at_least = 0,
         .doc = "Updates of the lagged friction per step; 0 = until it converges."});
    v.number("min_separation",
             c.min_separation,
             d.min_separation,
             {.unit = kLength,
              .at_least = 0,
              .doc = "Distance that the collision bound of a step keeps."});
    v.list("pairs",
           c.pairs,
           "Exceptions for pairs, applied in order: the last that matches counts.");
}

template <class V>
void visit_fields(V& v, DampingSettings& s) {
    const DampingSettings d;
    v.number("mass",
             s.mass,
             d.mass,
             {.unit = kRate, .at_least = 0, .doc = "Rayleigh alpha: damps all motion."});
    v.number(
        "stiffness",
        s.stiffness,
        d.stiffness,
        {.unit = kTime,
         .at_least = 0,
         .doc = "Rayleigh beta: damps deformation; lagged at the start of the step."});
}

template <class V>
void visit_fields(V& v, SolverSettings& s) {
    const SolverSettings d;
    v.choice(
        "integrator", s.integrator, d.integrator, all(kIntegrators), "Time stepping.");
    v.only_if(s.integrator == Integrator::Newmark, "with \"integrator\": \"newmark\"");
    v.number("newmark_beta",
             s.newmark_beta,
             d.newmark_beta,
             {.above = 0, .at_most = 0.5, .doc = "Newmark's beta."});
    v.number(
        "newmark_gamma",
        s.newmark_gamma,
        d.newmark_gamma,
        {.at_least = 0.5, .at_most = 1, .doc = "Newmark's gamma; above 0.5 it damps."});
    v.always();
    v.scaled("tolerance",
             s.tolerance,
             s.tolerance_absolute,
             d.tolerance,
             {.unit = kSpeed,
              .above = 0,
              .doc = "Newton stops when no vertex would move faster than this any more; "
                     "relative to the "
                     "diagonal (length_scale) per second."});
    v.number("gradient_tolerance",
             s.gradient_tolerance,
             d.gradient_tolerance,
             {.at_least = 0,
              .doc = "If positive, Newton stops at a gradient of this times the diagonal "
                     "times dt^2 (N s^2) instead."});
    v.numbers("tolerance_per_step",
              s.tolerance_per_step,
              {.above = 0,
               .doc = "Tolerance of steps 1, 2, ... instead of `tolerance`, in its unit; "
                      "the last repeats."});
    v.integer("max_newton",
              s.max_newton,
              d.max_newton,
              {.at_least = 1, .doc = "Newton iterations per step at most."});
    v.choice("linear",
             s.linear,
             d.linear,
             all(kLinearSolvers),
             "Solver of the linear systems.");
    v.choice("contact_product",
             s.contact_product,
             d.contact_product,
             all(kContactProducts),
             "How conjugate gradients multiply with the contacts' Hessians.");
    v.number("pcg_tolerance",
             s.pcg_tolerance,
             d.pcg_tolerance,
             {.at_least = 0,
              .below = 1,
              .doc = "Relative residual (in the preconditioned norm, squared) at which "
                     "PCG stops; 0 = by an estimate of the error in energy, rough at "
                     "first and fine where the step may end."});
    v.integer("max_pcg",
              s.max_pcg,
              d.max_pcg,
              {.at_least = 1, .doc = "PCG iterations per system at most."});
}

template <class V>
void visit_fields(V& v, OutputSettings& o) {
    const OutputSettings d;
    v.integer("every",
              o.every,
              d.every,
              {.at_least = 0, .doc = "Write a frame every that many steps; 0 = none."});
    v.texts("formats",
            o.formats,
            d.formats,
            {"vtu", "obj", "ply"},
            "File formats of the frames.");
    v.integer("checkpoint_steps",
              o.checkpoint_steps,
              d.checkpoint_steps,
              {.at_least = 0,
               .doc = "Write a checkpoint every that many steps; 0 = by time only."});
    v.number(
        "checkpoint_seconds",
        o.checkpoint_seconds,
        d.checkpoint_seconds,
        {.unit = kTime, .above = 0, .doc = "And at least after that much wall time."});
    v.integer(
        "hash_every",
        o.hash_every,
        d.hash_every,
        {.at_least = 0,
         .doc = "Write the hash of the state to stats.csv every that many steps; 0 = "
                "every step on a CPU, with frames on a GPU, where all of the state "
                "has to come to the host for it."});
}

/// All keys but "$schema", "format_version" and "base_folder", which belong to the file.
template <class V>
void visit_fields(V& v, Scene& s) {
    const Scene d;
    v.template form<TitleForm>(
        "name", s.name, "Name of the scene; default: the name of the file.");
    v.text("description", s.description, "", "What it shows.");
    v.number("duration",
             s.duration,
             d.duration,
             {.unit = kTime, .above = 0, .doc = "Simulated time."});
    v.number("dt", s.dt, d.dt, {.unit = kTime, .above = 0, .doc = "Time step."});
    v.vector("gravity", s.gravity, d.gravity, {.unit = kAcceleration, .doc = "Gravity."});
    v.number("length_scale",
             s.length_scale,
             d.length_scale,
             {.unit = kLength,
              .at_least = 0,
              .doc = "The \"diagonal\" of relative settings; 0 = that of the bounding "
                     "box of all elastic "
                     "bodies at the start."});
    v.required("bodies", "list at least one body");
    v.list("bodies", s.bodies, "Elastic bodies and obstacles.");
    v.list("half_spaces", s.half_spaces, "Floors and walls.");
    v.object("contact", s.contact, "Contact and friction.");
    v.object("damping", s.damping, "Rayleigh damping.");
    v.object("solver", s.solver, "Time stepping and solvers.");
    v.object("output", s.output, "Frames and checkpoints.");
}

}  // namespace noli
