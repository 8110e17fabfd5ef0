// SPDX-License-Identifier: Apache-2.0
#include "scene/units.hpp"

#include "scene/suggest.hpp"

#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <optional>
#include <vector>

namespace noli {

namespace {

/// One unit is num / den SI units; two whole numbers keep decimal prefixes free of
/// rounding.
struct Unit {
    const char* symbol;
    Dimension dimension;
    double num = 1.0;
    double den = 1.0;
};

constexpr Dimension kMass{.mass = 1};
constexpr Dimension kEnergy{.length = 2, .mass = 1, .time = -2};
constexpr Dimension kPower{.length = 2, .mass = 1, .time = -3};
constexpr double kDegPerRad = 180.0 / std::numbers::pi;

constexpr std::array kUnits{
    Unit{"m", kLength},
    Unit{"km", kLength, 1e3},
    Unit{"dm", kLength, 1, 1e1},
    Unit{"cm", kLength, 1, 1e2},
    Unit{"mm", kLength, 1, 1e3},
    Unit{"um", kLength, 1, 1e6},
    Unit{"\u00b5m", kLength, 1, 1e6},
    Unit{"nm", kLength, 1, 1e9},
    Unit{"in", kLength, 254, 1e4},
    Unit{"ft", kLength, 3048, 1e4},
    Unit{"kg", kMass},
    Unit{"t", kMass, 1e3},
    Unit{"g", kMass, 1, 1e3},
    Unit{"mg", kMass, 1, 1e6},
    Unit{"s", kTime},
    Unit{"ms", kTime, 1, 1e3},
    Unit{"us", kTime, 1, 1e6},
    Unit{"\u00b5s", kTime, 1, 1e6},
    Unit{"min", kTime, 60},
    Unit{"h", kTime, 3600},
    Unit{"Hz", kRate},
    Unit{"N", kForce},
    Unit{"mN", kForce, 1, 1e3},
    Unit{"kN", kForce, 1e3},
    Unit{"MN", kForce, 1e6},
    Unit{"Pa", kPressure},
    Unit{"hPa", kPressure, 1e2},
    Unit{"kPa", kPressure, 1e3},
    Unit{"MPa", kPressure, 1e6},
    Unit{"GPa", kPressure, 1e9},
    Unit{"bar", kPressure, 1e5},
    Unit{"J", kEnergy},
    Unit{"mJ", kEnergy, 1, 1e3},
    Unit{"kJ", kEnergy, 1e3},
    Unit{"W", kPower},
    Unit{"deg", kAngle},
    Unit{"\u00b0", kAngle},
    Unit{"rad", kAngle, kDegPerRad},
    Unit{"rev", kAngle, 360},
    Unit{"rpm", kAngularSpeed, 6},
    Unit{"%", kPlainNumber, 1, 1e2},
};

struct NamedDimension {
    Dimension dimension;
    const char* name;
    const char* unit;
    const char* example;
};

constexpr std::array kNamed{
    NamedDimension{kPlainNumber, "a plain number", "", ""},
    NamedDimension{kLength, "a length", "m", "2 mm"},
    NamedDimension{kMass, "a mass", "kg", "50 g"},
    NamedDimension{kTime, "a time", "s", "10 ms"},
    NamedDimension{kRate, "a rate", "1/s", "5 Hz"},
    NamedDimension{kSpeed, "a speed", "m/s", "20 cm/s"},
    NamedDimension{kAcceleration, "an acceleration", "m/s^2", "9.81 m/s^2"},
    NamedDimension{kForce, "a force", "N", "3 kN"},
    NamedDimension{kPressure, "a pressure", "Pa", "5 MPa"},
    NamedDimension{kDensity, "a density", "kg/m^3", "1.1 g/cm^3"},
    NamedDimension{kAngle, "an angle", "deg", "45 deg"},
    NamedDimension{kAngularSpeed, "an angular speed", "deg/s", "90 deg/s"},
    NamedDimension{kEnergy, "an energy", "J", "2 J"},
    NamedDimension{kBarrierStiffness, "a contact stiffness", "J/m^4", "1e6 J/m^4"},
};

const NamedDimension* find_named(const Dimension& dimension) {
    for (const NamedDimension& named : kNamed)
        if (named.dimension == dimension) return &named;
    return nullptr;
}

/// "kg m^2 s^-1" for dimensions without a name.
std::string spelled_out(const Dimension& d) {
    std::string text;
    const auto add = [&](const char* symbol, int power) {
        if (power == 0) return;
        if (!text.empty()) text += ' ';
        text += power == 1 ? std::string(symbol) : fmt::format("{}^{}", symbol, power);
    };
    add("kg", d.mass);
    add("m", d.length);
    add("s", d.time);
    add("deg", d.angle);
    return text;
}

std::string expectation(const Dimension& expected) {
    if (expected == kPlainNumber) return "expected a plain number without a unit";
    return fmt::format("expected {} such as \"{}\" or a number in {}",
                       dimension_name(expected),
                       dimension_example(expected),
                       dimension_unit(expected));
}

/// Reads the unit part of a quantity from left to right.
class UnitReader {
  public:
    explicit UnitReader(std::string_view text) : rest_(text) {}

    /// Empty on success, else what is wrong.
    std::string read() {
        bool divide = false;
        while (skip_space(), !rest_.empty()) {
            if (rest_.front() == '1' && factors_ == 0) {  // as in "1/s"
                rest_.remove_prefix(1);
                ++factors_;
            } else if (std::string problem = read_factor(divide); !problem.empty()) {
                return problem;
            }
            skip_space();
            divide = !rest_.empty() && rest_.front() == '/';
            const bool more = divide || (!rest_.empty() && rest_.front() == '*');
            if (more) rest_.remove_prefix(1);
            if (skip_space(), more && rest_.empty())
                return "the unit ends after an operator";
        }
        return {};
    }

    [[nodiscard]] const Dimension& dimension() const { return dimension_; }
    [[nodiscard]] double convert(double value) const { return value * num_ / den_; }

  private:
    void skip_space() {
        while (!rest_.empty()
               && std::isspace(static_cast<unsigned char>(rest_.front())) != 0)
            rest_.remove_prefix(1);
    }

    std::string read_factor(bool divide) {
        std::size_t length = 0;
        const auto in_symbol = [](char c) {
            const auto u = static_cast<unsigned char>(c);
            return std::isalpha(u) != 0 || c == '%' || u == 0xc2 || u == 0xb5
                || u == 0xb0;
        };
        while (length < rest_.size() && in_symbol(rest_[length]))
            ++length;
        const std::string symbol(rest_.substr(0, length));
        if (symbol.empty())
            return fmt::format("found \"{}\" where a unit should start", rest_);
        rest_.remove_prefix(length);
        const std::optional<int> power = read_power();
        if (!power)
            return fmt::format("the power of \"{}\" is no whole number from -9 to 9",
                               symbol);
        for (const Unit& unit : kUnits)
            if (symbol == unit.symbol) {
                apply(unit, divide ? -*power : *power);
                return {};
            }
        std::vector<std::string> known;
        known.reserve(kUnits.size());
        for (const Unit& unit : kUnits)
            known.emplace_back(unit.symbol);
        return fmt::format("unknown unit \"{}\"{}", symbol, did_you_mean(symbol, known));
    }

    /// What follows "^", 1 without it, nothing if it makes no sense.
    std::optional<int> read_power() {
        if (rest_.empty() || rest_.front() != '^') return 1;
        int power = 0;
        const char* end = rest_.data() + rest_.size();
        const auto [stop, failure] = std::from_chars(rest_.data() + 1, end, power);
        if (failure != std::errc{} || power < -9 || power > 9) return std::nullopt;
        rest_.remove_prefix(static_cast<std::size_t>(stop - rest_.data()));
        return power;
    }

    void apply(const Unit& unit, int power) {
        dimension_.length += power * unit.dimension.length;
        dimension_.mass += power * unit.dimension.mass;
        dimension_.time += power * unit.dimension.time;
        dimension_.angle += power * unit.dimension.angle;
        for (int i = 0; i < std::abs(power); ++i) {
            num_ *= power > 0 ? unit.num : unit.den;
            den_ *= power > 0 ? unit.den : unit.num;
        }
        ++factors_;
    }

    std::string_view rest_;
    Dimension dimension_;
    double num_ = 1.0;
    double den_ = 1.0;
    int factors_ = 0;
};

std::string_view trimmed(std::string_view text) {
    const auto is_space = [](char c) {
        return std::isspace(static_cast<unsigned char>(c)) != 0;
    };
    while (!text.empty() && is_space(text.front()))
        text.remove_prefix(1);
    while (!text.empty() && is_space(text.back()))
        text.remove_suffix(1);
    return text;
}

}  // namespace

std::string dimension_name(const Dimension& dimension) {
    const NamedDimension* named = find_named(dimension);
    return named != nullptr ? named->name : "a quantity in " + spelled_out(dimension);
}

std::string dimension_unit(const Dimension& dimension) {
    const NamedDimension* named = find_named(dimension);
    return named != nullptr ? named->unit : spelled_out(dimension);
}

std::string dimension_example(const Dimension& dimension) {
    const NamedDimension* named = find_named(dimension);
    return named != nullptr ? named->example : "1 " + spelled_out(dimension);
}

std::variant<double, std::string> parse_quantity(std::string_view text,
                                                 const Dimension& expected) {
    const std::string_view body = trimmed(text);
    const std::string_view digits =
        !body.empty() && body.front() == '+' ? body.substr(1) : body;
    double value = 0.0;
    const char* end = digits.data() + digits.size();
    const auto [stop, failure] = std::from_chars(digits.data(), end, value);
    if (failure != std::errc{} || !std::isfinite(value))
        return fmt::format("found \"{}\", {}", text, expectation(expected));

    UnitReader unit(std::string_view(stop, static_cast<std::size_t>(end - stop)));
    if (stop == end)
        return fmt::format(
            "found \"{}\" without a unit, {}; leave out the quotes or add a unit",
            text,
            expectation(expected));
    if (const std::string problem = unit.read(); !problem.empty())
        return fmt::format("found \"{}\", {}; {}", text, expectation(expected), problem);
    if (unit.dimension() != expected)
        return fmt::format("found {} (\"{}\"), {}",
                           dimension_name(unit.dimension()),
                           text,
                           expectation(expected));
    const double si = unit.convert(value);
    if (!std::isfinite(si)) return fmt::format("found \"{}\", which is too large", text);
    return si;
}

}  // namespace noli
