// SPDX-License-Identifier: Apache-2.0
#include "mesh/quality.hpp"
#include "sim/start_checks.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace noli {

namespace {

// dhat over the rounding of coordinates: below the first nothing can be told any more,
// below the second gaps have few digits.
constexpr double kLeastDigits = 1e4;
constexpr double kFewDigits = 1e6;
// Rounding of places over the shortest edge from which shapes have few digits.
constexpr double kLeastShape = 1e-6;

void check_rounding(const Model& model, Findings& out) {
    double farthest = 0.0;
    for (const int v : model.surface_vertices)
        farthest = std::max(farthest, max_abs(model.x0[static_cast<std::size_t>(v)]));
    const double rounding = std::numeric_limits<double>::epsilon() * farthest;
    if (model.dhat >= kFewDigits * rounding) return;
    const bool is_moved = max_abs(model.origin) > 0.0;
    const bool hopeless = model.dhat < kLeastDigits * rounding;
    out.push_back(
        {hopeless ? Finding::Severity::Error : Finding::Severity::Warning,
         "contact/dhat",
         fmt::format(
             "dhat = {:g} m is only {:.3g} times the rounding of coordinates ({:.2g} "
             "m at {:.4g} m from the {}), so gaps {}; choose a dhat of at least "
             "{:.2g} m{}",
             model.dhat,
             model.dhat / rounding,
             rounding,
             farthest,
             is_moved ? "middle of the elastic bodies" : "origin",
             hopeless ? "cannot be told from contact" : "have few digits",
             kFewDigits * rounding,
             farthest > 10.0 * model.diagonal && !is_moved
                 ? ", or move the scene to the origin"
                 : "")});
}

/// Places far from the origin are moved near it before the first step; what their numbers
/// have lost in the files is lost.
void check_origin(const Model& model, Findings& out) {
    const double rounding =
        std::numeric_limits<double>::epsilon() * max_abs(model.origin);
    double shortest = HUGE_VAL;
    for (const double sq : model.edge_rest_sq)
        shortest = std::min(shortest, std::sqrt(sq));
    if (!(rounding > kLeastShape * shortest)) return;
    out.push_back({Finding::Severity::Warning,
                   "/bodies",
                   fmt::format("the bodies are {:.4g} m from the origin, where numbers "
                               "are rounded to {:.2g} m, {:.2g} of the shortest edge: "
                               "meshes, half-spaces and what is written have no more "
                               "digits; move the scene to the origin",
                               max_abs(model.origin),
                               rounding,
                               rounding / shortest)});
}

void check_edges(const Model& model, Findings& out) {
    double shortest = HUGE_VAL;
    for (const double sq : model.edge_rest_sq)
        shortest = std::min(shortest, std::sqrt(sq));
    if (shortest < 2.0 * model.dhat)
        out.push_back(
            {Finding::Severity::Warning,
             "contact/dhat",
             fmt::format("dhat = {:g} m is more than half of the shortest surface "
                         "edge ({:g} m): contact of a body with itself may act at "
                         "rest; choose a smaller dhat",
                         model.dhat,
                         shortest)});
}

/// Smallest side of the box around an elastic body.
void check_extents(const Model& model, Findings& out) {
    const std::vector<double> mass = body_masses(model);
    const std::vector<Vec3d> sizes = body_sizes(model);
    double smallest = HUGE_VAL;
    std::size_t whose = 0;
    for (std::size_t b = 0; b < sizes.size(); ++b) {
        if (mass[b] == 0.0) continue;
        const double least = std::min({sizes[b].x, sizes[b].y, sizes[b].z});
        if (least >= smallest) continue;
        smallest = least;
        whose = b;
    }
    if (model.dhat > 0.25 * smallest)
        out.push_back(
            {Finding::Severity::Warning,
             "contact/dhat",
             fmt::format("dhat = {:g} m is more than a quarter of the thickness of "
                         "\"{}\" ({:g} m): contact acts from so far away that "
                         "bodies of this size behave like larger ones; choose a "
                         "dhat of {:.2g} m or less",
                         model.dhat,
                         model.body_names[whose],
                         smallest,
                         0.1 * smallest)});
}

}  // namespace

void check_lengths(const Scene& scene, const Model& model, Findings& out) {
    check_origin(model, out);
    if (!scene.contact.enabled) return;
    check_rounding(model, out);
    check_extents(model, out);
    check_edges(model, out);
}

void check_shapes(const Model& model, Findings& out) {
    double worst = 1.0;
    int worst_tet = -1;
    for (int t = 0; t < model.num_tets(); ++t) {
        const Int4& v = model.tets[static_cast<std::size_t>(t)];
        const auto at = [&](int k) { return model.x0[static_cast<std::size_t>(v[k])]; };
        const double ratio = radius_ratio(at(0), at(1), at(2), at(3));
        if (ratio < worst) {
            worst = ratio;
            worst_tet = t;
        }
    }
    if (worst_tet < 0) return;
    const Int4& v = model.tets[static_cast<std::size_t>(worst_tet)];
    const std::string text = fmt::format(
        "the worst tetrahedron is {} of \"{}\" (radius ratio {:.3g}; 1 is regular)",
        model.tet_source[static_cast<std::size_t>(worst_tet)],
        model.body_names[static_cast<std::size_t>(
            model.body[static_cast<std::size_t>(v[0])])],
        worst);
    if (worst < 0.02)
        out.push_back({Finding::Severity::Warning,
                       "shapes",
                       text + "; slivers slow the solver, consider remeshing"});
    else
        out.push_back({Finding::Severity::Note, "shapes", text});
}

void check_boundary(const Scene& scene, const Model& model, Findings& out) {
    if (model.num_tets() == 0)
        out.push_back({Finding::Severity::Warning,
                       "/bodies",
                       "no body is elastic: nothing but obstacles will move"});
    const Vec3d gravity{scene.gravity[0], scene.gravity[1], scene.gravity[2]};
    if (model.walls.empty() && model.conditions.empty() && norm(gravity) > 0.0
        && std::find(model.obstacle.begin(), model.obstacle.end(), 1)
               == model.obstacle.end())
        out.push_back({Finding::Severity::Note,
                       "scene",
                       "nothing stops the bodies: they fall for ever"});
}

}  // namespace noli
