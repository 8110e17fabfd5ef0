// SPDX-License-Identifier: Apache-2.0
#include "noli/simulator.hpp"

#include "commands.hpp"
#include "terminal.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>

namespace noli::cli {

namespace fs = std::filesystem;

namespace {

/// The scene as it must be written to lie in `folder`: its relative mesh paths start
/// there now.
Scene moved_to(const Scene& scene, const fs::path& folder) {
    Scene out = scene;
    const fs::path to = fs::absolute(folder).lexically_normal();
    const auto move = [&](std::string& file) {
        if (file.empty() || fs::path(file).is_absolute()) return;
        const fs::path from = fs::absolute(fs::path(scene.base_folder) / file);
        file = from.lexically_normal().lexically_relative(to).string();
    };
    for (Body& body : out.bodies) {
        move(body.mesh.file);
        for (BoundaryCondition& condition : body.boundary)
            for (std::string& file : condition.sequence)
                move(file);
    }
    out.base_folder.clear();
    return out;
}

/// Writes under a temporary name first, so that a full disk leaves no half scene.
Status write_text(const fs::path& path, const std::string& text) {
    const fs::path part(path.string() + ".part");
    errno = 0;
    std::ofstream out(part, std::ios::binary);
    out << text;
    out.close();
    std::error_code failed;
    if (out) fs::rename(part, path, failed);
    if (out && !failed) return Done{};
    const std::string cause = failed ? failed.message() : std::strerror(errno);
    fs::remove(part, failed);
    return Error{Error::Code::FileNotWritable,
                 path.string(),
                 "cannot write: " + cause + "; choose another place with -o"};
}

bool is_scene(const std::string& path) {
    const std::string extension = fs::path(path).extension().string();
    return extension == ".json" || extension == ".txt";
}

int convert_scene(const ConvertArguments& arguments) {
    if (fs::path(arguments.to).extension() != ".json") {
        print_error(arguments.to, "a scene is written as .json; name the output so");
        return kYourInput;
    }
    std::vector<SceneWarning> warnings;
    const Result<Scene> scene = read_scene(arguments.from, &warnings);
    for (const SceneWarning& warning : warnings)
        print_warning(warning.where, warning.message);
    if (!scene) return fail(scene.error());
    const fs::path folder = fs::absolute(arguments.to).parent_path();
    const Status written =
        write_text(arguments.to, scene_to_json(moved_to(scene.value(), folder)));
    return written ? kFine : fail(written.error());
}

}  // namespace

int convert_command(const ConvertArguments& arguments) {
    std::error_code failed;
    if (fs::equivalent(arguments.from, arguments.to, failed)) {
        print_error(arguments.to, "is the input itself; choose another name with -o");
        return kYourInput;
    }
    if (fs::exists(arguments.to) && !arguments.overwrite) {
        print_error(arguments.to, "is there already; replace it with --overwrite");
        return kYourInput;
    }
    int code = kFine;
    if (is_scene(arguments.from)) {
        code = convert_scene(arguments);
    } else {
        const Status converted = convert_mesh(arguments.from, arguments.to);
        if (!converted) code = fail(converted.error());
    }
    if (code == kFine) print(fmt::format("wrote {}\n", arguments.to));
    return code;
}

}  // namespace noli::cli
