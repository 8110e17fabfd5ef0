// SPDX-License-Identifier: Apache-2.0
/// `check_scene`: everything that is wrong, or may go wrong, before the first frame.

#include "noli/simulator.hpp"

#include "linear/cholmod_solver.hpp"
#include "output/file.hpp"
#include "sim/estimate.hpp"
#include "sim/marked_mesh.hpp"
#include "sim/start_checks.hpp"
#include "sim/verify.hpp"

#include <filesystem>
#include <fmt/format.h>
#include <utility>

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
        check_rest();
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
        report_.intersections = verifier_.run(model_.x0);
        report_.min_gap = verifier_.min_gap(model_.x0);
        const VerifyReport& found = report_.intersections;
        if (found.num_inversions > 0)
            add(Finding::Severity::Error,
                "tetrahedra",
                fmt::format("{} are inverted, first {}",
                            found.num_inversions,
                            found.inverted_tets.front()));
        for (const BeyondWall& at : found.beyond_walls)
            add(Finding::Severity::Error, at.body, at.message);
        if (!found.too_close.empty())
            add(Finding::Severity::Error, "contact/min_separation", found.too_close);
        if (found.num_intersections == 0 && report_.min_gap < model_.dhat)
            add(Finding::Severity::Note,
                "gap",
                fmt::format("the smallest gap is {:g} m, below dhat = {:g} m: bodies "
                            "push each other from the "
                            "first step",
                            report_.min_gap,
                            model_.dhat));
    }

    /// What start_checks.hpp has; of a start that intersects only what does not mind.
    void check_rest() {
        Findings found;
        if (report_.intersections.num_intersections == 0) {
            found = check_start(scene_, model_, verifier_);
        } else {
            check_lengths(scene_, model_, found);
            check_materials(scene_, model_, found);
            check_shapes(model_, found);
            check_boundary(scene_, model_, found);
        }
        check_obstacles(model_, verifier_, found);
        for (Finding& finding : found)
            report_.findings.push_back(std::move(finding));
    }

    const Scene& scene_;
    const Model& model_;
    Verifier verifier_{model_};
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
