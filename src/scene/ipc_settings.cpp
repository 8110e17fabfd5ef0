// SPDX-License-Identifier: Apache-2.0
/// Settings of IPC scripts: time, contact, solver.
#include "scene/ipc_script_data.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace noli {

namespace {

/// Obstacles and half-spaces keep their contact with the shapes.
void disable_contact_of_shapes(const Script& script,
                               const std::vector<PlacedShape>& shapes,
                               Scene& scene) {
    ContactSettings& contact = scene.contact;
    contact.self_contact = false;
    if (script.obstacles.empty() && script.half_spaces.empty()) {
        contact.enabled = false;
        return;
    }
    for (std::size_t i = 0; i < shapes.size(); ++i)
        for (std::size_t j = i; j < shapes.size(); ++j)
            if (i != j || shapes[i].copies() > 1)
                contact.pairs.push_back({scene.bodies[shapes[i].body].name,
                                         scene.bodies[shapes[j].body].name,
                                         std::nullopt,
                                         false});
}

}  // namespace

void apply_time(const Script& script, Scene& scene) {
    scene.duration = script.duration;
    scene.dt = script.dt;
    scene.gravity = script.gravity ? Vector3{0, -9.80665, 0} : Vector3{0, 0, 0};
    // The original multiplies the elastic Hessian by dampingStiff / dt, ours by beta dt.
    const double dt = script.dt;
    scene.damping.stiffness = script.damping_ratio ? 0.75 * *script.damping_ratio * dt
                                                   : script.damping_stiff / (dt * dt);
}

void apply_contact(Script& script, const std::vector<PlacedShape>& shapes, Scene& scene) {
    ContactSettings& contact = scene.contact;
    contact.dhat = script.tuning[2];
    contact.epsv = script.tuning[5];
    contact.dhat_absolute = contact.epsv_absolute = script.absolute;
    contact.friction_iterations = script.friction_iterations;
    contact.kappa_min_multiplier = script.kappa_min_multiplier;
    if (script.tuning[0] != 0.0)
        throw ScriptFailure{{Error::Code::Unsupported,
                             script.file,
                             "found a fixed contact stiffness (first number of "
                             "\"tuning\"), whose scale belongs to "
                             "the other program; write 0 for an adaptive one, or set "
                             "contact.kappa in JSON"}};
    if (script.tuning[1] != script.tuning[2] || script.tuning[4] != script.tuning[5])
        script.warnings.push_back(
            {script.file,
             "dHat and epsv start at their target values: their homotopy "
             "within a step is not done"});
    if (!(contact.dhat > 0.0 && contact.epsv > 0.0))
        throw ScriptFailure{
            {Error::Code::InvalidScene,
             script.file,
             fmt::format(
                 "found dHat {} and epsv {}, expected both > 0; correct \"tuning\"",
                 contact.dhat,
                 contact.epsv)}};
    if (!script.self_collision) disable_contact_of_shapes(script, shapes, scene);
}

void apply_solver(const Script& script, Scene& scene) {
    SolverSettings& solver = scene.solver;
    solver.integrator = script.integrator;
    solver.newmark_beta = script.newmark_beta;
    solver.newmark_gamma = script.newmark_gamma;
    solver.tolerance_absolute = script.absolute;
    solver.tolerance = script.tolerances.front();
    if (script.tolerances.size() > 1) solver.tolerance_per_step = script.tolerances;
    if (std::any_of(script.tolerances.begin(), script.tolerances.end(), [](double t) {
            return !(t > 0);
        }))
        throw ScriptFailure{{Error::Code::InvalidScene,
                             script.file,
                             "found a tolerance that is not positive, expected > 0; "
                             "correct \"tol\""}};
}

}  // namespace noli
