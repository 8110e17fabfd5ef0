// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Quantities with units: "5 MPa", "9.81 m/s^2", "45 deg".

#include <string>
#include <string_view>
#include <variant>

namespace noli {

/// Exponents of metre, kilogram, second and degree; scenes count angles in degrees.
struct Dimension {
    int length = 0;
    int mass = 0;
    int time = 0;
    int angle = 0;
    friend bool operator==(const Dimension&, const Dimension&) = default;
};

inline constexpr Dimension kPlainNumber{};
inline constexpr Dimension kLength{.length = 1};
inline constexpr Dimension kTime{.time = 1};
inline constexpr Dimension kRate{.time = -1};
inline constexpr Dimension kSpeed{.length = 1, .time = -1};
inline constexpr Dimension kAcceleration{.length = 1, .time = -2};
inline constexpr Dimension kForce{.length = 1, .mass = 1, .time = -2};
inline constexpr Dimension kPressure{.length = -1, .mass = 1, .time = -2};
inline constexpr Dimension kDensity{.length = -3, .mass = 1};
inline constexpr Dimension kAngle{.angle = 1};
inline constexpr Dimension kAngularSpeed{.time = -1, .angle = 1};
inline constexpr Dimension kBarrierStiffness{.length = -2, .mass = 1, .time = -2};

/// "a pressure", "a length", ... or "a quantity in kg m^2".
std::string dimension_name(const Dimension& dimension);

/// The unit of a plain number: "Pa", "m", "deg/s", ...; empty for plain numbers.
std::string dimension_unit(const Dimension& dimension);

/// A quantity as one would write it, for messages: "5 MPa", "2 mm", ...; empty for plain
/// numbers.
std::string dimension_example(const Dimension& dimension);

/// The value in SI (angles in degrees) of "number unit", or what is wrong with it: what
/// was found, what was expected, a cure. Units multiply with "*" or a space, divide with
/// "/", and take powers as in "m^2". The result of a conversion by a power of ten is
/// correctly rounded.
std::variant<double, std::string> parse_quantity(std::string_view text,
                                                 const Dimension& expected);

}  // namespace noli
