// SPDX-License-Identifier: Apache-2.0
#include "scene/forms.hpp"

#include "scene/affine.hpp"
#include "scene/materials.hpp"
#include "scene/object_reader.hpp"
#include "scene/object_writer.hpp"
#include "scene/scene_fields.hpp"
#include "scene/schema_builder.hpp"
#include "scene/suggest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace noli {

namespace {

constexpr NumberSpec kTransformLength{.unit = kLength, .doc = "Shift in the world."};
constexpr NumberSpec kTransformAngle{.unit = kAngle,
                                     .doc = "Turn Rx Ry Rz: about z first, then y, then x."};
constexpr NumberSpec kTransformScale{.doc = "Scale, one number or one per axis."};

bool same_bits(const Affine& a, const Affine& b) {
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 4; ++j)
            if (std::bit_cast<std::uint64_t>(a.rows[i][j]) != std::bit_cast<std::uint64_t>(b.rows[i][j]))
                return false;
    return true;
}

Json described(Json schema, const std::string& doc) {
    Json out{{"description", doc}};
    for (auto& [key, value] : schema.items())
        out[key] = value;
    return out;
}

void read_matrix(ReadContext& context, const Json& json, const std::string& pointer, Affine& affine) {
    bool fits = json.is_array() && json.size() == 3;
    for (std::size_t i = 0; fits && i < 3; ++i)
        fits = json[i].is_array() && json[i].size() == 4;
    if (!fits) {
        context.fail(pointer,
                     fmt::format("found {}, expected 3 rows of 4 numbers; write [[a, b, c, x], [d, e, f, y], "
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

std::optional<Vector3> read_scale(ReadContext& context, const Json& json, const std::string& pointer) {
    if (json.is_array()) return read_vector(context, json, pointer, kTransformScale);
    const auto factor = read_number(context, json, pointer, kTransformScale);
    if (!factor) return std::nullopt;
    return Vector3{*factor, *factor, *factor};
}

}  // namespace

// ── transform ──────────────────────────────────────────────────────────────────────────────────

void TransformForm::read(ReadContext& context, const Json& json, const std::string& pointer, Affine& affine) {
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
        context.fail(reader.at("matrix"), "found \"matrix\" beside other keys, expected it alone; remove "
                                          "\"matrix\", or \"scale\", \"rotate_deg\" and \"translate\"");
    } else {
        read_matrix(context, *matrix, reader.at("matrix"), affine);
    }
    const double volume = determinant(affine);
    if (volume == 0.0 || !std::isfinite(volume))
        context.fail(pointer, "found a transform that flattens the body, expected one with a volume factor "
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
        if (translation != Vector3{} || std::signbit(translation[0]) || std::signbit(translation[1])
            || std::signbit(translation[2]))
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
    properties["rotate_deg"] = described(vector_schema(kTransformAngle), kTransformAngle.doc);
    properties["translate"] = described(vector_schema(kTransformLength), kTransformLength.doc);
    Json row{{"type", "array"}, {"items", {{"type", {"number", "string"}}}}, {"minItems", 4}, {"maxItems", 4}};
    properties["matrix"] = Json{{"description", "Instead of the others: the rows of the 3x4 matrix [A | b] of x -> A x + b."},
                                {"type", "array"}, {"items", row}, {"minItems", 3}, {"maxItems", 3}};
    return object_schema(properties);
}

// ── material ───────────────────────────────────────────────────────────────────────────────────

namespace {

void apply_preset(ReadContext& context, const Json& json, const std::string& pointer, Material& material) {
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
    context.fail(pointer, fmt::format("found {}, expected a material preset: {}{}", found_value(json),
                                      quoted_list(names), did_you_mean(word, names)));
}

}  // namespace

void MaterialForm::read(ReadContext& context, const Json& json, const std::string& pointer, Material& material) {
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
    // The constants belong together: nobody should have to know our defaults to read one of them.
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
        doc += fmt::format("{} \"{}\", {}", names.empty() ? "" : ";", preset.name, preset.doc);
        names.push_back(preset.name);
    }
    Json properties;
    properties["preset"] = Json{{"description", doc + "."}, {"enum", names}};
    const Json fields = SchemaBuilder::of<Material>();
    for (const auto& [key, value] : fields["properties"].items())
        properties[key] = value;
    return Json{{"anyOf", {Json{{"enum", names}}, object_schema(properties)}}};
}

// ── select ─────────────────────────────────────────────────────────────────────────────────────

namespace {

constexpr std::array kFrames{
    Choice{Selection::Frame::MeshBox, "mesh_box", "in units of the bounding box of the mesh before its transform, 0 to 1"},
    Choice{Selection::Frame::World, "world", "in metres, in the placement at the start"}};
constexpr const char* kSurfaceDoc = "Only vertices of the surface.";
constexpr const char* kBoxDoc = "Opposite corners [[x, y, z], [x, y, z]], inclusive, of the box that holds the vertices.";
constexpr const char* kVerticesDoc = "Numbers of vertices, from 0, in the order of the mesh file.";
constexpr IntSpec kVertexSpec{.at_least = 0, .doc = kVerticesDoc};

void read_box(ReadContext& context, const Json& json, const std::string& pointer, Selection& selection) {
    if (!json.is_array() || json.size() != 2) {
        context.fail(pointer, fmt::format("found {}, expected two corners; write [[x, y, z], [x, y, z]]",
                                          found_value(json)));
        return;
    }
    const bool world = selection.frame == Selection::Frame::World;
    const NumberSpec spec{.unit = world ? kLength : kPlainNumber};
    const auto low = read_vector(context, json[0], pointer + "/0", spec);
    const auto high = read_vector(context, json[1], pointer + "/1", spec);
    if (!low || !high) return;
    selection.box_min = *low;
    selection.box_max = *high;
    for (std::size_t k = 0; k < 3; ++k)
        if ((*low)[k] > (*high)[k]) {
            context.fail(pointer, fmt::format("found an empty box: {} > {} along {}, expected the smaller corner "
                                              "first; exchange the two",
                                              (*low)[k], (*high)[k], "xyz"[k]));
            return;
        }
}

}  // namespace

void SelectForm::read(ReadContext& context, const Json& json, const std::string& pointer, Selection& selection) {
    if (json == Json("all")) return;
    ObjectReader reader(context, json, pointer);
    const bool has_box = reader.has("box");
    const bool has_vertices = reader.has("vertices");
    reader.only_if(has_box, "beside \"box\"");
    reader.choice("frame", selection.frame, Selection::Frame::MeshBox, all(kFrames), "");
    reader.boolean("surface_only", selection.surface_only, false, kSurfaceDoc);
    reader.always();
    if (const Json* box = reader.take("box")) {
        selection.kind = Selection::Kind::Box;
        read_box(context, *box, reader.at("box"), selection);
    }
    reader.integers("vertices", selection.vertices, kVertexSpec);
    reader.finish();
    if (has_vertices) selection.kind = Selection::Kind::Vertices;
    if (json.is_object() && has_box == has_vertices)
        context.fail(pointer, fmt::format("found {} \"box\" {} \"vertices\", expected one of the two; {} one",
                                          has_box ? "both" : "neither", has_box ? "and" : "nor",
                                          has_box ? "remove" : "add"));
    else if (has_vertices && selection.vertices.empty())
        context.fail(reader.at("vertices"), "found no vertices, expected at least one; list them, or leave out "
                                            "\"select\" for all");
}

Json SelectForm::write(const Selection& selection) {
    Json json;
    if (selection.kind == Selection::Kind::Vertices) json["vertices"] = selection.vertices;
    if (selection.kind != Selection::Kind::Box) return json;
    if (selection.frame == Selection::Frame::World) json["frame"] = "world";
    json["box"] = {selection.box_min, selection.box_max};
    if (selection.surface_only) json["surface_only"] = true;
    return json;
}

Json SelectForm::schema() {
    SchemaBuilder builder;
    Selection none;
    builder.only_if(true, "beside \"box\"");
    builder.choice("frame", none.frame, Selection::Frame::MeshBox, all(kFrames), "What the numbers of the box mean.");
    builder.boolean("surface_only", none.surface_only, false, kSurfaceDoc);
    builder.always();
    Json properties = builder.properties();
    const Json corner = vector_schema({.unit = kLength});
    properties["box"] = Json{{"description", kBoxDoc}, {"type", "array"}, {"items", corner}, {"minItems", 2}, {"maxItems", 2}};
    properties["vertices"] = Json{{"description", kVerticesDoc}, {"type", "array"}, {"items", integer_schema(kVertexSpec)}, {"minItems", 1}};
    return Json{{"anyOf", {Json{{"const", "all"}}, object_schema(properties)}}};
}

// ── until ──────────────────────────────────────────────────────────────────────────────────────

namespace {

using Until = BoundaryCondition::Until;
constexpr std::array kSubjects{Choice{Until::Subject::Body, "body", "all vertices of the body"},
                               Choice{Until::Subject::Selection, "selection", "the selected vertices"}};
constexpr std::array kAxes{Choice{0, "x", "x"}, Choice{1, "y", "y"}, Choice{2, "z", "z"}};
constexpr std::array kThen{Choice{false, "release", "the vertices are free"}, Choice{true, "hold", "they stay where they are"}};
constexpr NumberSpec kAboveSpec{.unit = kLength, .doc = "Beyond means at this coordinate or more."};
constexpr NumberSpec kBelowSpec{.unit = kLength, .doc = "Beyond means at this coordinate or less."};

template <class V>
void visit_until(V& v, Until& until, std::optional<double>& above, std::optional<double>& below) {
    v.choice("subject", until.subject, Until::Subject::Body, all(kSubjects), "Which vertices must be beyond.");
    v.required("axis", "write \"x\", \"y\" or \"z\"");
    v.choice("axis", until.axis, -1, all(kAxes), "Direction.");
    v.maybe_number("above", above, kAboveSpec);
    v.maybe_number("below", below, kBelowSpec);
    v.choice("then", until.then_hold, false, all(kThen), "What happens afterwards.");
}

}  // namespace

void UntilForm::read(ReadContext& context, const Json& json, const std::string& pointer, Value& value) {
    ObjectReader reader(context, json, pointer);
    Until until;
    std::optional<double> above, below;
    visit_until(reader, until, above, below);
    reader.finish();
    if (json.is_object() && reader.has("above") == reader.has("below"))
        context.fail(pointer, fmt::format("found {} of \"above\" and \"below\", expected one; {} one",
                                          reader.has("above") ? "both" : "neither",
                                          reader.has("above") ? "remove" : "add"));
    until.above = above.has_value();
    until.value = above ? *above : below.value_or(0.0);
    value = until;
}

Json UntilForm::write(const Value& value) {
    if (!value) return {};
    Until until = *value;
    std::optional<double> above, below;
    (until.above ? above : below) = until.value;
    ObjectWriter writer;
    visit_until(writer, until, above, below);
    return writer.json();
}

Json UntilForm::schema() {
    SchemaBuilder builder;
    Until until;
    std::optional<double> above, below;
    visit_until(builder, until, above, below);
    return builder.schema();
}

// ── grid, name, end ────────────────────────────────────────────────────────────────────────────

namespace {

constexpr IntSpec kCountSpec{.at_least = 1, .at_most = 100000};
constexpr NumberSpec kSpacingSpec{.unit = kLength, .doc = "Copy (i, j, k) is shifted by [i sx, j sy, k sz]."};

}  // namespace

void GridForm::read(ReadContext& context, const Json& json, const std::string& pointer, Body& body) {
    ObjectReader reader(context, json, pointer);
    reader.required("count", "write \"count\": [nx, ny, nz]");
    std::vector<int> count;
    reader.integers("count", count, kCountSpec);
    reader.vector("spacing", body.grid_spacing, {}, kSpacingSpec);
    reader.finish();
    const bool listed = reader.has("count") && json.at("count").is_array();
    if (listed && json.at("count").size() != 3)
        context.fail(reader.at("count"), fmt::format("found {}, expected three numbers; write [nx, ny, nz]",
                                                     found_value(json.at("count"))));
    if (count.size() != 3) return;
    for (std::size_t k = 0; k < 3; ++k) {
        body.grid[k] = count[k];
        if (count[k] > 1 && body.grid_spacing[k] == 0.0)
            context.fail(reader.at("spacing"), fmt::format("found a spacing of 0 along {}, where there are {} copies, "
                                                           "expected a distance; they would lie on each other",
                                                           "xyz"[k], count[k]));
    }
}

Json GridForm::write(const Body& body) {
    if (body.grid == std::array{1, 1, 1} && body.grid_spacing == Vector3{}) return {};
    return Json{{"count", body.grid}, {"spacing", body.grid_spacing}};
}

Json GridForm::schema() {
    Json properties;
    properties["count"] = Json{{"description", "Copies along x, y, z."},
                               {"type", "array"}, {"items", integer_schema(kCountSpec)}, {"minItems", 3}, {"maxItems", 3}};
    properties["spacing"] = described(vector_schema(kSpacingSpec), kSpacingSpec.doc);
    return object_schema(properties, {"count"});
}

void NameForm::read(ReadContext& context, const Json& json, const std::string& pointer, std::string& name) {
    if (!json.is_string()) {
        context.fail(pointer, fmt::format("found {}, expected a name; put it in quotes", found_value(json)));
        return;
    }
    name = json.get<std::string>();
    if (name == "*" || name.find('[') != std::string::npos)
        context.fail(pointer, fmt::format("found the name \"{}\", expected one without \"*\" and \"[\", which have a "
                                          "meaning in contact pairs; choose another",
                                          name));
}

void TitleForm::read(ReadContext& context, const Json& json, const std::string& pointer, std::string& text) {
    if (json.is_string())
        text = json.get<std::string>();
    else
        context.fail(pointer, fmt::format("found {}, expected text; put it in quotes", found_value(json)));
}

namespace {
constexpr NumberSpec kEndSpec{.unit = kTime, .above = 0};
}

void EndForm::read(ReadContext& context, const Json& json, const std::string& pointer, double& time) {
    if (const auto number = read_number(context, json, pointer, kEndSpec)) time = *number;
}

Json EndForm::schema() { return number_schema(kEndSpec); }

}  // namespace noli
