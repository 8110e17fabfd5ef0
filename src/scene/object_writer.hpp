// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Writes one JSON object key by key, leaving out defaults; see field_spec.hpp for the
/// idea.

#include "noli/scene.hpp"

#include "scene/field_spec.hpp"
#include "scene/json_text.hpp"

#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace noli {

class ObjectWriter {
  public:
    void number(const char* key, double& value, double fallback, const NumberSpec&) {
        if (!same_bits(value, fallback)) put(key, value);
    }
    void vector(const char* key,
                Vector3& value,
                const Vector3& fallback,
                const NumberSpec&) {
        bool same = true;
        for (std::size_t k = 0; k < 3; ++k)
            same = same && same_bits(value[k], fallback[k]);
        if (!same) put(key, value);
    }
    void integer(const char* key, int& value, int fallback, const IntSpec&) {
        if (value != fallback) put(key, value);
    }
    void boolean(const char* key, bool& value, bool fallback, const char*) {
        if (value != fallback) put(key, value);
    }
    void text(const char* key,
              std::string& value,
              const std::string& fallback,
              const char*) {
        if (value != fallback) put(key, value);
    }
    void numbers(const char* key, std::vector<double>& values, const NumberSpec&) {
        if (!values.empty()) put(key, values);
    }
    void integers(const char* key, std::vector<int>& values, const IntSpec&) {
        if (!values.empty()) put(key, values);
    }
    void texts(const char* key,
               std::vector<std::string>& values,
               const std::vector<std::string>& fallback,
               const std::vector<std::string>&,
               const char*) {
        if (values != fallback) put(key, values);
    }
    void files(const char* key, std::vector<std::string>& values, const char*) {
        if (!values.empty()) put(key, values);
    }
    void scaled(const char* key,
                double& value,
                bool& absolute,
                double fallback,
                const NumberSpec& spec) {
        number(key, value, fallback, spec);
        boolean((std::string(key) + "_absolute").c_str(), absolute, false, "");
    }

    template <class E>
    void choice(const char* key,
                E& value,
                E fallback,
                std::span<const Choice<E>> choices,
                const char*) {
        for (const Choice<E>& c : choices)
            if (c.value == value && value != fallback) put(key, c.name);
    }

    void maybe_number(const char* key, std::optional<double>& value, const NumberSpec&) {
        if (value) put(key, *value);
    }
    void maybe_vector(const char* key, std::optional<Vector3>& value, const NumberSpec&) {
        if (value) put(key, *value);
    }
    void maybe_boolean(const char* key, std::optional<bool>& value, const char*) {
        if (value) put(key, *value);
    }

    template <class T>
    void object(const char* key, T& value, const char*) {
        Json child = to_json(value);
        if (!child.empty()) put(key, std::move(child));
    }

    template <class T>
    void list(const char* key, std::vector<T>& items, const char*) {
        Json array = Json::array();
        for (T& item : items)
            array.push_back(to_json(item));
        if (!array.empty()) put(key, std::move(array));
    }

    /// Form::write(value) gives JSON, or null for what needs no writing.
    template <class Form, class T>
    void form(const char* key, T& value, const char*) {
        Json child = Form::write(value);
        if (!child.is_null()) put(key, std::move(child));
    }

    void required(const char*, const char*) {}
    void only_if(bool used, const char*) { used_ = used; }
    void always() { used_ = true; }
    void check(bool, const char*, const std::string&) {}

    [[nodiscard]] const Json& json() const { return json_; }

    template <class T>
    static Json to_json(T& value) {
        ObjectWriter writer;
        visit_fields(writer, value);
        return writer.json();
    }

  private:
    void put(const char* key, Json value) {
        if (used_) json_[key] = std::move(value);
    }
    /// -0 and 0 differ: reading back must give the same bits.
    static bool same_bits(double a, double b) {
        return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
    }

    Json json_ = Json::object();
    bool used_ = true;  ///< whether the keys of this place have a meaning (only_if)
};

}  // namespace noli
