// SPDX-License-Identifier: Apache-2.0
#include "model/settings.hpp"

#include "model/rotation.hpp"

#include <algorithm>
#include <limits>

namespace noli {

namespace {

/// The bodies of the model by their names and by those of the scene's bodies that they
/// are copies of.
struct Bodies {
    const Scene& scene;
    const std::vector<std::size_t>& source;
    const std::vector<std::string>& body_names;

    [[nodiscard]] double friction_of(std::size_t body) const {
        return scene.bodies[source[body]].friction;
    }

    [[nodiscard]] bool match(const std::string& pattern, std::size_t body) const {
        return pattern == "*" || pattern == body_names[body]
            || pattern == scene.bodies[source[body]].name;
    }
};

void set_rule(const ContactPairRule& rule, double& friction, std::uint8_t& enabled) {
    if (rule.friction) friction = *rule.friction;
    if (rule.enabled) enabled = *rule.enabled ? 1 : 0;
}

void apply_rule(const ContactPairRule& rule,
                const std::string& first,
                const std::string& second,
                const Bodies& bodies,
                Model& model) {
    const std::size_t n = model.body_names.size();
    for (std::size_t a = 0; a < n; ++a) {
        if (!bodies.match(first, a)) continue;
        for (std::size_t b = 0; b < n; ++b)
            if (bodies.match(second, b))
                set_rule(
                    rule, model.pair_friction[a * n + b], model.pair_enabled[a * n + b]);
        for (std::size_t p = 0; p < model.planes.size(); ++p)
            if (second == "*" || second == model.planes[p].name)
                set_rule(rule,
                         model.plane_friction[p * n + a],
                         model.plane_enabled[p * n + a]);
    }
}

}  // namespace

void add_planes(const Scene& scene, Model& model) {
    for (const HalfSpace& half_space : scene.half_spaces) {
        const Vec3d normal = normalized(to_vec3(half_space.normal));
        model.planes.push_back(
            {half_space.name, normal, dot(normal, to_vec3(half_space.point))});
    }
}

void set_contact_rules(const Scene& scene,
                       const std::vector<std::size_t>& source_body,
                       Model& model) {
    const Bodies bodies{scene, source_body, model.body_names};
    const std::size_t n = model.body_names.size();
    const std::size_t num_planes = model.planes.size();
    const bool on = scene.contact.enabled;
    model.pair_enabled.assign(n * n, on ? 1 : 0);
    model.pair_friction.assign(n * n, 0.0);
    model.plane_enabled.assign(num_planes * n, on ? 1 : 0);
    model.plane_friction.assign(num_planes * n, 0.0);
    for (std::size_t a = 0; a < n; ++a) {
        if (!scene.contact.self_contact) model.pair_enabled[a * n + a] = 0;
        for (std::size_t b = 0; b < n; ++b)
            model.pair_friction[a * n + b] =
                std::max(bodies.friction_of(a), bodies.friction_of(b));
        for (std::size_t p = 0; p < num_planes; ++p)
            model.plane_friction[p * n + a] = scene.half_spaces[p].friction;
    }
    for (const ContactPairRule& rule : scene.contact.pairs) {
        apply_rule(rule, rule.a, rule.b, bodies, model);
        if (rule.a != rule.b) apply_rule(rule, rule.b, rule.a, bodies, model);
    }
}

void resolve_scales(const Scene& scene, Model& model) {
    constexpr double kInf = std::numeric_limits<double>::infinity();
    Vec3d lo{kInf, kInf, kInf};
    Vec3d hi{-kInf, -kInf, -kInf};
    int with_mass = 0;
    for (std::size_t v = 0; v < model.x0.size(); ++v) {
        if (model.mass[v] <= 0.0) continue;
        const Vec3d& p = model.x0[v];
        lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
        hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
        model.total_mass += model.mass[v];
        ++with_mass;
    }
    model.mean_mass = with_mass > 0 ? model.total_mass / with_mass : 0.0;
    model.diagonal = scene.length_scale > 0.0 ? scene.length_scale
                                              : (with_mass > 0 ? norm(hi - lo) : 1.0);
    const ContactSettings& contact = scene.contact;
    model.dhat = contact.dhat_absolute ? contact.dhat : contact.dhat * model.diagonal;
    model.epsv = contact.epsv_absolute ? contact.epsv : contact.epsv * model.diagonal;
}

double Model::tolerance(const SolverSettings& solver, int k) const {
    double relative = solver.tolerance;
    if (!solver.tolerance_per_step.empty()) {
        const std::size_t last = solver.tolerance_per_step.size() - 1;
        relative = solver.tolerance_per_step[std::min(last, static_cast<std::size_t>(k))];
    }
    return solver.tolerance_absolute ? relative : relative * diagonal;
}

}  // namespace noli
