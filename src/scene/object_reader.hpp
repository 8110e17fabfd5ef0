// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Reads one JSON object key by key; see field_spec.hpp for the idea.

#include "scene/field_spec.hpp"
#include "scene/read_context.hpp"
#include "scene/read_value.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace noli {

class ObjectReader {
  public:
    /// Complains if `json` is not an object; every key then counts as absent.
    ObjectReader(ReadContext& context, const Json& json, std::string pointer);

    void number(const char* key, double& value, double fallback, const NumberSpec& spec);
    void vector(const char* key,
                Vector3& value,
                const Vector3& fallback,
                const NumberSpec& spec);
    void integer(const char* key, int& value, int fallback, const IntSpec& spec);
    void boolean(const char* key, bool& value, bool fallback, const char* doc);
    void text(const char* key,
              std::string& value,
              const std::string& fallback,
              const char* doc);
    void numbers(const char* key, std::vector<double>& values, const NumberSpec& spec);
    void integers(const char* key, std::vector<int>& values, const IntSpec& spec);
    void texts(const char* key,
               std::vector<std::string>& values,
               const std::vector<std::string>& fallback,
               const std::vector<std::string>& allowed,
               const char* doc);
    void files(const char* key, std::vector<std::string>& values, const char* doc);

    /// A number that is relative, unless it has a unit or `<key>_absolute` is true.
    void scaled(const char* key,
                double& value,
                bool& absolute,
                double fallback,
                const NumberSpec& spec);

    template <class E>
    void choice(
        const char* key, E& value, E, std::span<const Choice<E>> choices, const char*) {
        std::vector<std::string> names;
        for (const Choice<E>& c : choices)
            names.emplace_back(c.name);
        const int index = choice_index(key, names);
        if (index >= 0) value = choices[static_cast<std::size_t>(index)].value;
    }

    void maybe_number(const char* key,
                      std::optional<double>& value,
                      const NumberSpec& spec) {
        const Json* json = take(key);
        if (json != nullptr) value = read_number(context_, *json, at(key), spec);
    }
    void maybe_vector(const char* key,
                      std::optional<Vector3>& value,
                      const NumberSpec& spec) {
        const Json* json = take(key);
        if (json != nullptr) value = read_vector(context_, *json, at(key), spec);
    }
    void maybe_boolean(const char* key, std::optional<bool>& value, const char* doc) {
        if (!has(key)) return void(take(key));
        bool found = false;
        boolean(key, found, false, doc);
        value = found;
    }

    template <class T>
    void object(const char* key, T& value, const char*) {
        const Json* json = take(key);
        if (json != nullptr) read_into(value, *json, at(key));
    }

    template <class T>
    void list(const char* key, std::vector<T>& items, const char*) {
        const Json* json = take(key);
        if (json == nullptr || !expect_array(key, *json)) return;
        for (std::size_t i = 0; i < json->size(); ++i)
            read_into(
                items.emplace_back(), (*json)[i], at(key) + "/" + std::to_string(i));
    }

    /// A key with a form of its own: Form::read(context, json, pointer, value).
    template <class Form, class T>
    void form(const char* key, T& value, const char*) {
        const Json* json = take(key);
        if (json != nullptr) Form::read(context_, *json, at(key), value);
    }

    /// The key must be there; `cure` says what to write.
    void required(const char* key, const char* cure);

    /// Until the next call, keys are accepted only if `used`; `why` completes "has a
    /// meaning only ...".
    void only_if(bool used, const char* why) {
        used_ = used;
        why_ = why;
    }
    void always() { used_ = true; }

    /// A rule between keys; `message` says what was found, what was expected, and a cure.
    void check(bool holds, const char* key, const std::string& message) {
        if (!holds) context_.fail(*key == '\0' ? pointer_ : at(key), message);
    }

    /// Complains about keys that nobody asked for.
    void finish();

    [[nodiscard]] bool has(const char* key) const;
    [[nodiscard]] std::string at(const std::string& key) const;
    [[nodiscard]] const std::string& pointer() const { return pointer_; }
    [[nodiscard]] ReadContext& context() { return context_; }
    /// The value of the key, or null; marks the key as known.
    const Json* take(const char* key);

  private:
    template <class T>
    void read_into(T& value, const Json& json, const std::string& pointer) {
        ObjectReader reader(context_, json, pointer);
        visit_fields(reader, value);
        reader.finish();
    }

    bool expect_array(const char* key, const Json& json);
    int choice_index(const char* key, const std::vector<std::string>& names);

    ReadContext& context_;
    const Json& json_;
    std::string pointer_;
    std::vector<std::string> known_;
    bool used_ = true;
    const char* why_ = "";
};

}  // namespace noli
