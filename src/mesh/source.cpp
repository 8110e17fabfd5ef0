// SPDX-License-Identifier: Apache-2.0
#include "mesh/source.hpp"

#include "mesh/check.hpp"
#include "mesh/read.hpp"
#include "mesh/topology.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fmt/format.h>

namespace noli {

namespace {

namespace fs = std::filesystem;

Error generator_error(const MeshSource& source, const std::string& message) {
    return {Error::Code::InvalidScene, "generator \"" + source.generator + "\"", message};
}

Result<GeneratorValues> complete_values(const MeshSource& source,
                                        const GeneratorEntry& entry) {
    GeneratorValues values;
    for (const GeneratorParameter& p : entry.parameters)
        values[p.name] = p.fallback;
    for (const auto& [name, given] : source.parameters) {
        const auto known = values.find(name);
        if (known == values.end())
            return generator_error(
                source,
                fmt::format("found the unknown parameter \"{}\"; remove it", name));
        if (known->second.size() != given.size())
            return generator_error(source,
                                   fmt::format("found {} numbers for \"{}\", expected {}",
                                               given.size(),
                                               name,
                                               known->second.size()));
        known->second = given;
    }
    return values;
}

Result<Mesh> generate(const MeshSource& source) {
    const GeneratorEntry* entry = find_generator(source.generator);
    if (entry == nullptr)
        return generator_error(
            source, "found an unknown generator, expected one of docs/scene-format.md");
    const Result<GeneratorValues> values = complete_values(source, *entry);
    if (!values) return values.error();
    return entry->make(values.value());
}

}  // namespace

std::string resolve_path(const std::string& path, const std::string& base_folder) {
    const fs::path given(path);
    const fs::path full = given.is_absolute() || base_folder.empty()
                            ? given
                            : fs::path(base_folder) / given;
    return full.lexically_normal().string();
}

bool mesh_file_exists(const std::string& path) {
    std::error_code ec;
    const fs::path given(path);
    if (fs::is_regular_file(given, ec) || fs::is_regular_file(path + ".node", ec))
        return true;
    const std::string extension = given.extension().string();
    const bool codimensional = extension == ".seg" || extension == ".pt";
    return codimensional
        && fs::is_regular_file(fs::path(given).replace_extension(".obj"), ec);
}

CheckOptions body_check_options(bool fix_orientation) {
    return {.fix_orientation = fix_orientation,
            .drop_unreferenced = false,
            .allow_non_manifold = true};
}

Result<Mesh> read_body_mesh(const std::string& path) {
    Result<Mesh> read = read_mesh(path);
    if (!read || read.value().triangles.empty()) return read;
    std::string extension = fs::path(path).extension().string();
    std::transform(
        extension.begin(), extension.end(), extension.begin(), [](unsigned char c) {
            return static_cast<char>(std::tolower(c));
        });
    const bool marks_boundaries = extension == ".msh" || extension == ".mesh";
    Mesh& mesh = read.value();
    mesh.segments = marks_boundaries ? std::vector<Int2>{} : loose_segments(mesh);
    return read;
}

Result<Mesh> load_body_mesh(const MeshSource& source,
                            const std::string& base_folder,
                            std::vector<std::string>* warnings) {
    const bool from_file = !source.file.empty();
    const std::string path =
        from_file ? resolve_path(source.file, base_folder) : source.generator;
    Result<Mesh> mesh = from_file ? read_body_mesh(path) : generate(source);
    if (!mesh) return mesh.error();

    const CheckOptions options = body_check_options(source.fix_orientation);
    MeshReport report;
    const MeshRole role = natural_role(mesh.value());
    Result<Mesh> good = checked(std::move(mesh.value()), path, role, options, &report);
    if (warnings != nullptr)
        for (const MeshIssue& issue : report.warnings)
            warnings->push_back(path + ": " + issue.message);
    return good;
}

}  // namespace noli
