// SPDX-License-Identifier: Apache-2.0
#include "step/sound_travel.hpp"

#include "linear/rigid_levels.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace noli {

namespace {

struct BodyFigures {
    double young = 0.0, mass = 0.0, volume = 0.0;
    int num_tets = 0;
};

std::vector<BodyFigures> figures_of(const Model& model) {
    std::vector<BodyFigures> bodies(static_cast<std::size_t>(model.num_bodies()));
    // Stable neo-Hookean tetrahedra come first.
    const auto num_stable = static_cast<std::size_t>(model.model_begin[1]);
    for (std::size_t t = 0; t < model.tets.size(); ++t) {
        const int v = model.tets[t][0];
        BodyFigures& body =
            bodies[static_cast<std::size_t>(model.body[static_cast<std::size_t>(v)])];
        const double mu = model.mu[t];
        const double lambda =
            model.lambda[t] - (t < num_stable ? mu : 0.0);  // see lame_parameters
        body.young = std::max(body.young, mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu));
        body.volume += model.volume[t];
        ++body.num_tets;
    }
    for (std::size_t v = 0; v < model.x0.size(); ++v)
        bodies[static_cast<std::size_t>(model.body[v])].mass += model.mass[v];
    return bodies;
}

}  // namespace

double sound_travel(const Model& model, double dt) {
    double largest = 0.0;
    for (const BodyFigures& body : figures_of(model)) {
        if (!(body.mass > 0.0) || !(body.volume > 0.0)) continue;
        // Edge of the regular tetrahedron of mean volume.
        const double edge = std::cbrt(6.0 * std::sqrt(2.0) * body.volume / body.num_tets);
        const double speed = std::sqrt(body.young * body.volume / body.mass);
        largest = std::max(largest, dt * speed / edge);
    }
    return largest;
}

int piece_size(const Model& model, double dt, LinearSolver linear, bool on_device) {
    if (on_device) return kDeviceAggregate;
    const int small = aggregate_size(model.num_vertices);
    if (sound_travel(model, dt) <= kSoftSoundTravel) return 0;
    return linear == LinearSolver::IncompleteCholesky ? small / 2 : small;
}

std::string describe_linear_solver(const Model& model,
                                   LinearSolver asked,
                                   double dt,
                                   bool on_device) {
    if (asked == LinearSolver::Cholmod) return "CHOLMOD, as asked for";
    if (asked == LinearSolver::BlockJacobi)
        return "conjugate gradients, block Jacobi, as asked for";
    const bool factor = asked == LinearSolver::IncompleteCholesky && !on_device;
    const char* local = on_device ? "block Jacobi" : factor ? "IC(0)" : "Gauss-Seidel";
    const int size = piece_size(model, dt, asked, on_device);
    return fmt::format(
        "conjugate gradients, {}{} (stiffness reaches {:.2g} elements far in a step)",
        local,
        size > 0 ? fmt::format(" + rigid motions of up to about {} vertices each", size)
                 : "",
        sound_travel(model, dt));
}

}  // namespace noli
