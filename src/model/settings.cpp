// SPDX-License-Identifier: Apache-2.0
#include "model/settings.hpp"

#include "model/box.hpp"
#include "model/rotation.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <vector>

namespace noli {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

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

/// Of wall number p: the half-spaces come first.
double wall_friction(const Scene& scene, std::size_t p) {
    const std::size_t num_planes = scene.half_spaces.size();
    return p < num_planes ? scene.half_spaces[p].friction
                          : scene.containers[p - num_planes].friction;
}

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
        for (std::size_t p = 0; p < model.walls.size(); ++p)
            if (second == "*" || second == model.walls[p].name)
                set_rule(
                    rule, model.wall_friction[p * n + a], model.wall_enabled[p * n + a]);
    }
}

}  // namespace

void add_walls(const Scene& scene, Model& model) {
    for (const HalfSpace& half_space : scene.half_spaces) {
        const Vec3d normal = normalized(to_vec3(half_space.normal));
        model.walls.push_back(
            {half_space.name, {normal, dot(normal, to_vec3(half_space.point))}});
    }
    for (const Container& container : scene.containers) {
        const bool sphere = container.shape == Container::Shape::Sphere;
        model.walls.push_back(
            {container.name,
             {.normal = sphere ? Vec3d{} : normalized(to_vec3(container.axis)),
              .shape = sphere ? WallShape::Sphere : WallShape::Cylinder,
              .center = to_vec3(container.center),
              .radius = container.radius}});
    }
}

std::vector<Wall> walls_of(const Model& model) {
    std::vector<Wall> walls;
    for (const Model::NamedWall& named : model.walls)
        walls.push_back(named.wall);
    return walls;
}

std::string describe_wall(const Model& model, int wall) {
    const Model::NamedWall& named = model.walls[static_cast<std::size_t>(wall)];
    const bool plane = named.wall.shape == WallShape::HalfSpace;
    return fmt::format("{} \"{}\"", plane ? "half-space" : "container", named.name);
}

void set_contact_rules(const Scene& scene,
                       const std::vector<std::size_t>& source_body,
                       Model& model) {
    const Bodies bodies{scene, source_body, model.body_names};
    const std::size_t n = model.body_names.size();
    const std::size_t num_walls = model.walls.size();
    const bool on = scene.contact.enabled;
    model.pair_enabled.assign(n * n, on ? 1 : 0);
    model.pair_friction.assign(n * n, 0.0);
    model.wall_enabled.assign(num_walls * n, on ? 1 : 0);
    model.wall_friction.assign(num_walls * n, 0.0);
    for (std::size_t a = 0; a < n; ++a) {
        if (!scene.contact.self_contact) model.pair_enabled[a * n + a] = 0;
        for (std::size_t b = 0; b < n; ++b)
            model.pair_friction[a * n + b] =
                std::max(bodies.friction_of(a), bodies.friction_of(b));
        for (std::size_t p = 0; p < num_walls; ++p)
            model.wall_friction[p * n + a] = wall_friction(scene, p);
    }
    for (const ContactPairRule& rule : scene.contact.pairs) {
        apply_rule(rule, rule.a, rule.b, bodies, model);
        if (rule.a != rule.b) apply_rule(rule, rule.b, rule.a, bodies, model);
    }
}

namespace {

/// Diagonals of the elastic bodies' boxes: of all together, and of the smallest, m.
struct Extents {
    double all = 1.0, smallest = kInfinity;
};

Extents extents_of(const Model& model) {
    Box all;
    std::vector<Box> body(model.body_names.size());
    for (std::size_t v = 0; v < model.x0.size(); ++v) {
        if (model.mass[v] <= 0.0) continue;
        all.add(model.x0[v]);
        body[static_cast<std::size_t>(model.body[v])].add(model.x0[v]);
    }
    Extents out;
    for (const Box& box : body)
        if (!box.is_empty()) out.smallest = std::min(out.smallest, box.diagonal());
    if (out.smallest < kInfinity) out.all = all.diagonal();
    return out;
}

/// Of the elastic bodies the shortest typical edge: that which a twentieth of a body's
/// surface edges are shorter than, m.
double short_edge_of(const Model& model) {
    std::vector<std::vector<double>> edges(model.body_names.size());
    for (std::size_t e = 0; e < model.edges.size(); ++e) {
        const auto v = static_cast<std::size_t>(model.edges[e][0]);
        if (model.mass[v] > 0.0)
            edges[static_cast<std::size_t>(model.body[v])].push_back(
                model.edge_rest_sq[e]);
    }
    double shortest = kInfinity;
    for (std::vector<double>& of_body : edges) {
        if (of_body.empty()) continue;
        const auto at =
            of_body.begin() + static_cast<std::ptrdiff_t>(of_body.size() / 20);
        std::nth_element(of_body.begin(), at, of_body.end());
        shortest = std::min(shortest, std::sqrt(*at));
    }
    return shortest;
}

}  // namespace

void resolve_scales(const Scene& scene, Model& model) {
    int with_mass = 0;
    for (const double m : model.mass) {
        model.total_mass += m;
        with_mass += m > 0.0 ? 1 : 0;
    }
    model.mean_mass = with_mass > 0 ? model.total_mass / with_mass : 0.0;
    const Extents extents = extents_of(model);
    const bool own_scale = scene.length_scale > 0.0;
    model.diagonal = own_scale ? scene.length_scale
                               : std::min(extents.all, kMostBodies * extents.smallest);
    const ContactSettings& contact = scene.contact;
    model.dhat = contact.dhat_absolute ? contact.dhat : contact.dhat * model.diagonal;
    if (!contact.dhat_absolute && !own_scale)
        model.dhat = std::min({model.dhat,
                               kDhatOfBody * extents.smallest,
                               kDhatOfEdge * short_edge_of(model)});
    model.min_separation = contact.min_separation;
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
