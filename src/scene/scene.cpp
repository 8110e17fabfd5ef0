// SPDX-License-Identifier: Apache-2.0
#include "noli/scene.hpp"

#include "mesh/source.hpp"
#include "scene/ipc_script.hpp"
#include "scene/object_reader.hpp"
#include "scene/object_writer.hpp"
#include "scene/scene_fields.hpp"
#include "scene/schema_builder.hpp"
#include "scene/suggest.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <set>

namespace noli {

namespace {

namespace fs = std::filesystem;

constexpr const char* kSchemaKeyDoc = "Where editors find the JSON Schema; ignored.";
constexpr const char* kVersionDoc = "Version of this format.";
constexpr const char* kBaseFolderDoc =
    "Where relative mesh paths start, itself relative to the scene file; default: the "
    "folder of the scene file.";

std::string absolute_folder(const std::string& path) {
    std::error_code ec;
    return fs::absolute(path, ec).parent_path().lexically_normal().string();
}

void read_version(ReadContext& context, ObjectReader& reader) {
    const Json* version = reader.take("format_version");
    reader.required("format_version", "write \"format_version\": 1");
    if (version != nullptr && *version != Json(kSceneFormatVersion))
        context.fail(
            reader.at("format_version"),
            fmt::format("found {}, expected {}; newer versions need a newer program",
                        found_value(*version),
                        kSceneFormatVersion));
}

void read_base_folder(ReadContext& context, ObjectReader& reader) {
    std::string folder;
    reader.text("base_folder", folder, "", kBaseFolderDoc);
    if (folder.empty()) return;
    const std::string full = resolve_path(folder, context.base_folder);
    std::error_code ec;
    if (fs::is_directory(full, ec))
        context.base_folder = full;
    else
        context.fail(
            reader.at("base_folder"),
            fmt::format("found no folder \"{}\", expected one; correct the path or "
                        "leave the key out",
                        full));
}

/// Gives nameless entries "<stem><index>" and complains about names that appear twice.
template <class T>
void settle_names(ReadContext& context,
                  const Json& json,
                  const char* key,
                  const char* stem,
                  std::vector<T>& items,
                  std::set<std::string>& taken) {
    for (std::size_t i = 0; i < items.size(); ++i) {
        const Json& item = json.at(key)[i];
        if (item.is_object() && !item.contains("name"))
            items[i].name = stem + std::to_string(i);
        if (items[i].name.empty() || taken.insert(items[i].name).second) continue;
        context.fail(fmt::format("/{}/{}/name", key, i),
                     fmt::format("found the name \"{}\" for the second time, expected "
                                 "different names; rename one",
                                 items[i].name));
    }
}

/// Whether "name[i,j,k]" is a copy of the body.
bool names_copy(const Body& body, const std::string& name) {
    const auto bracket = name.find('[');
    if (bracket == std::string::npos || name.substr(0, bracket) != body.name)
        return false;
    std::array<int, 3> at{-1, -1, -1};
    const int read =
        std::sscanf(name.c_str() + bracket, "[%d,%d,%d]", &at[0], &at[1], &at[2]);
    for (std::size_t k = 0; k < 3; ++k)
        if (at[k] < 0 || at[k] >= body.grid[k]) return false;
    return read == 3;
}

void check_pairs(ReadContext& context, const Scene& scene) {
    std::vector<std::string> names;
    for (const Body& body : scene.bodies)
        names.push_back(body.name);
    for (const HalfSpace& half_space : scene.half_spaces)
        names.push_back(half_space.name);
    for (const Container& container : scene.containers)
        names.push_back(container.name);
    const auto exists = [&](const std::string& name) {
        return name == "*" || std::find(names.begin(), names.end(), name) != names.end()
            || std::any_of(scene.bodies.begin(),
                           scene.bodies.end(),
                           [&](const Body& body) { return names_copy(body, name); });
    };
    for (std::size_t i = 0; i < scene.contact.pairs.size(); ++i) {
        const ContactPairRule& rule = scene.contact.pairs[i];
        for (const auto& [key, name] : {std::pair{"a", rule.a}, std::pair{"b", rule.b}})
            if (!name.empty() && !exists(name))
                context.fail(fmt::format("/contact/pairs/{}/{}", i, key),
                             fmt::format("found \"{}\", expected a body, half-space or "
                                         "container of this scene or \"*\"{}",
                                         name,
                                         did_you_mean(name, names)));
    }
}

void check_whole(ReadContext& context, const Json& json, Scene& scene) {
    std::set<std::string> taken;
    const bool has_bodies = json.contains("bodies") && json.at("bodies").is_array();
    if (has_bodies) settle_names(context, json, "bodies", "body", scene.bodies, taken);
    if (json.contains("half_spaces") && json.at("half_spaces").is_array())
        settle_names(context, json, "half_spaces", "plane", scene.half_spaces, taken);
    if (json.contains("containers") && json.at("containers").is_array())
        settle_names(context, json, "containers", "container", scene.containers, taken);
    if (has_bodies && scene.bodies.empty())
        context.fail("/bodies",
                     "found no bodies, expected at least one; add { \"mesh\": ... }");
    if (!(scene.duration / scene.dt < 2e9))
        context.fail("/dt",
                     fmt::format("found a time step of {} s, too many steps for {} s, "
                                 "expected at most 2e9; "
                                 "enlarge \"dt\"",
                                 scene.dt,
                                 scene.duration));
    check_pairs(context, scene);
}

/// The first complaint, with the others in lines after it.
Error combined(const std::vector<Error>& errors) {
    constexpr std::size_t kMostShown = 10;
    Error error = errors.front();
    for (std::size_t i = 1; i < errors.size() && i < kMostShown; ++i)
        error.message += "\n" + errors[i].where + ": " + errors[i].message;
    if (errors.size() > kMostShown)
        error.message += fmt::format("\nand {} more", errors.size() - kMostShown);
    return error;
}

Result<Scene> scene_from_json(const std::string& text,
                              const std::string& path,
                              std::vector<SceneWarning>* warnings) {
    Result<Json> parsed = parse_json(text, path);
    if (!parsed) return parsed.error();
    const Json& json = parsed.value();
    ReadContext context{.file = path, .base_folder = absolute_folder(path)};
    if (!json.is_object())
        return Error{
            Error::Code::InvalidScene,
            path + ":/",
            fmt::format(
                "found {}, expected an object; write {{ \"format_version\": 1, ... }}",
                found_value(json))};
    Scene scene;
    ObjectReader reader(context, json, "");
    std::string ignored;
    reader.text("$schema", ignored, "", kSchemaKeyDoc);
    read_version(context, reader);
    read_base_folder(context, reader);
    visit_fields(reader, scene);
    reader.finish();
    check_whole(context, json, scene);
    if (!context.errors.empty()) return combined(context.errors);

    if (!json.contains("name")) scene.name = fs::path(path).stem().string();
    scene.base_folder = context.base_folder;
    if (warnings != nullptr)
        warnings->insert(
            warnings->end(), context.warnings.begin(), context.warnings.end());
    return scene;
}

Error unreadable(const std::string& path) {
    std::vector<std::string> siblings;
    std::error_code ec;
    const fs::path folder =
        fs::path(path).has_parent_path() ? fs::path(path).parent_path() : fs::path(".");
    for (const auto& entry : fs::directory_iterator(folder, ec))
        siblings.push_back(entry.path().filename().string());
    std::sort(siblings.begin(), siblings.end());
    const bool there = fs::exists(path, ec);
    return {
        Error::Code::FileNotReadable,
        path,
        fmt::format("found {}, expected a scene file (.json or .txt){}",
                    fs::is_directory(path, ec)
                        ? "a folder"
                        : (there ? "a file that cannot be read" : "no file"),
                    there ? "; name a readable file"
                          : did_you_mean(fs::path(path).filename().string(), siblings))};
}

}  // namespace

int Scene::num_steps() const {
    const double steps = duration / dt;
    const double nearest = std::round(steps);
    const bool whole = std::abs(steps - nearest) <= 1e-9 * std::max(1.0, nearest);
    return static_cast<int>(whole ? nearest : std::ceil(steps));
}

Result<Scene> read_scene(const std::string& path, std::vector<SceneWarning>* warnings) {
    std::string extension = fs::path(path).extension().string();
    std::transform(
        extension.begin(), extension.end(), extension.begin(), [](unsigned char c) {
            return static_cast<char>(std::tolower(c));
        });
    std::error_code ec;
    std::ifstream in(path, std::ios::binary);
    if (!in || fs::is_directory(path, ec)) return unreadable(path);
    if (extension == ".txt") return read_ipc_script(path, warnings);
    if (extension != ".json")
        return Error{Error::Code::InvalidScene,
                     path,
                     fmt::format("found a file ending in \"{}\", expected a scene: "
                                 ".json, or .txt for an IPC script; "
                                 "rename it if it is one",
                                 extension)};
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    return scene_from_json(text, path, warnings);
}

std::string scene_to_json(const Scene& scene) {
    Scene copy = scene;
    Json json;
    json["format_version"] = kSceneFormatVersion;
    const Json fields = ObjectWriter::to_json(copy);
    for (const auto& [key, value] : fields.items()) {
        json[key] = value;
        // Time and step are what one looks for first: they stand there even when they are
        // defaults.
        if (key == "name") {
            json["duration"] = scene.duration;
            json["dt"] = scene.dt;
        }
    }
    if (!scene.base_folder.empty()) json["base_folder"] = scene.base_folder;
    return print_json(json) + "\n";
}

std::string scene_schema() {
    Json properties;
    properties["$schema"] = Json{{"description", kSchemaKeyDoc}, {"type", "string"}};
    properties["format_version"] =
        Json{{"description", kVersionDoc}, {"const", kSceneFormatVersion}};
    const Json scene = SchemaBuilder::of<Scene>();
    for (const auto& [key, value] : scene["properties"].items())
        properties[key] = value;
    properties["bodies"]["minItems"] = 1;
    properties["base_folder"] = Json{{"description", kBaseFolderDoc}, {"type", "string"}};

    Json schema;
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema";
    schema["title"] = "Noli scene, format version 1";
    schema["description"] =
        "Quantities are numbers in SI units or text with a unit, such as \"5 MPa\". "
        "See docs/scene-format.md.";
    const Json body = object_schema(properties, {"format_version", "bodies"});
    for (const auto& [key, value] : body.items())
        schema[key] = value;
    return print_json(schema) + "\n";
}

}  // namespace noli
