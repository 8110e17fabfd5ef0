// SPDX-License-Identifier: Apache-2.0
#include "scene/ipc_files.hpp"

#include "mesh/source.hpp"
#include "scene/suggest.hpp"

#include <filesystem>
#include <fmt/format.h>
#include <system_error>
#include <utility>
#include <vector>

namespace noli {

namespace fs = std::filesystem;

ScriptFiles::ScriptFiles(const std::string& script) {
    std::error_code ec;
    script_folder_ = fs::absolute(script, ec).parent_path().lexically_normal().string();
}

std::string ScriptFiles::locate(const std::string& path,
                                const ScriptWords& place,
                                bool folder) {
    for (fs::path root = script_folder_;; root = root.parent_path()) {
        const std::string full = resolve_path(path, root.string());
        std::error_code ec;
        const bool found = folder ? fs::is_directory(full, ec) : mesh_file_exists(full);
        if (found) return named(path, root.string());
        if (root == root.parent_path()) break;
    }
    std::vector<std::string> siblings;
    std::error_code ec;
    const fs::path around =
        fs::path(resolve_path(path, base_.value_or(script_folder_))).parent_path();
    for (const auto& entry : fs::directory_iterator(around, ec))
        siblings.push_back(entry.path().filename().string());
    place.fail(
        fmt::format("found no file \"{}\" beside the script or in a folder above it, "
                    "expected a mesh{}; "
                    "correct the path or add the file",
                    path,
                    did_you_mean(fs::path(path).filename().string(), siblings)),
        Error::Code::FileNotReadable);
}

const Mesh& ScriptFiles::load(const std::string& path, const ScriptWords& place) {
    const std::string full = resolve_path(path, base_folder());
    if (const auto known = meshes_.find(full); known != meshes_.end())
        return known->second;
    MeshSource source;
    source.file = path;
    Result<Mesh> mesh = load_body_mesh(source, base_folder());
    if (!mesh)
        place.fail(mesh.error().where + ": " + mesh.error().message, mesh.error().code);
    return meshes_.emplace(full, std::move(mesh.value())).first->second;
}

std::string ScriptFiles::named(const std::string& path, const std::string& root) {
    if (!base_) base_ = root;
    return *base_ == root ? path : resolve_path(path, root);
}

}  // namespace noli
