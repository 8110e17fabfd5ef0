// SPDX-License-Identifier: Apache-2.0
/// Numbers, vectors and file names of a scene; the words for what was found there and for
/// what was expected.

#include "scene/read_value.hpp"

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
    double number = std::nan("");  // what is no number fails with what is out of bounds
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
    }
    if (std::isfinite(number) && spec.allows(number)) return number;
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

}  // namespace noli
