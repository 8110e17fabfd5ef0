// SPDX-License-Identifier: Apache-2.0
/// `check_scene`: everything that is wrong, or may go wrong, before the first frame.

#include "noli/simulator.hpp"

#include "linear/cholmod_solver.hpp"
#include "mesh/quality.hpp"
#include "output/file.hpp"
#include "sim/estimate.hpp"
#include "sim/marked_mesh.hpp"
#include "sim/verify.hpp"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace noli {

namespace {

/// Seconds per step from tets and surface: fitted to the seconds per Newton iteration in
/// docs/performance.md (two cores; within a factor 1.6 on its scenes), at five iterations
/// a step. Those scenes need 2 to 22. An order of magnitude, said as such.
double estimate_step_seconds(const Model& model) {
    constexpr double kIterations = 5.0;
    constexpr double kPerTet = 0.9e-6;
    constexpr double kPerTriangle = 0.6e-6;
    return kIterations
         * (kPerTet * model.num_tets()
            + kPerTriangle * static_cast<double>(model.triangles.size()));
}

class Checker {
  public:
    Checker(const Scene& scene, const Model& model) : scene_(scene), model_(model) {}

    CheckReport run(const std::vector<SceneWarning>& warnings) {
        for (const SceneWarning& warning : warnings)
            add(Finding::Severity::Warning, warning.where, warning.message);
        fill_resolved();
        check_intersections();
        check_shapes();
        check_scales();
        check_boundary();
        return std::move(report_);
    }

  private:
    void add(Finding::Severity severity, std::string where, std::string message) {
        report_.findings.push_back({severity, std::move(where), std::move(message)});
    }

    void fill_resolved() {
        Resolved& r = report_.resolved;
        r.diagonal = model_.diagonal;
        r.dhat = model_.dhat;
        r.epsv = model_.epsv;
        r.tolerance = model_.tolerance(scene_.solver, 0);
        r.estimated_mb = estimate_megabytes(model_);
        r.total_mass = model_.total_mass;
        r.num_vertices = model_.num_vertices;
        r.num_tets = model_.num_tets();
        r.num_triangles = static_cast<int>(model_.triangles.size());
        r.num_bodies = model_.num_bodies();
        r.device = "one core like this one";
        report_.estimated_step_s = estimate_step_seconds(model_);
    }

    void check_intersections() {
        Verifier verifier(model_);
        report_.intersections = verifier.run(model_.x0);
        report_.min_gap = verifier.min_gap(model_.x0);
        const VerifyReport& found = report_.intersections;
        if (found.num_inversions > 0)
            add(Finding::Severity::Error,
                "tetrahedra",
                fmt::format("{} are inverted, first {}",
                            found.num_inversions,
                            found.inverted_tets.front()));
        if (found.num_intersections == 0 && report_.min_gap < model_.dhat)
            add(Finding::Severity::Note,
                "gap",
                fmt::format("the smallest gap is {:g} m, below dhat = {:g} m: bodies "
                            "push each other from the "
                            "first step",
                            report_.min_gap,
                            model_.dhat));
    }

    void check_shapes() {
        double worst = 1.0;
        int worst_tet = -1;
        for (int t = 0; t < model_.num_tets(); ++t) {
            const Int4& v = model_.tets[static_cast<std::size_t>(t)];
            const auto at = [&](int k) {
                return model_.x0[static_cast<std::size_t>(v[k])];
            };
            const double ratio = radius_ratio(at(0), at(1), at(2), at(3));
            if (ratio < worst) {
                worst = ratio;
                worst_tet = t;
            }
        }
        if (worst_tet < 0) return;
        const Int4& v = model_.tets[static_cast<std::size_t>(worst_tet)];
        const std::string text = fmt::format(
            "the worst tetrahedron is {} of \"{}\" (radius ratio {:.3g}; 1 is regular)",
            model_.tet_source[static_cast<std::size_t>(worst_tet)],
            model_.body_names[static_cast<std::size_t>(
                model_.body[static_cast<std::size_t>(v[0])])],
            worst);
        if (worst < 0.02)
            add(Finding::Severity::Warning,
                "shapes",
                text + "; slivers slow the solver, consider remeshing");
        else
            add(Finding::Severity::Note, "shapes", text);
    }

    void check_scales() {
        double shortest = HUGE_VAL;
        for (const double sq : model_.edge_rest_sq)
            shortest = std::min(shortest, std::sqrt(sq));
        if (shortest < 2.0 * model_.dhat)
            add(Finding::Severity::Warning,
                "contact/dhat",
                fmt::format("dhat = {:g} m is more than half of the shortest surface "
                            "edge ({:g} m): contact of a "
                            "body with itself may act at rest; choose a smaller dhat",
                            model_.dhat,
                            shortest));
        for (std::size_t k = 0; k < scene_.bodies.size(); ++k)
            if (scene_.bodies[k].material.poisson > 0.495)
                add(Finding::Severity::Warning,
                    fmt::format("/bodies/{}/material/poisson", k),
                    "nearly incompressible: linear tetrahedra lock; 0.49 is usually "
                    "stiff enough");
    }

    void check_boundary() {
        if (model_.num_tets() == 0)
            add(Finding::Severity::Warning,
                "/bodies",
                "no body is elastic: nothing but obstacles will move");
        if (scene_.half_spaces.empty() && model_.conditions.empty()
            && norm(Vec3d{scene_.gravity[0], scene_.gravity[1], scene_.gravity[2]}) > 0.0
            && std::find(model_.obstacle.begin(), model_.obstacle.end(), 1)
                   == model_.obstacle.end())
            add(Finding::Severity::Note,
                "scene",
                "nothing stops the bodies: they fall for ever");
    }

    const Scene& scene_;
    const Model& model_;
    CheckReport report_;
};

}  // namespace

Result<CheckReport> check_scene(const Scene& scene, const std::string& mark_folder) {
    std::vector<SceneWarning> warnings;
    Result<Model> model = build_model(scene, &warnings);
    if (!model) return model.error();
    CheckReport report = Checker(scene, model.value()).run(warnings);
    if (report.intersections.num_intersections > 0 && !mark_folder.empty()) {
        const std::string path =
            (std::filesystem::path(mark_folder) / "intersections.ply").string();
        Status written = write_marked_mesh(path, model.value(), report.intersections);
        if (!written) return written.error();
        report.marked_mesh = path;
    }
    return report;
}

}  // namespace noli
