// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Builds the JSON Schema of one object key by key; see field_spec.hpp for the idea.

#include "noli/scene.hpp"

#include "scene/field_spec.hpp"
#include "scene/json_text.hpp"

#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace noli {

/// Schema of a number within its bounds, or of text with a unit where the number has one.
Json number_schema(const NumberSpec& spec);
Json integer_schema(const IntSpec& spec);
/// A list of exactly three numbers.
Json vector_schema(const NumberSpec& spec);
/// The schema with a description in front.
Json described_schema(const Json& schema, const std::string& doc);
/// A closed object: the keys of `properties` and no others.
Json object_schema(Json properties, const std::vector<std::string>& required = {});

class SchemaBuilder {
  public:
    void number(const char* key, double&, double fallback, const NumberSpec& spec) {
        Json schema = number_schema(spec);
        if (std::isfinite(fallback)) schema["default"] = fallback;
        add(key, schema, documented(spec));
    }
    void vector(const char* key,
                Vector3&,
                const Vector3& fallback,
                const NumberSpec& spec) {
        Json schema = vector_schema(spec);
        schema["default"] = fallback;
        add(key, schema, documented(spec));
    }
    void integer(const char* key, int&, int fallback, const IntSpec& spec) {
        Json schema = integer_schema(spec);
        schema["default"] = fallback;
        add(key, schema, spec.doc);
    }
    void boolean(const char* key, bool&, bool fallback, const char* doc) {
        add(key, Json{{"type", "boolean"}, {"default", fallback}}, doc);
    }
    void text(const char* key, std::string&, const std::string&, const char* doc) {
        add(key, Json{{"type", "string"}}, doc);
    }
    void numbers(const char* key, std::vector<double>&, const NumberSpec& spec) {
        add(key, list_of(number_schema(spec)), documented(spec));
    }
    void integers(const char* key, std::vector<int>&, const IntSpec& spec) {
        add(key, list_of(integer_schema(spec)), spec.doc);
    }
    void texts(const char* key,
               std::vector<std::string>&,
               const std::vector<std::string>& fallback,
               const std::vector<std::string>& allowed,
               const char* doc) {
        Json schema = list_of(Json{{"enum", allowed}});
        schema["uniqueItems"] = true;
        schema["default"] = fallback;
        add(key, schema, doc);
    }
    void files(const char* key, std::vector<std::string>&, const char* doc) {
        add(key, list_of(Json{{"type", "string"}, {"minLength", 1}}), doc);
    }
    void scaled(const char* key,
                double& value,
                bool& absolute,
                double fallback,
                const NumberSpec& spec);

    template <class E>
    void choice(const char* key,
                E&,
                E fallback,
                std::span<const Choice<E>> choices,
                const char* doc) {
        Json schema;
        std::string text = std::string(doc) + " One of:";
        for (const Choice<E>& c : choices) {
            schema["enum"].push_back(c.name);
            if (c.value == fallback) schema["default"] = c.name;
            text += std::string(c.value == choices[0].value ? " " : "; ") + "\"" + c.name
                  + "\", " + c.doc;
        }
        add(key, schema, text + ".");
    }

    void maybe_number(const char* key, std::optional<double>&, const NumberSpec& spec) {
        add(key, number_schema(spec), documented(spec));
    }
    void maybe_vector(const char* key, std::optional<Vector3>&, const NumberSpec& spec) {
        add(key, vector_schema(spec), documented(spec));
    }
    void maybe_boolean(const char* key, std::optional<bool>&, const char* doc) {
        add(key, Json{{"type", "boolean"}}, doc);
    }

    template <class T>
    void object(const char* key, T&, const char* doc) {
        add(key, of<T>(), doc);
    }
    template <class T>
    void list(const char* key, std::vector<T>&, const char* doc) {
        add(key, list_of(of<T>()), doc);
    }
    /// Form::schema() is the whole schema of the key.
    template <class Form, class T>
    void form(const char* key, T&, const char* doc) {
        add(key, Form::schema(), doc);
    }

    void required(const char* key, const char*) { required_.emplace_back(key); }
    void only_if(bool, const char* why) { why_ = why; }
    void always() { why_ = ""; }
    void check(bool, const char*, const std::string&) {}

    [[nodiscard]] const Json& properties() const { return properties_; }
    [[nodiscard]] Json schema() const { return object_schema(properties_, required_); }

    template <class T>
    static Json of() {
        SchemaBuilder builder;
        T value{};
        visit_fields(builder, value);
        return builder.schema();
    }

  private:
    static Json list_of(const Json& items) {
        return Json{{"type", "array"}, {"items", items}};
    }
    static std::string documented(const NumberSpec& spec);
    void add(const char* key, const Json& schema, const std::string& doc);

    Json properties_ = Json::object();
    std::vector<std::string> required_;
    const char* why_ = "";
};

/// The JSON Schema (draft 2020-12) of scene files, as in docs/scene.schema.json.
std::string scene_schema();

}  // namespace noli
