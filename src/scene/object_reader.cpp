// SPDX-License-Identifier: Apache-2.0
#include "scene/object_reader.hpp"

#include "mesh/source.hpp"
#include "scene/suggest.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>

namespace noli {

namespace {

/// "; write for example 1000 or "1.1 g/cm^3"", if the default of the key is known.
std::string number_cure(const NumberSpec& spec) {
    const std::string example = dimension_example(spec.unit);
    return example.empty()
             ? "; correct the number"
             : fmt::format("; correct the number, or write one like \"{}\"", example);
}

}  // namespace

std::string found_value(const Json& value) {
    if (value.is_string()) return "\"" + value.get<std::string>() + "\"";
    if (value.is_object()) return "an object";
    if (value.is_array()) return fmt::format("a list of {}", value.size());
    if (value.is_number_float()) return fmt::format("{}", value.get<double>());
    return value.dump();
}

std::string expected_number(const NumberSpec& spec) {
    std::string text = spec.unit == kPlainNumber ? "a number" : dimension_name(spec.unit);
    std::string bounds;
    const auto add = [&](const char* relation, double bound) {
        if (std::isfinite(bound))
            bounds +=
                fmt::format("{}{} {}", bounds.empty() ? " " : " and ", relation, bound);
    };
    add(">", spec.above);
    add(">=", spec.at_least);
    add("<", spec.below);
    add("<=", spec.at_most);
    text += bounds;
    if (spec.unit != kPlainNumber) text += " in " + dimension_unit(spec.unit);
    return text;
}

std::string expected_integer(const IntSpec& spec) {
    std::string text = "a whole number";
    if (spec.at_least != INT_MIN) text += fmt::format(" >= {}", spec.at_least);
    if (spec.at_most != INT_MAX)
        text +=
            fmt::format("{} <= {}", spec.at_least != INT_MIN ? " and" : "", spec.at_most);
    return text;
}

std::optional<double> read_number(ReadContext& context,
                                  const Json& value,
                                  const std::string& pointer,
                                  const NumberSpec& spec,
                                  bool* used_unit) {
    double number = 0.0;
    if (used_unit != nullptr) *used_unit = value.is_string();
    if (value.is_string()) {
        const auto parsed = parse_quantity(value.get<std::string>(), spec.unit);
        if (const auto* problem = std::get_if<std::string>(&parsed)) {
            context.fail(pointer, *problem);
            return std::nullopt;
        }
        number = std::get<double>(parsed);
    } else if (value.is_number()) {
        number = value.get<double>();
    } else {
        context.fail(pointer,
                     fmt::format("found {}, expected {}{}",
                                 found_value(value),
                                 expected_number(spec),
                                 number_cure(spec)));
        return std::nullopt;
    }
    if (spec.allows(number) && std::isfinite(number)) return number;
    context.fail(pointer,
                 fmt::format("found {}, expected {}{}",
                             found_value(value),
                             expected_number(spec),
                             number_cure(spec)));
    return std::nullopt;
}

std::optional<int> read_integer(ReadContext& context,
                                const Json& value,
                                const std::string& pointer,
                                const IntSpec& spec) {
    const double number = value.is_number() ? value.get<double>() : std::nan("");
    if (std::floor(number) == number && number >= spec.at_least && number <= spec.at_most)
        return static_cast<int>(number);
    context.fail(pointer,
                 fmt::format("found {}, expected {}; correct the number",
                             found_value(value),
                             expected_integer(spec)));
    return std::nullopt;
}

std::optional<Vector3> read_vector(ReadContext& context,
                                   const Json& value,
                                   const std::string& pointer,
                                   const NumberSpec& spec) {
    if (!value.is_array() || value.size() != 3) {
        context.fail(
            pointer,
            fmt::format("found {}, expected a list of 3, each {}; write [x, y, z]",
                        found_value(value),
                        expected_number(spec)));
        return std::nullopt;
    }
    Vector3 vector{};
    for (std::size_t k = 0; k < 3; ++k) {
        const auto number =
            read_number(context, value[k], pointer + "/" + std::to_string(k), spec);
        if (!number) return std::nullopt;
        vector[k] = *number;
    }
    return vector;
}

bool check_file(ReadContext& context,
                const std::string& path,
                const std::string& pointer) {
    namespace fs = std::filesystem;
    if (path.empty()) {
        context.fail(pointer,
                     "found an empty file name, expected a mesh file; write its name");
        return false;
    }
    const std::string full = resolve_path(path, context.base_folder);
    if (mesh_file_exists(full)) return true;
    std::vector<std::string> siblings;
    std::error_code ec;
    for (const auto& entry : fs::directory_iterator(fs::path(full).parent_path(), ec))
        siblings.push_back(entry.path().filename().string());
    std::sort(siblings.begin(), siblings.end());
    context.fail(
        pointer,
        fmt::format(
            "found no file \"{}\" (looked for {}), expected a mesh file{}; correct the "
            "name or put the file there",
            path,
            full,
            did_you_mean(fs::path(full).filename().string(), siblings)),
        Error::Code::FileNotReadable);
    return false;
}

ObjectReader::ObjectReader(ReadContext& context, const Json& json, std::string pointer)
    : context_(context), json_(json), pointer_(std::move(pointer)) {
    if (!json_.is_object())
        context_.fail(pointer_,
                      fmt::format("found {}, expected an object; write {{ ... }}",
                                  found_value(json_)));
}

bool ObjectReader::has(const char* key) const {
    return json_.is_object() && json_.contains(key);
}

std::string ObjectReader::at(const std::string& key) const {
    return pointer_ + "/" + escape_pointer(key);
}

const Json* ObjectReader::take(const char* key) {
    known_.emplace_back(key);
    if (!has(key)) return nullptr;
    if (used_) return &json_.at(key);
    context_.fail(
        at(key),
        fmt::format(
            "found the key \"{}\", which has a meaning only {}; remove it", key, why_));
    return nullptr;
}

void ObjectReader::finish() {
    if (!json_.is_object()) return;
    for (const auto& [key, value] : json_.items()) {
        if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
        context_.fail(at(key),
                      fmt::format("found the unknown key \"{}\", expected {}{}",
                                  key,
                                  quoted_list(known_),
                                  did_you_mean(key, known_)));
    }
}

void ObjectReader::required(const char* key, const char* cure) {
    if (json_.is_object() && !has(key))
        context_.fail(pointer_,
                      fmt::format("found no key \"{}\", expected one; {}", key, cure));
}

bool ObjectReader::expect_array(const char* key, const Json& json) {
    if (json.is_array()) return true;
    context_.fail(
        at(key),
        fmt::format("found {}, expected a list; write [ ... ]", found_value(json)));
    return false;
}

int ObjectReader::choice_index(const char* key, const std::vector<std::string>& names) {
    const Json* json = take(key);
    if (json == nullptr) return -1;
    const std::string word = json->is_string() ? json->get<std::string>() : "";
    const auto found = std::find(names.begin(), names.end(), word);
    if (json->is_string() && found != names.end())
        return static_cast<int>(found - names.begin());
    context_.fail(
        at(key),
        fmt::format("found {}, expected {}{}",
                    found_value(*json),
                    quoted_list(names),
                    json->is_string() ? did_you_mean(word, names) : "; choose one"));
    return -1;
}

void ObjectReader::number(const char* key,
                          double& value,
                          double,
                          const NumberSpec& spec) {
    const Json* json = take(key);
    if (json == nullptr) return;
    if (const auto number = read_number(context_, *json, at(key), spec)) value = *number;
}

void ObjectReader::vector(const char* key,
                          Vector3& value,
                          const Vector3&,
                          const NumberSpec& spec) {
    const Json* json = take(key);
    if (json == nullptr) return;
    if (const auto vector = read_vector(context_, *json, at(key), spec)) value = *vector;
}

void ObjectReader::integer(const char* key, int& value, int, const IntSpec& spec) {
    const Json* json = take(key);
    if (json == nullptr) return;
    if (const auto number = read_integer(context_, *json, at(key), spec)) value = *number;
}

void ObjectReader::boolean(const char* key, bool& value, bool, const char*) {
    const Json* json = take(key);
    if (json == nullptr) return;
    if (json->is_boolean())
        value = json->get<bool>();
    else
        context_.fail(at(key),
                      fmt::format("found {}, expected true or false; write one of them "
                                  "without quotes",
                                  found_value(*json)));
}

void ObjectReader::text(const char* key,
                        std::string& value,
                        const std::string&,
                        const char*) {
    const Json* json = take(key);
    if (json == nullptr) return;
    if (json->is_string())
        value = json->get<std::string>();
    else
        context_.fail(
            at(key),
            fmt::format("found {}, expected text; put it in quotes", found_value(*json)));
}

void ObjectReader::numbers(const char* key,
                           std::vector<double>& values,
                           const NumberSpec& spec) {
    const Json* json = take(key);
    if (json == nullptr || !expect_array(key, *json)) return;
    for (std::size_t i = 0; i < json->size(); ++i)
        if (const auto number = read_number(
                context_, (*json)[i], at(key) + "/" + std::to_string(i), spec))
            values.push_back(*number);
}

void ObjectReader::integers(const char* key,
                            std::vector<int>& values,
                            const IntSpec& spec) {
    const Json* json = take(key);
    if (json == nullptr || !expect_array(key, *json)) return;
    for (std::size_t i = 0; i < json->size(); ++i)
        if (const auto number = read_integer(
                context_, (*json)[i], at(key) + "/" + std::to_string(i), spec))
            values.push_back(*number);
}

void ObjectReader::texts(const char* key,
                         std::vector<std::string>& values,
                         const std::vector<std::string>&,
                         const std::vector<std::string>& allowed,
                         const char*) {
    const Json* json = take(key);
    if (json == nullptr || !expect_array(key, *json)) return;
    values.clear();
    for (std::size_t i = 0; i < json->size(); ++i) {
        const Json& item = (*json)[i];
        const std::string word = item.is_string() ? item.get<std::string>() : "";
        const bool known =
            std::find(allowed.begin(), allowed.end(), word) != allowed.end();
        const bool repeated =
            std::find(values.begin(), values.end(), word) != values.end();
        if (known && !repeated) {
            values.push_back(word);
            continue;
        }
        context_.fail(
            at(key) + "/" + std::to_string(i),
            fmt::format("found {}{}, expected {}{}",
                        found_value(item),
                        repeated ? " for the second time" : "",
                        quoted_list(allowed),
                        repeated ? "; remove it" : did_you_mean(word, allowed)));
    }
}

void ObjectReader::files(const char* key, std::vector<std::string>& values, const char*) {
    const Json* json = take(key);
    if (json == nullptr || !expect_array(key, *json)) return;
    for (std::size_t i = 0; i < json->size(); ++i) {
        const std::string place = at(key) + "/" + std::to_string(i);
        if (!(*json)[i].is_string()) {
            context_.fail(
                place,
                fmt::format("found {}, expected the name of a mesh file; put it in "
                            "quotes",
                            found_value((*json)[i])));
            continue;
        }
        const std::string path = (*json)[i].get<std::string>();
        if (check_file(context_, path, place)) values.push_back(path);
    }
}

void ObjectReader::scaled(
    const char* key, double& value, bool& absolute, double, const NumberSpec& spec) {
    const std::string flag = std::string(key) + "_absolute";
    bool has_unit = false;
    if (const Json* json = take(key)) {
        NumberSpec plain = spec;
        if (!json->is_string()) plain.unit = kPlainNumber;
        if (const auto number = read_number(context_, *json, at(key), plain, &has_unit))
            value = *number;
    }
    const bool contradicted =
        has_unit && has(flag.c_str()) && json_.at(flag) == Json(false);
    boolean(flag.c_str(), absolute, false, "");
    if (contradicted)
        context_.fail(
            at(flag),
            fmt::format("found false although \"{}\" has a unit, expected true; "
                        "remove this key or the unit",
                        key));
    if (has_unit) absolute = true;
}

}  // namespace noli
