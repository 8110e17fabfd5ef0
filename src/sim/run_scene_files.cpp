// SPDX-License-Identifier: Apache-2.0
#include "sim/run_scene_files.hpp"

#include "output/file.hpp"
#include "output/hash.hpp"

#include <filesystem>

namespace noli {

namespace fs = std::filesystem;

void for_each_file(Scene& scene, const std::function<void(std::string&)>& visit) {
    for (Body& body : scene.bodies) {
        if (!body.mesh.file.empty()) visit(body.mesh.file);
        for (BoundaryCondition& condition : body.boundary)
            for (std::string& file : condition.sequence)
                visit(file);
    }
}

std::string absolute_file(const Scene& scene, const std::string& file) {
    return fs::absolute(fs::path(scene.base_folder) / file).lexically_normal().string();
}

Scene with_absolute_files(const Scene& scene) {
    Scene out = scene;
    for_each_file(out,
                  [&scene](std::string& file) { file = absolute_file(scene, file); });
    out.base_folder.clear();
    return out;
}

std::vector<std::string> companion_files(const std::string& absolute) {
    const fs::path path(absolute);
    const std::string extension = path.extension().string();
    std::vector<fs::path> candidates{path};
    const auto beside = [&path](const char* other) {
        return fs::path(path).replace_extension(other);
    };
    if (extension == ".node") candidates.push_back(beside(".ele"));
    if (extension == ".ele") candidates.push_back(beside(".node"));
    if (extension == ".NODE") candidates.push_back(beside(".ELE"));
    if (extension == ".ELE") candidates.push_back(beside(".NODE"));
    if (extension == ".seg" || extension == ".pt") candidates.push_back(beside(".obj"));
    // TetGen's pair may be named without extension.
    candidates.emplace_back(absolute + ".node");
    candidates.emplace_back(absolute + ".ele");
    std::vector<std::string> found;
    for (const fs::path& candidate : candidates) {
        std::error_code ignored;
        if (fs::is_regular_file(candidate, ignored)) found.push_back(candidate.string());
    }
    return found;
}

Result<std::uint64_t> scene_fingerprint(const Scene& scene) {
    Scene bare = scene;
    std::vector<std::string> files;
    for_each_file(bare, [&](std::string& file) {
        for (const std::string& part : companion_files(absolute_file(scene, file)))
            files.push_back(part);
        file = fs::path(file).filename().string();
    });
    const Scene defaults;
    bare.name = defaults.name;
    bare.description = defaults.description;
    bare.base_folder = defaults.base_folder;
    bare.duration = defaults.duration;
    bare.output = defaults.output;
    std::uint64_t hash = hash_bytes(scene_to_json(bare));
    for (const std::string& file : files) {
        const Result<std::string> content = read_file(file);
        if (!content) return content.error();
        hash = hash_bytes(content.value(), hash);
    }
    return hash;
}

}  // namespace noli
