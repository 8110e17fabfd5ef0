// SPDX-License-Identifier: Apache-2.0
#include "scene/forms.hpp"

#include "scene/affine.hpp"
#include "scene/body_fields.hpp"
#include "scene/materials.hpp"
#include "scene/object_reader.hpp"
#include "scene/object_writer.hpp"
#include "scene/schema_builder.hpp"
#include "scene/suggest.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>

namespace noli {

namespace {

constexpr NumberSpec kTransformLength{.unit = kLength, .doc = "Shift in the world."};
constexpr NumberSpec kTransformAngle{
    .unit = kAngle, .doc = "Turn Rx Ry Rz: about z first, then y, then x."};
constexpr NumberSpec kTransformScale{.doc = "Scale, one number or one per axis."};

bool same_bits(const Affine& a, const Affine& b) {
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 4; ++j)
            if (std::bit_cast<std::uint64_t>(a.rows[i][j])
                != std::bit_cast<std::uint64_t>(b.rows[i][j]))
                return false;
    return true;
}

void read_matrix(ReadContext& context,
                 const Json& json,
                 const std::string& pointer,
                 Affine& affine) {
    bool fits = json.is_array() && json.size() == 3;
    for (std::size_t i = 0; fits && i < 3; ++i)
        fits = json[i].is_array() && json[i].size() == 4;
    if (!fits) {
        context.fail(pointer,
                     fmt::format("found {}, expected 3 rows of 4 numbers; write [[a, b, "
                                 "c, x], [d, e, f, y], "
                                 "[g, h, i, z]]",
                                 found_value(json)));
        return;
    }
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 4; ++j) {
            const NumberSpec spec{.unit = j == 3 ? kLength : kPlainNumber};
            const std::string place = fmt::format("{}/{}/{}", pointer, i, j);
            if (const auto entry = read_number(context, json[i][j], place, spec))
                affine.rows[i][j] = *entry;
        }
}

std::optional<Vector3> read_scale(ReadContext& context,
                                  const Json& json,
                                  const std::string& pointer) {
    if (json.is_array()) return read_vector(context, json, pointer, kTransformScale);
    const auto factor = read_number(context, json, pointer, kTransformScale);
    if (!factor) return std::nullopt;
    return Vector3{*factor, *factor, *factor};
}

}  // namespace

// ── transform
// ──────────────────────────────────────────────────────────────────────────────────

void TransformForm::read(ReadContext& context,
                         const Json& json,
                         const std::string& pointer,
                         Affine& affine) {
    ObjectReader reader(context, json, pointer);
    Vector3 scale{1, 1, 1};
    Vector3 rotation{};
    Vector3 translation{};
    if (const Json* found = reader.take("scale"))
        scale = read_scale(context, *found, reader.at("scale")).value_or(scale);
    reader.vector("rotate_deg", rotation, {}, kTransformAngle);
    reader.vector("translate", translation, {}, kTransformLength);
    const Json* matrix = reader.take("matrix");
    reader.finish();
    if (matrix == nullptr) {
        affine = make_affine(scale, rotation, translation);
    } else if (json.size() > 1) {
        context.fail(reader.at("matrix"),
                     "found \"matrix\" beside other keys, expected it alone; remove "
                     "\"matrix\", or \"scale\", \"rotate_deg\" and \"translate\"");
    } else {
        read_matrix(context, *matrix, reader.at("matrix"), affine);
    }
    const double volume = determinant(affine);
    if (volume == 0.0 || !std::isfinite(volume))
        context.fail(
            pointer,
            "found a transform that flattens the body, expected one with a volume factor "
            "other than 0; correct \"scale\" or \"matrix\"");
}

Json TransformForm::write(const Affine& affine) {
    if (same_bits(affine, Affine{})) return {};
    const auto& m = affine.rows;
    const Vector3 scale{m[0][0], m[1][1], m[2][2]};
    const Vector3 translation{m[0][3], m[1][3], m[2][3]};
    Json json = Json::object();
    if (same_bits(affine, make_affine(scale, {}, translation))) {
        if (scale[0] == scale[1] && scale[1] == scale[2]) {
            if (scale[0] != 1.0) json["scale"] = scale[0];
        } else {
            json["scale"] = scale;
        }
        if (translation != Vector3{} || std::signbit(translation[0])
            || std::signbit(translation[1]) || std::signbit(translation[2]))
            json["translate"] = translation;
    } else {
        json["matrix"] = m;
    }
    return json;
}

Json TransformForm::schema() {
    Json properties;
    Json scale{{"description", kTransformScale.doc}};
    scale["anyOf"] = {number_schema(kTransformScale), vector_schema(kTransformScale)};
    scale["default"] = 1;
    properties["scale"] = scale;
    properties["rotate_deg"] =
        described_schema(vector_schema(kTransformAngle), kTransformAngle.doc);
    properties["translate"] =
        described_schema(vector_schema(kTransformLength), kTransformLength.doc);
    Json row{{"type", "array"},
             {"items", {{"type", {"number", "string"}}}},
             {"minItems", 4},
             {"maxItems", 4}};
    properties["matrix"] = Json{
        {"description",
         "Instead of the others: the rows of the 3x4 matrix [A | b] of x -> A x + b."},
        {"type", "array"},
        {"items", row},
        {"minItems", 3},
        {"maxItems", 3}};
    return object_schema(properties);
}

// ── material
// ───────────────────────────────────────────────────────────────────────────────────

namespace {

void apply_preset(ReadContext& context,
                  const Json& json,
                  const std::string& pointer,
                  Material& material) {
    std::vector<std::string> names;
    const std::string word = json.is_string() ? json.get<std::string>() : "";
    for (const MaterialPreset& preset : material_presets()) {
        names.emplace_back(preset.name);
        if (word != preset.name) continue;
        material.density = preset.density;
        material.young = preset.young;
        material.poisson = preset.poisson;
        return;
    }
    context.fail(pointer,
                 fmt::format("found {}, expected a material preset: {}{}",
                             found_value(json),
                             quoted_list(names),
                             did_you_mean(word, names)));
}

}  // namespace

void MaterialForm::read(ReadContext& context,
                        const Json& json,
                        const std::string& pointer,
                        Material& material) {
    if (json.is_string()) return apply_preset(context, json, pointer, material);
    ObjectReader reader(context, json, pointer);
    if (const Json* preset = reader.take("preset"))
        apply_preset(context, *preset, reader.at("preset"), material);
    visit_fields(reader, material);
    reader.finish();
}

Json MaterialForm::write(const Material& material) {
    Material copy = material;
    Json json = ObjectWriter::to_json(copy);
    if (json.empty()) return {};
    // The constants belong together: nobody should have to know our defaults to read one
    // of them.
    Json full;
    if (json.contains("model")) full["model"] = json["model"];
    full["density"] = material.density;
    full["young"] = material.young;
    full["poisson"] = material.poisson;
    if (json.contains("gipc_lame")) full["gipc_lame"] = json["gipc_lame"];
    return full;
}

Json MaterialForm::schema() {
    Json names = Json::array();
    std::string doc = "Constants to start from; keys beside it override them. One of:";
    for (const MaterialPreset& preset : material_presets()) {
        doc += fmt::format(
            "{} \"{}\", {}", names.empty() ? "" : ";", preset.name, preset.doc);
        names.push_back(preset.name);
    }
    Json properties;
    properties["preset"] = Json{{"description", doc + "."}, {"enum", names}};
    const Json fields = SchemaBuilder::of<Material>();
    for (const auto& [key, value] : fields["properties"].items())
        properties[key] = value;
    return Json{{"anyOf", {Json{{"enum", names}}, object_schema(properties)}}};
}

}  // namespace noli
