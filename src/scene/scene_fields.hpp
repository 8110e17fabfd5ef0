// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Every key of a scene, once: name, place, default, bounds, unit, meaning. See
/// field_spec.hpp.

#include "noli/scene.hpp"

#include "scene/body_fields.hpp"
#include "scene/field_spec.hpp"
#include "scene/forms.hpp"
#include "scene/settings_fields.hpp"

namespace noli {

inline constexpr int kSceneFormatVersion = 1;

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
                     "box of all elastic bodies at the start, at most 100 times that of "
                     "the smallest one."});
    v.required("bodies", "list at least one body");
    v.list("bodies", s.bodies, "Elastic bodies and obstacles.");
    v.list("half_spaces", s.half_spaces, "Floors and walls.");
    v.list("containers", s.containers, "Spheres and cylinders that bodies stay in.");
    v.object("contact", s.contact, "Contact and friction.");
    v.object("damping", s.damping, "Rayleigh damping.");
    v.object("solver", s.solver, "Time stepping and solvers.");
    v.object("output", s.output, "Frames and checkpoints.");
}

}  // namespace noli
