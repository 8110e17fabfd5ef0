// SPDX-License-Identifier: Apache-2.0
#pragma once
/// JSON text <-> tree, stricter and more readable than a general library offers.

#include "noli/result.hpp"

#include <nlohmann/json.hpp>
#include <string>

namespace noli {

/// Objects keep the order of their keys.
using Json = nlohmann::ordered_json;

/// Parses JSON; `//` and `/* */` comments are allowed. Refuses a key that appears twice
/// in one object (where = "file:/pointer") and bad syntax (where = "file:line:column").
Result<Json> parse_json(const std::string& text, const std::string& file);

/// JSON text with the shortest numbers that read back as the same doubles; what fits on a
/// line of 100 characters stays on one line. No newline at the end.
std::string print_json(const Json& value);

/// `key` as part of a JSON pointer: "~" and "/" escaped.
std::string escape_pointer(const std::string& key);

}  // namespace noli
