// SPDX-License-Identifier: Apache-2.0
#include "sim/step_settings.hpp"

#include <algorithm>
#include <cmath>

namespace noli {

namespace {

/// N
double largest_vertex_force(const Model& model) {
    double largest = 0.0;
    for (std::size_t t = 0; t < model.tets.size(); ++t) {
        const double size = std::cbrt(model.volume[t]);
        largest = std::max(largest, (model.lambda[t] + 2.0 * model.mu[t]) * size * size);
    }
    return largest;
}

}  // namespace

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
        .vertex_force = largest_vertex_force(model),
        .has_friction =
            std::any_of(model.pair_friction.begin(), model.pair_friction.end(), positive)
            || std::any_of(
                model.wall_friction.begin(), model.wall_friction.end(), positive),
        .contact = spelled_out(scene.contact),
        .damping = scene.damping,
        .solver = scene.solver,
        .record_iterations = record_iterations};
}

}  // namespace noli
