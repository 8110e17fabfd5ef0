// SPDX-License-Identifier: Apache-2.0
#include "sim/run_checks.hpp"

#include "output/run_folder.hpp"
#include "sim/beyond_walls.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <string_view>

namespace noli {

Error wrong_directory(const std::string& where, const std::string& message) {
    return {Error::Code::RunDirectory, where, message};
}

Status check_request(const Scene& scene, const RunOptions& options) {
    if (options.directory.empty())
        return wrong_directory("directory", "is empty; name an output directory");
    if (options.resume && options.overwrite)
        return wrong_directory(options.directory,
                               "asked both to resume and to overwrite; choose one");
    static constexpr std::array<std::string_view, 3> kFormats{"vtu", "obj", "ply"};
    for (const std::string& format : scene.output.formats)
        if (std::find(kFormats.begin(), kFormats.end(), format) == kFormats.end())
            return Error{Error::Code::InvalidScene,
                         "/output/formats",
                         "\"" + format + "\" is not one of \"vtu\", \"obj\", \"ply\""};
    return Done{};
}

Status admit_directory(const RunOptions& options) {
    const std::string& path = options.directory;
    switch (inspect_folder(path)) {
        case FolderState::Missing:
        case FolderState::Empty:
            return Done{};
        case FolderState::Foreign:
            return wrong_directory(path,
                                   "is neither empty nor a run of noli; choose another "
                                   "directory with -o");
        case FolderState::Run:
            break;
    }
    if (options.overwrite || options.resume) return Done{};
    return wrong_directory(path,
                           "holds a run already; go on with --resume, start anew with "
                           "--overwrite, or choose another directory with -o");
}

Error initial_contact(const Scene& scene, const VerifyReport& report) {
    std::string message = describe_beyond_walls(report.beyond_walls);
    if (message.empty()) message = report.too_close;
    if (!message.empty()) {
        message += " (before the first step)";
    } else if (report.num_intersections > 0) {
        message = fmt::format("{} intersections before the first step",
                              report.num_intersections);
        if (!report.intersections.empty()) {
            const ExactIntersection& first = report.intersections.front();
            message += fmt::format(
                " (first: an edge of {} through a triangle of {} at "
                "{:.6g} {:.6g} {:.6g})",
                first.body_a,
                first.body_b,
                first.place[0],
                first.place[1],
                first.place[2]);
        }
    } else {
        message =
            fmt::format("{} inverted tetrahedra before the first step (first: {})",
                        report.num_inversions,
                        report.inverted_tets.empty() ? -1 : report.inverted_tets.front());
    }
    const std::string name = scene.name.empty() ? "scene" : scene.name;
    return {Error::Code::InitialContact,
            name,
            message + "; `noli check` lists them and marks them in a mesh"};
}

}  // namespace noli
