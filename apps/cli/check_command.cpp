// SPDX-License-Identifier: Apache-2.0
#include "noli/simulator.hpp"

#include "commands.hpp"
#include "terminal.hpp"

#include <cmath>
#include <fmt/format.h>

namespace noli::cli {

namespace {

/// Prints the findings; how many of them are errors.
int print_findings(const std::vector<Finding>& findings) {
    int errors = 0;
    for (const Finding& finding : findings) {
        switch (finding.severity) {
            case Finding::Severity::Error:
                print_error(finding.where, finding.message);
                ++errors;
                break;
            case Finding::Severity::Warning:
                print_warning(finding.where, finding.message);
                break;
            case Finding::Severity::Note:
                print(fmt::format("{}{}{}\n",
                                  finding.where,
                                  finding.where.empty() ? "" : ": ",
                                  finding.message));
                break;
        }
    }
    return errors;
}

void print_intersections(const VerifyReport& report) {
    constexpr size_t kListed = 20;
    for (size_t i = 0; i < std::min(report.intersections.size(), kListed); ++i) {
        const ExactIntersection& it = report.intersections[i];
        const std::string what =
            it.edge[0] == it.edge[1]
                ? fmt::format("vertex {} of {} lies on", it.edge[0], it.body_a)
                : fmt::format(
                    "edge {} {} of {} goes through", it.edge[0], it.edge[1], it.body_a);
        print_error(
            fmt::format("{:.6g} {:.6g} {:.6g}", it.place[0], it.place[1], it.place[2]),
            fmt::format("{} triangle {} {} {} of {}",
                        what,
                        it.triangle[0],
                        it.triangle[1],
                        it.triangle[2],
                        it.body_b));
    }
    int more = report.num_intersections - (report.too_close.empty() ? 0 : 1)
             - static_cast<int>(std::min(report.intersections.size(), kListed));
    for (const BeyondWall& at : report.beyond_walls)  // said among the findings
        more -= static_cast<int>(at.vertices.size());
    if (more > 0) print_error("", fmt::format("and {} more intersections", more));
}

void print_summary(const CheckReport& report) {
    const Resolved& r = report.resolved;
    print(fmt::format("{} bodies, {} vertices, {} tetrahedra, {} surface triangles\n",
                      r.num_bodies,
                      r.num_vertices,
                      r.num_tets,
                      r.num_triangles));
    print(fmt::format("dhat {:.6g} m, smallest gap {}\n",
                      r.dhat,
                      std::isfinite(report.min_gap)
                          ? fmt::format("{:.6g} m", report.min_gap)
                          : std::string("larger")));
    print(fmt::format("about {:.0f} MB of memory and {:.3g} s a step on {}\n",
                      r.estimated_mb,
                      report.estimated_step_s,
                      r.device));
}

}  // namespace

int check_command(const CheckArguments& arguments) {
    std::vector<SceneWarning> warnings;
    const Result<Scene> scene = read_scene(arguments.scene, &warnings);
    for (const SceneWarning& warning : warnings)
        print_warning(warning.where, warning.message);
    if (!scene) return fail(scene.error());
    const std::string folder =
        arguments.mark_folder.empty() ? "." : arguments.mark_folder;
    const Result<CheckReport> checked = check_scene(scene.value(), folder);
    if (!checked) return fail(checked.error());
    const CheckReport& report = checked.value();
    const int errors = print_findings(report.findings);
    print_intersections(report.intersections);
    print_summary(report);
    if (!report.marked_mesh.empty())
        print("intersections are marked in " + report.marked_mesh + "\n");
    const bool is_fine = errors == 0 && report.intersections.num_intersections == 0
                      && report.intersections.num_inversions == 0;
    print(is_fine ? paint(stdout, Colour::Green, "ready to run") + "\n"
                  : paint(stdout, Colour::Red, "not ready to run") + "\n");
    return is_fine ? kFine : kYourInput;
}

}  // namespace noli::cli
