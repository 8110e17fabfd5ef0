// SPDX-License-Identifier: Apache-2.0
/// MeshForm: mesh files and generators with their parameters.
#include "mesh/source.hpp"
#include "scene/forms.hpp"
#include "scene/object_reader.hpp"
#include "scene/schema_builder.hpp"
#include "scene/suggest.hpp"

#include <fmt/format.h>

namespace noli {

namespace {

constexpr const char* kFileDoc =
    "Mesh file (.msh, .node/.ele, .mesh, .obj, .ply, .stl, .seg, .pt), relative to "
    "base_folder.";
using Kind = GeneratorParameter::Kind;
constexpr const char* kFixDoc =
    "Turn inverted tetrahedra around instead of refusing the mesh.";

NumberSpec number_spec(const GeneratorParameter& p) {
    if (p.kind == Kind::Length)
        return {.unit = kLength, .above = 0, .at_most = p.at_most, .doc = p.doc};
    if (p.kind == Kind::LengthOrZero)
        return {.unit = kLength, .at_least = 0, .at_most = p.at_most, .doc = p.doc};
    return {.at_least = p.at_least, .at_most = p.at_most, .doc = p.doc};
}

IntSpec count_spec(const GeneratorParameter& p) {
    return {.at_least = static_cast<int>(p.at_least),
            .at_most = static_cast<int>(p.at_most),
            .doc = p.doc};
}

std::optional<double> read_value(ReadContext& context,
                                 const Json& json,
                                 const std::string& pointer,
                                 const GeneratorParameter& p) {
    if (p.kind == Kind::Flag) {
        if (json.is_boolean()) return json.get<bool>() ? 1.0 : 0.0;
        context.fail(
            pointer,
            fmt::format(
                "found {}, expected true or false; write one of them without quotes",
                found_value(json)));
        return std::nullopt;
    }
    if (p.kind != Kind::Count) return read_number(context, json, pointer, number_spec(p));
    const auto count = read_integer(context, json, pointer, count_spec(p));
    return count ? std::optional<double>(*count) : std::nullopt;
}

void read_parameter(ReadContext& context,
                    const Json& json,
                    const std::string& pointer,
                    const GeneratorParameter& p,
                    MeshSource& mesh) {
    const std::size_t size = p.fallback.size();
    std::vector<double> values;
    if (size == 1) {
        if (const auto value = read_value(context, json, pointer, p))
            values.push_back(*value);
    } else if (!json.is_array() || json.size() != size) {
        context.fail(
            pointer,
            fmt::format("found {}, expected a list of {} numbers; correct the list",
                        found_value(json),
                        size));
    } else {
        for (std::size_t i = 0; i < size; ++i)
            if (const auto value =
                    read_value(context, json[i], pointer + "/" + std::to_string(i), p))
                values.push_back(*value);
    }
    if (values.size() == size) mesh.parameters.emplace_back(p.name, values);
}

Kind kind_of(const std::string& generator, const std::string& parameter) {
    if (const GeneratorEntry* entry = find_generator(generator))
        for (const GeneratorParameter& p : entry->parameters)
            if (parameter == p.name) return p.kind;
    return Kind::Number;
}

Json write_value(double value, Kind kind) {
    if (kind == Kind::Flag) return value != 0.0;
    if (kind == Kind::Count) return static_cast<int>(value);
    return value;
}

Json value_schema(const GeneratorParameter& p) {
    if (p.kind == Kind::Flag) return Json{{"type", "boolean"}};
    if (p.kind == Kind::Count) return integer_schema(count_spec(p));
    return number_schema(number_spec(p));
}

Json parameter_schema(const GeneratorParameter& p) {
    const std::size_t size = p.fallback.size();
    Json shape = value_schema(p);
    if (size > 1)
        shape = Json{
            {"type", "array"}, {"items", shape}, {"minItems", size}, {"maxItems", size}};
    Json schema{{"description", p.doc}};
    for (const auto& [key, value] : shape.items())
        schema[key] = value;
    Json fallback = Json::array();
    for (const double value : p.fallback)
        fallback.push_back(write_value(value, p.kind));
    schema["default"] = size == 1 ? fallback[0] : fallback;
    return schema;
}

void read_generator(ObjectReader& reader, const Json& json, MeshSource& mesh) {
    const Json& word = json.at("generator");
    mesh.generator = word.is_string() ? word.get<std::string>() : "";
    const GeneratorEntry* entry = find_generator(mesh.generator);
    if (entry == nullptr) {
        std::vector<std::string> names;
        for (const GeneratorEntry& g : generator_table())
            names.emplace_back(g.name);
        reader.context().fail(reader.at("generator"),
                              fmt::format("found {}, expected {}{}",
                                          found_value(word),
                                          quoted_list(names),
                                          did_you_mean(mesh.generator, names)));
        for (const auto& [key, value] : json.items())
            reader.take(key.c_str());  // cannot be judged without the generator
        return;
    }
    std::vector<const GeneratorParameter*> known;
    for (const GeneratorParameter& p : entry->parameters) {
        reader.take(p.name);
        known.push_back(&p);
    }
    for (const auto& [key, value] :
         json.items())  // in the order of the file, so that writing keeps it
        for (const GeneratorParameter* p : known)
            if (key == p->name)
                read_parameter(reader.context(), value, reader.at(key), *p, mesh);
}

}  // namespace

void MeshForm::read(ReadContext& context,
                    const Json& json,
                    const std::string& pointer,
                    MeshSource& mesh) {
    if (json.is_string()) {
        mesh.file = json.get<std::string>();
        check_file(context, mesh.file, pointer);
        return;
    }
    ObjectReader reader(context, json, pointer);
    const bool has_file = reader.has("file");
    const bool has_generator = reader.has("generator");
    reader.text("file", mesh.file, "", kFileDoc);
    reader.take("generator");
    reader.only_if(has_file, "beside \"file\"");
    reader.boolean("fix_orientation", mesh.fix_orientation, false, kFixDoc);
    reader.always();
    if (json.is_object() && has_file == has_generator)
        context.fail(
            pointer,
            fmt::format(
                "found {} \"file\" {} \"generator\", expected one of the two; {} one",
                has_file ? "both" : "neither",
                has_file ? "and" : "nor",
                has_file ? "remove" : "add"));
    else if (has_file && json.at("file").is_string())
        check_file(context, mesh.file, reader.at("file"));
    if (has_generator) read_generator(reader, json, mesh);
    reader.finish();
}

Json MeshForm::write(const MeshSource& mesh) {
    Json json = Json::object();
    if (!mesh.file.empty()) {
        json["file"] = mesh.file;
        if (mesh.fix_orientation) json["fix_orientation"] = true;
        return json;
    }
    json["generator"] = mesh.generator;
    for (const auto& [name, values] : mesh.parameters) {
        Json list = Json::array();
        for (const double value : values)
            list.push_back(write_value(value, kind_of(mesh.generator, name)));
        json[name] = list.size() == 1 ? list[0] : list;
    }
    return json;
}

Json MeshForm::schema() {
    Json file{{"file", {{"description", kFileDoc}, {"type", "string"}, {"minLength", 1}}},
              {"fix_orientation",
               {{"description", kFixDoc}, {"type", "boolean"}, {"default", false}}}};
    Json forms = Json::array();
    forms.push_back(
        Json{{"description", kFileDoc}, {"type", "string"}, {"minLength", 1}});
    forms.push_back(object_schema(file, {"file"}));
    for (const GeneratorEntry& entry : generator_table()) {
        Json properties;
        properties["generator"] = Json{{"description", entry.doc}, {"const", entry.name}};
        for (const GeneratorParameter& p : entry.parameters)
            properties[p.name] = parameter_schema(p);
        forms.push_back(object_schema(properties, {"generator"}));
    }
    return Json{{"anyOf", forms}};
}

}  // namespace noli
