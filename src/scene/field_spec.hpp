// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What a key of a scene may hold. One description per key (scene_fields.hpp) serves the
/// reader, the writer and the JSON Schema; the three visitors are ObjectReader,
/// ObjectWriter, SchemaBuilder.
///
/// A description is a function template  visit_fields(V& v, T& value)  that calls, for
/// every key,
///
///     v.number("young", m.young, d.young, {.unit = kPressure, .above = 0, .doc =
///     "..."});
///
/// with the place of the value, its default and its specification. The reader stores what
/// it finds, the writer writes what differs from the default, the schema builder notes
/// key and specification.

#include "scene/units.hpp"

#include <climits>
#include <limits>
#include <string>

namespace noli {

inline constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// A number or, where it has a unit, a string like "5 MPa". `above` and `below` exclude
/// the bound.
struct NumberSpec {
    Dimension unit = kPlainNumber;
    double above = -kUnbounded;
    double at_least = -kUnbounded;
    double below = kUnbounded;
    double at_most = kUnbounded;
    const char* doc = "";

    [[nodiscard]] bool allows(double x) const {
        return x > above && x >= at_least && x < below && x <= at_most;
    }
};

struct IntSpec {
    int at_least = INT_MIN;
    int at_most = INT_MAX;
    const char* doc = "";
};

/// A named value of an enumeration.
template <class E>
struct Choice {
    E value;
    const char* name;
    const char* doc;
};

template <class E>
Choice(E, const char*, const char*) -> Choice<E>;

/// "a pressure > 0 in Pa", "a plain number > -1 and < 0.5".
std::string expected_number(const NumberSpec& spec);

/// "a whole number >= 1".
std::string expected_integer(const IntSpec& spec);

}  // namespace noli
