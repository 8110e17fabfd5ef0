// SPDX-License-Identifier: Apache-2.0
/// Volumes and obstacles that overlap where no contact can tell.

#include "contact/nested.hpp"
#include "sim/start_checks.hpp"
#include "step/collision.hpp"

#include <fmt/format.h>
#include <map>
#include <set>
#include <utility>

namespace noli {

void check_nested(const Model& model, Findings& out) {
    const std::vector<double> mass = body_masses(model);
    std::vector<bool> is_solid;
    for (const double m : mass)
        is_solid.push_back(m > 0.0);
    const View<const Vec3d> x{model.x0.data(), model.num_vertices};
    std::set<std::pair<int, int>> said;
    for (const Nested& found :
         nested_bodies(collision_mesh(model, model.obstacle), is_solid, x)) {
        if (!said.insert({found.inner, found.outer}).second) continue;
        const std::string& inner =
            model.body_names[static_cast<std::size_t>(found.inner)];
        const std::string& outer =
            model.body_names[static_cast<std::size_t>(found.outer)];
        out.push_back(
            {Finding::Severity::Warning,
             "\"" + inner + "\"",
             found.inner == found.outer
                 ? fmt::format(
                     "has a part inside another part of itself (vertex {}): no "
                     "surfaces cross, so the two overlap for ever; repair the mesh",
                     found.vertex)
                 : fmt::format(
                     "lies wholly inside \"{}\" (vertex {}): no surfaces cross, so "
                     "contact cannot part them and they overlap for ever; move one "
                     "of them out, or cut a hole into \"{}\"",
                     outer,
                     found.vertex,
                     outer)});
    }
}

void check_obstacles(const Model& model, Verifier& verifier, Findings& out) {
    std::map<std::pair<std::string, std::string>, std::pair<int, Vector3>> pairs;
    for (const ExactIntersection& hit : verifier.obstacle_overlaps(model.x0)) {
        auto& [count, place] = pairs[std::minmax(hit.body_a, hit.body_b)];
        if (count++ == 0) place = hit.place;
    }
    for (const auto& [who, where] : pairs) {
        bool moving = false;
        for (int b = 0; b < model.num_bodies(); ++b) {
            const std::string& name = model.body_names[static_cast<std::size_t>(b)];
            if (name == who.first || name == who.second)
                moving = moving || is_moved(model, b);
        }
        out.push_back(
            {Finding::Severity::Note,
             fmt::format("\"{}\" and \"{}\"", who.first, who.second),
             fmt::format("obstacles that overlap (near {:.4g} {:.4g} {:.4g}); {}",
                         where.second[0],
                         where.second[1],
                         where.second[2],
                         moving
                             ? "they may, but a body that gets between them while they "
                               "move is squeezed to nothing, which ends the run"
                             : "they may, nothing moves them")});
    }
}

}  // namespace noli
