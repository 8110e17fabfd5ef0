// SPDX-License-Identifier: Apache-2.0
#include "scene/schema_builder.hpp"

#include <cmath>
#include <fmt/format.h>

namespace noli {

Json number_schema(const NumberSpec& spec) {
    Json schema;
    if (spec.unit == kPlainNumber)
        schema["type"] = "number";
    else
        schema["type"] = {"number", "string"};
    if (std::isfinite(spec.above)) schema["exclusiveMinimum"] = spec.above;
    if (std::isfinite(spec.at_least)) schema["minimum"] = spec.at_least;
    if (std::isfinite(spec.below)) schema["exclusiveMaximum"] = spec.below;
    if (std::isfinite(spec.at_most)) schema["maximum"] = spec.at_most;
    return schema;
}

Json integer_schema(const IntSpec& spec) {
    Json schema{{"type", "integer"}};
    if (spec.at_least != INT_MIN) schema["minimum"] = spec.at_least;
    if (spec.at_most != INT_MAX) schema["maximum"] = spec.at_most;
    return schema;
}

Json vector_schema(const NumberSpec& spec) {
    return Json{{"type", "array"},
                {"items", number_schema(spec)},
                {"minItems", 3},
                {"maxItems", 3}};
}

Json described_schema(const Json& schema, const std::string& doc) {
    Json out{{"description", doc}};
    for (const auto& [key, value] : schema.items())
        out[key] = value;
    return out;
}

Json object_schema(Json properties, const std::vector<std::string>& required) {
    Json schema{{"type", "object"}, {"additionalProperties", false}};
    if (!required.empty()) schema["required"] = required;
    schema["properties"] = std::move(properties);
    return schema;
}

void SchemaBuilder::scaled(
    const char* key, double&, bool& absolute, double fallback, const NumberSpec& spec) {
    Json schema = number_schema(spec);
    schema["default"] = fallback;
    add(key,
        schema,
        fmt::format("{} A number is relative; text with a unit, such as \"{}\", or "
                    "\"{}_absolute\": true "
                    "makes it absolute, in {}.",
                    spec.doc,
                    dimension_example(spec.unit),
                    key,
                    dimension_unit(spec.unit)));
    boolean((std::string(key) + "_absolute").c_str(),
            absolute,
            false,
            fmt::format("Whether \"{}\" is in {} instead of relative.",
                        key,
                        dimension_unit(spec.unit))
                .c_str());
}

std::string SchemaBuilder::documented(const NumberSpec& spec) {
    if (spec.unit == kPlainNumber) return spec.doc;
    return fmt::format("{} Unit of a plain number: {}; or text such as \"{}\".",
                       spec.doc,
                       dimension_unit(spec.unit),
                       dimension_example(spec.unit));
}

void SchemaBuilder::add(const char* key, const Json& schema, const std::string& doc) {
    std::string text = doc;
    if (*why_ != '\0') text += fmt::format(" Only {}.", why_);
    properties_[key] = described_schema(schema, text);
}

}  // namespace noli
