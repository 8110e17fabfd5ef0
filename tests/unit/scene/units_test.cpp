// SPDX-License-Identifier: Apache-2.0
#include "scene/units.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace noli {
namespace {

struct Quantity {
    const char* text;
    Dimension dimension;
    double si;
};

TEST(ParseQuantity, ConvertsToSiWithoutRoundingError) {
    const Quantity table[] = {
        {"5 MPa", kPressure, 5e6},
        {"5MPa", kPressure, 5e6},
        {" 2.5 kPa ", kPressure, 2500},
        {"1 bar", kPressure, 1e5},
        {"3 N/m^2", kPressure, 3},
        {"7 N/mm^2", kPressure, 7e6},
        {"2 mm", kLength, 0.002},
        {"7 mm", kLength, 0.007},
        {"-3.5 cm", kLength, -0.035},
        {"1 in", kLength, 0.0254},
        {"1 ft", kLength, 0.3048},
        {"250 um", kLength, 250e-6},
        {"250 \u00b5m", kLength, 250e-6},
        {"10 ms", kTime, 0.01},
        {"2 min", kTime, 120},
        {"1 h", kTime, 3600},
        {"9.81 m/s^2", kAcceleration, 9.81},
        {"981 cm/s^2", kAcceleration, 9.81},
        {"9.81 m s^-2", kAcceleration, 9.81},
        {"9.81 m/s/s", kAcceleration, 9.81},
        {"0.3 kg/m^3", kDensity, 0.3},
        {"1.1 g/cm^3", kDensity, 1100},
        {"36 km/h", kSpeed, 10},
        {"3 kN", kForce, 3000},
        {"2 kg*m/s^2", kForce, 2},
        {"45 deg", kAngle, 45},
        {"90 \u00b0", kAngle, 90},
        {"0.25 rev", kAngle, 90},
        {"10 rpm", kAngularSpeed, 60},
        {"90 deg/s", kAngularSpeed, 90},
        {"5 Hz", kRate, 5},
        {"5 1/s", kRate, 5},
        {"1e6 J/m^4", kBarrierStiffness, 1e6},
        {"40 %", kPlainNumber, 0.4},
        {"+1e-3 m", kLength, 1e-3},
    };
    for (const Quantity& q : table) {
        const auto parsed = parse_quantity(q.text, q.dimension);
        ASSERT_TRUE(std::holds_alternative<double>(parsed))
            << q.text << ": " << std::get<std::string>(parsed);
        EXPECT_EQ(std::get<double>(parsed), q.si) << q.text;
    }
}

TEST(ParseQuantity, ConvertsRadiansToDegrees) {
    EXPECT_DOUBLE_EQ(std::get<double>(parse_quantity("3.141592653589793 rad", kAngle)),
                     180.0);
    EXPECT_DOUBLE_EQ(std::get<double>(parse_quantity("1 rad/s", kAngularSpeed)),
                     180.0 / std::numbers::pi);
}

TEST(ParseQuantity, NamesWhatIsWrong) {
    struct Bad {
        const char* text;
        Dimension dimension;
        const char* parts[3];
    };
    const Bad table[] = {
        {"2 mm", kPressure, {"a length", "a pressure", "5 MPa"}},
        {"5 MPa", kLength, {"a pressure", "a length", "2 mm"}},
        {"5", kPressure, {"without a unit", "a pressure", "leave out the quotes"}},
        {"5 MPaa",
         kPressure,
         {"unknown unit \"MPaa\"", "did you mean \"MPa\"", "a pressure"}},
        {"abc", kTime, {"\"abc\"", "a time", "10 ms"}},
        {"", kTime, {"\"\"", "a time", ""}},
        {"5 m^x", kLength, {"power of \"m\"", "a length", ""}},
        {"5 m^99", kLength, {"power of \"m\"", "", ""}},
        {"5 m/", kLength, {"ends after an operator", "", ""}},
        {"5 m$", kLength, {"\"$\"", "unit should start", ""}},
        {"1e308 km", kLength, {"too large", "", ""}},
        {"inf m", kLength, {"\"inf m\"", "a length", ""}},
        {"nan m", kLength, {"\"nan m\"", "a length", ""}},
        {"3 kg", kPlainNumber, {"a mass", "plain number", ""}},
        {"3 kg m^2", kForce, {"kg m^2", "a force", ""}},
        {"5 MPa 3", kPressure, {"where a unit should start", "", ""}},
    };
    for (const Bad& bad : table) {
        const auto parsed = parse_quantity(bad.text, bad.dimension);
        ASSERT_TRUE(std::holds_alternative<std::string>(parsed)) << bad.text;
        for (const char* part : bad.parts)
            EXPECT_NE(std::get<std::string>(parsed).find(part), std::string::npos)
                << bad.text << " -> " << std::get<std::string>(parsed) << " lacks "
                << part;
    }
}

TEST(Dimension, ExamplesReadBack) {
    for (const Dimension& d : {kLength,
                               kTime,
                               kRate,
                               kSpeed,
                               kAcceleration,
                               kForce,
                               kPressure,
                               kDensity,
                               kAngle,
                               kAngularSpeed,
                               kBarrierStiffness}) {
        EXPECT_TRUE(
            std::holds_alternative<double>(parse_quantity(dimension_example(d), d)))
            << dimension_example(d);
        EXPECT_EQ(std::get<double>(parse_quantity("1 " + dimension_unit(d), d)), 1.0)
            << dimension_unit(d);
    }
}

}  // namespace
}  // namespace noli
