// SPDX-License-Identifier: Apache-2.0
/// Forms of boundary conditions, grids and names; those of placement and material are in
/// forms.cpp.
#include "scene/choices.hpp"
#include "scene/forms.hpp"
#include "scene/object_reader.hpp"
#include "scene/object_writer.hpp"
#include "scene/schema_builder.hpp"

#include <array>
#include <fmt/format.h>
#include <optional>

namespace noli {

// ── select
// ─────────────────────────────────────────────────────────────────────────────────────

namespace {

constexpr std::array kFrames{
    Choice{Selection::Frame::MeshBox,
           "mesh_box",
           "in units of the bounding box of the mesh before its transform, 0 to 1"},
    Choice{Selection::Frame::World, "world", "in metres, in the placement at the start"}};
constexpr const char* kSurfaceDoc = "Only vertices of the surface.";
constexpr const char* kBoxDoc =
    "Opposite corners [[x, y, z], [x, y, z]], inclusive, of the box that holds the "
    "vertices.";
constexpr const char* kVerticesDoc =
    "Numbers of vertices, from 0, in the order of the mesh file.";
constexpr IntSpec kVertexSpec{.at_least = 0, .doc = kVerticesDoc};

void read_box(ReadContext& context,
              const Json& json,
              const std::string& pointer,
              Selection& selection) {
    if (!json.is_array() || json.size() != 2) {
        context.fail(
            pointer,
            fmt::format("found {}, expected two corners; write [[x, y, z], [x, y, z]]",
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
            context.fail(
                pointer,
                fmt::format(
                    "found an empty box: {} > {} along {}, expected the smaller corner "
                    "first; exchange the two",
                    (*low)[k],
                    (*high)[k],
                    "xyz"[k]));
            return;
        }
}

}  // namespace

void SelectForm::read(ReadContext& context,
                      const Json& json,
                      const std::string& pointer,
                      Selection& selection) {
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
        context.fail(
            pointer,
            fmt::format(
                "found {} \"box\" {} \"vertices\", expected one of the two; {} one",
                has_box ? "both" : "neither",
                has_box ? "and" : "nor",
                has_box ? "remove" : "add"));
    else if (has_vertices && selection.vertices.empty())
        context.fail(reader.at("vertices"),
                     "found no vertices, expected at least one; list them, or leave out "
                     "\"select\" for all");
}

Json SelectForm::write(const Selection& selection) {
    Json json;
    if (selection.kind == Selection::Kind::Vertices)
        json["vertices"] = selection.vertices;
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
    builder.choice("frame",
                   none.frame,
                   Selection::Frame::MeshBox,
                   all(kFrames),
                   "What the numbers of the box mean.");
    builder.boolean("surface_only", none.surface_only, false, kSurfaceDoc);
    builder.always();
    Json properties = builder.properties();
    const Json corner = vector_schema({.unit = kLength});
    properties["box"] = Json{{"description", kBoxDoc},
                             {"type", "array"},
                             {"items", corner},
                             {"minItems", 2},
                             {"maxItems", 2}};
    properties["vertices"] = Json{{"description", kVerticesDoc},
                                  {"type", "array"},
                                  {"items", integer_schema(kVertexSpec)},
                                  {"minItems", 1}};
    return Json{{"anyOf", {Json{{"const", "all"}}, object_schema(properties)}}};
}

// ── until
// ──────────────────────────────────────────────────────────────────────────────────────

namespace {

using Until = BoundaryCondition::Until;
constexpr std::array kSubjects{
    Choice{Until::Subject::Body, "body", "all vertices of the body"},
    Choice{Until::Subject::Selection, "selection", "the selected vertices"}};
constexpr std::array kAxes{Choice{0, "x", "x"}, Choice{1, "y", "y"}, Choice{2, "z", "z"}};
constexpr std::array kThen{Choice{false, "release", "the vertices are free"},
                           Choice{true, "hold", "they stay where they are"}};
constexpr NumberSpec kAboveSpec{.unit = kLength,
                                .doc = "Beyond means at this coordinate or more."};
constexpr NumberSpec kBelowSpec{.unit = kLength,
                                .doc = "Beyond means at this coordinate or less."};

template <class V>
void visit_until(V& v,
                 Until& until,
                 std::optional<double>& above,
                 std::optional<double>& below) {
    v.choice("subject",
             until.subject,
             Until::Subject::Body,
             all(kSubjects),
             "Which vertices must be beyond.");
    v.required("axis", "write \"x\", \"y\" or \"z\"");
    v.choice("axis", until.axis, -1, all(kAxes), "Direction.");
    v.maybe_number("above", above, kAboveSpec);
    v.maybe_number("below", below, kBelowSpec);
    v.choice("then", until.then_hold, false, all(kThen), "What happens afterwards.");
}

}  // namespace

void UntilForm::read(ReadContext& context,
                     const Json& json,
                     const std::string& pointer,
                     Value& value) {
    ObjectReader reader(context, json, pointer);
    Until until;
    std::optional<double> above, below;
    visit_until(reader, until, above, below);
    reader.finish();
    if (json.is_object() && reader.has("above") == reader.has("below"))
        context.fail(
            pointer,
            fmt::format("found {} of \"above\" and \"below\", expected one; {} one",
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

// ── grid, name, end
// ────────────────────────────────────────────────────────────────────────────

namespace {

constexpr IntSpec kCountSpec{.at_least = 1, .at_most = 100000};
constexpr NumberSpec kSpacingSpec{
    .unit = kLength, .doc = "Copy (i, j, k) is shifted by [i sx, j sy, k sz]."};

}  // namespace

void GridForm::read(ReadContext& context,
                    const Json& json,
                    const std::string& pointer,
                    Body& body) {
    ObjectReader reader(context, json, pointer);
    reader.required("count", "write \"count\": [nx, ny, nz]");
    std::vector<int> count;
    reader.integers("count", count, kCountSpec);
    reader.vector("spacing", body.grid_spacing, {}, kSpacingSpec);
    reader.finish();
    const bool listed = reader.has("count") && json.at("count").is_array();
    if (listed && json.at("count").size() != 3)
        context.fail(reader.at("count"),
                     fmt::format("found {}, expected three numbers; write [nx, ny, nz]",
                                 found_value(json.at("count"))));
    if (count.size() != 3) return;
    for (std::size_t k = 0; k < 3; ++k) {
        body.grid[k] = count[k];
        if (count[k] > 1 && body.grid_spacing[k] == 0.0)
            context.fail(
                reader.at("spacing"),
                fmt::format("found a spacing of 0 along {}, where there are {} copies, "
                            "expected a distance; they would lie on each other",
                            "xyz"[k],
                            count[k]));
    }
}

Json GridForm::write(const Body& body) {
    if (body.grid == std::array{1, 1, 1} && body.grid_spacing == Vector3{}) return {};
    return Json{{"count", body.grid}, {"spacing", body.grid_spacing}};
}

Json GridForm::schema() {
    Json properties;
    properties["count"] = Json{{"description", "Copies along x, y, z."},
                               {"type", "array"},
                               {"items", integer_schema(kCountSpec)},
                               {"minItems", 3},
                               {"maxItems", 3}};
    properties["spacing"] =
        described_schema(vector_schema(kSpacingSpec), kSpacingSpec.doc);
    return object_schema(properties, {"count"});
}

void NameForm::read(ReadContext& context,
                    const Json& json,
                    const std::string& pointer,
                    std::string& name) {
    if (!json.is_string()) {
        context.fail(pointer,
                     fmt::format("found {}, expected a name; put it in quotes",
                                 found_value(json)));
        return;
    }
    name = json.get<std::string>();
    if (name == "*" || name.find('[') != std::string::npos)
        context.fail(pointer,
                     fmt::format("found the name \"{}\", expected one without \"*\" and "
                                 "\"[\", which have a "
                                 "meaning in contact pairs; choose another",
                                 name));
}

void TitleForm::read(ReadContext& context,
                     const Json& json,
                     const std::string& pointer,
                     std::string& text) {
    if (json.is_string())
        text = json.get<std::string>();
    else
        context.fail(
            pointer,
            fmt::format("found {}, expected text; put it in quotes", found_value(json)));
}

namespace {
constexpr NumberSpec kEndSpec{.unit = kTime, .above = 0};
}

void EndForm::read(ReadContext& context,
                   const Json& json,
                   const std::string& pointer,
                   double& time) {
    if (const auto number = read_number(context, json, pointer, kEndSpec)) time = *number;
}

Json EndForm::schema() {
    return number_schema(kEndSpec);
}

}  // namespace noli
