// SPDX-License-Identifier: Apache-2.0
#include "sim/start_checks.hpp"

#include "step/settings.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace noli {

std::vector<std::size_t> scene_body_of(const Scene& scene) {
    std::vector<std::size_t> out;
    for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
        const auto& grid = scene.bodies[k].grid;
        out.insert(out.end(), static_cast<std::size_t>(grid[0] * grid[1] * grid[2]), k);
    }
    return out;
}

bool is_moved(const Model& model, int body) {
    using Kind = BoundaryCondition::Kind;
    return std::any_of(model.conditions.begin(),
                       model.conditions.end(),
                       [&](const ModelCondition& condition) {
                           const Kind kind = condition.what.kind;
                           return condition.body == body
                               && (kind == Kind::Velocity || kind == Kind::Path
                                   || kind == Kind::Sequence);
                       });
}

std::vector<double> body_masses(const Model& model) {
    std::vector<double> out(model.body_names.size(), 0.0);
    for (std::size_t v = 0; v < model.mass.size(); ++v)
        out[static_cast<std::size_t>(model.body[v])] += model.mass[v];
    return out;
}

std::vector<Vec3d> body_sizes(const Model& model) {
    const std::vector<double> mass = body_masses(model);
    std::vector<Vec3d> low(mass.size(), {HUGE_VAL, HUGE_VAL, HUGE_VAL});
    std::vector<Vec3d> high(mass.size(), {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL});
    for (std::size_t v = 0; v < model.x0.size(); ++v) {
        const std::size_t b = static_cast<std::size_t>(model.body[v]);
        if (mass[b] > 0.0 && model.mass[v] == 0.0) continue;
        for (int k = 0; k < 3; ++k) {
            low[b][k] = std::min(low[b][k], model.x0[v][k]);
            high[b][k] = std::max(high[b][k], model.x0[v][k]);
        }
    }
    for (std::size_t b = 0; b < low.size(); ++b)
        high[b] -= low[b];
    return high;
}

std::string describe_pair(const Model& model, const MinGap& pair) {
    const Int4& v = pair.vertices;
    const auto name = [&](int vertex) {
        return model.body_names[static_cast<std::size_t>(
            model.body[static_cast<std::size_t>(vertex)])];
    };
    using Kind = MinGap::Kind;
    switch (pair.kind) {
        case Kind::PointPoint:
            return fmt::format("vertex {} of \"{}\" and vertex {} of \"{}\"",
                               v[0],
                               name(v[0]),
                               v[1],
                               name(v[1]));
        case Kind::PointEdge:
            return fmt::format("vertex {} of \"{}\" and edge {} {} of \"{}\"",
                               v[0],
                               name(v[0]),
                               v[1],
                               v[2],
                               name(v[1]));
        case Kind::PointTriangle:
            return fmt::format("vertex {} of \"{}\" and triangle {} {} {} of \"{}\"",
                               v[0],
                               name(v[0]),
                               v[1],
                               v[2],
                               v[3],
                               name(v[1]));
        case Kind::EdgeEdge:
        case Kind::Mollified:
            return fmt::format("edge {} {} of \"{}\" and edge {} {} of \"{}\"",
                               v[0],
                               v[1],
                               name(v[0]),
                               v[2],
                               v[3],
                               name(v[2]));
        case Kind::Wall:
            return fmt::format("vertex {} of \"{}\" and half-space \"{}\"",
                               v[0],
                               name(v[0]),
                               model.walls[static_cast<std::size_t>(v[1])].name);
        case Kind::None:
            break;
    }
    return "nothing";
}

Findings check_start(const Scene& scene, const Model& model, Verifier& verifier) {
    Findings out;
    check_lengths(scene, model, out);
    check_materials(scene, model, out);
    check_shapes(model, out);
    check_boundary(scene, model, out);
    const int exponent = spelled_out(scene.contact).barrier_exponent;
    check_gaps(scene, model, verifier.gaps(model.x0, exponent), out);
    check_nested(model, out);
    std::stable_sort(out.begin(), out.end(), [](const Finding& a, const Finding& b) {
        return a.severity < b.severity;
    });
    return out;
}

}  // namespace noli
