// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Every key of a scene's settings; see scene_fields.hpp.

#include "noli/scene.hpp"

#include "scene/choices.hpp"
#include "scene/field_spec.hpp"

namespace noli {

template <class V>
void visit_fields(V& v, ContactPairRule& r) {
    v.required("a", "name a body, or write \"*\" for all");
    v.required("b", "name a body, half-space or container, or write \"*\" for all");
    v.text(
        "a",
        r.a,
        "",
        "Name of a body, of one copy (\"name[i,j,k]\"), half-space or container; \"*\" "
        "is all.");
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
                     "relative to the diagonal (length_scale), at most 2 % of that of "
                     "the smallest body and a quarter of its short edges unless "
                     "length_scale is given."});
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
        {.at_least = kFrictionAsNeeded,
         .doc = "Updates of the lagged friction per step; 0 = until it converges, -1 = "
                "again while `friction_tolerance` asks for it, four at most."});
    v.choice("friction_hessian",
             c.friction_hessian,
             d.friction_hessian,
             all(kFrictionHessians),
             "Second derivative of friction in Newton's method.");
    v.number("friction_tolerance",
             c.friction_tolerance,
             d.friction_tolerance,
             {.above = 0,
              .doc = "With \"friction_iterations\": -1, friction is updated again while "
                     "the friction force of a body changed by more than this share."});
    v.number("min_separation",
             c.min_separation,
             d.min_separation,
             {.unit = kLength,
              .at_least = 0,
              .doc = "Distance that surfaces keep, as if they were this much thicker: "
                     "barriers act between it and it plus dhat, and no step enters it."});
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
    v.number("stiffness",
             s.stiffness,
             d.stiffness,
             {.unit = kTime,
              .at_least = 0,
              .doc = "Viscosity (Rayleigh beta): damps deformation, and no rotation."});
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
    v.number("gap_tolerance",
             s.gap_tolerance,
             d.gap_tolerance,
             {.at_least = 0,
              .doc = "Nor does Newton stop while the distance of a pair in contact would "
                     "change by more than this share: normal forces depend on it. 0 = "
                     "do not ask."});
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
    v.choice("projection",
             s.projection,
             d.projection,
             all(kProjections),
             "When elastic Hessians are projected, element by element.");
    v.choice("start", s.start, d.start, all(kStarts), "Where Newton's method starts.");
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

}  // namespace noli
