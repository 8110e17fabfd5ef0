// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Range checks shared by the generators: the first failure is kept.

#include "noli/result.hpp"

#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <string>

namespace noli::detail {

class ParameterCheck {
  public:
    explicit ParameterCheck(const char* generator)
        : where_(fmt::format("generator \"{}\"", generator)) {}

    /// lo < value <= hi
    ParameterCheck& above(const char* name, double value, double lo, double hi = 1e9) {
        return test(value > lo && value <= hi,
                    name,
                    value,
                    fmt::format("more than {} and at most {}", lo, hi));
    }
    /// lo <= value <= hi
    ParameterCheck& range(const char* name, double value, double lo, double hi) {
        return test(
            value >= lo && value <= hi, name, value, fmt::format("{} to {}", lo, hi));
    }
    ParameterCheck& require(bool fine,
                            const char* name,
                            double value,
                            const char* expected) {
        return test(fine, name, value, expected);
    }
    /// Refuses meshes whose number of elements is a slip of the pen.
    ParameterCheck& elements(double estimate, double limit) {
        if (!error_ && !(estimate <= limit))
            error_ = Error{Error::Code::InvalidScene,
                           where_,
                           fmt::format("these parameters make about {:.2g} elements, "
                                       "expected at most {:.2g}; "
                                       "raise edge_length or lower the number of cells",
                                       estimate,
                                       limit)};
        return *this;
    }

    [[nodiscard]] const std::optional<Error>& error() const { return error_; }

  private:
    ParameterCheck& test(bool fine,
                         const char* name,
                         double value,
                         const std::string& expected) {
        if (!error_ && (!fine || !std::isfinite(value)))
            error_ = Error{
                Error::Code::InvalidScene,
                where_,
                fmt::format(
                    "{} is {}, expected {}; change \"{}\"", name, value, expected, name)};
        return *this;
    }

    std::string where_;
    std::optional<Error> error_;
};

}  // namespace noli::detail
