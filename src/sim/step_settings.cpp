// SPDX-License-Identifier: Apache-2.0
#include "sim/step_settings.hpp"

#include <algorithm>

namespace noli {

StepSettings step_settings(const Scene& scene,
                           const Model& model,
                           bool record_iterations) {
    const auto positive = [](double mu) { return mu > 0.0; };
    return {
        .dt = scene.dt,
        .dhat = model.dhat,
        .epsv = model.epsv,
        .diagonal = model.diagonal,
        .mean_mass = model.mean_mass,
        .has_friction =
            std::any_of(model.pair_friction.begin(), model.pair_friction.end(), positive)
            || std::any_of(
                model.plane_friction.begin(), model.plane_friction.end(), positive),
        .contact = spelled_out(scene.contact),
        .damping = scene.damping,
        .solver = scene.solver,
        .record_iterations = record_iterations};
}

}  // namespace noli
