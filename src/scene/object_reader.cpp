// SPDX-License-Identifier: Apache-2.0
/// The keys of one JSON object; what stands under a key is read by read_value.cpp.
#include "scene/object_reader.hpp"

#include "scene/suggest.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace noli {

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
