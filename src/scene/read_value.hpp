// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Reads one JSON value that a scene holds under some key, and complains where it is not
/// what the key's specification allows. object_reader.hpp finds the values.

#include "noli/scene.hpp"

#include "scene/field_spec.hpp"
#include "scene/read_context.hpp"

#include <optional>
#include <string>

namespace noli {

/// A number within its bounds, given plainly or as text with a unit. Complains and
/// returns nothing otherwise. `used_unit` tells whether it was text.
std::optional<double> read_number(ReadContext& context,
                                  const Json& value,
                                  const std::string& pointer,
                                  const NumberSpec& spec,
                                  bool* used_unit = nullptr);

std::optional<int> read_integer(ReadContext& context,
                                const Json& value,
                                const std::string& pointer,
                                const IntSpec& spec);

std::optional<Vector3> read_vector(ReadContext& context,
                                   const Json& value,
                                   const std::string& pointer,
                                   const NumberSpec& spec);

/// The path of a file that a scene names; complains if there is none.
bool check_file(ReadContext& context,
                const std::string& path,
                const std::string& pointer);

}  // namespace noli
