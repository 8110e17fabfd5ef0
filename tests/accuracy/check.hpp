// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Runs a scene over its cases, at default settings and with a tolerance 100 times
/// tighter, and writes one line per measured number for table.py:
///
///     ACCURACY <tab> scene <tab> answer <tab> own error in words <tab> preset <tab> size
///     <tab> dt <tab> integrator <tab> vertices <tab> what <tab> expected <tab> found
///     <tab> error % <tab> own error % <tab> moved by tightening % or - <tab> Newton/step
///     <tab> PCG/Newton <tab> s <tab> ok or FAIL <tab> message
///
/// FULL=1 runs the whole grid; ACCURACY_CASE=steel/0.1/0.01/bdf2/1 runs one case;
/// ACCURACY_OUT=FILE appends the lines there too.

#include "cover.hpp"
#include "known.hpp"
#include "lab.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <string>

namespace noli::accuracy {

/// Everything is right to this share of its scale, or the row says why not.
inline constexpr double kBound = 0.01;

struct Spec {
    std::string name;
    std::string answer;  ///< the formula, for the table
    std::string own;     ///< what the model itself adds, for the table
    Domain domain;
    Cover cover = Cover::Values;
    std::function<void(Lab&)> run;
    /// Every so many cases of the covering set run again with a tighter tolerance.
    int tighten_every = 4;
};

namespace detail {

inline bool asked_for(const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr && *value != '\0' && std::string(value) != "0";
}

inline std::vector<Case> cases_of(const Spec& spec) {
    const bool one = asked_for("ACCURACY_CASE");
    if (!one && !asked_for("FULL"))
        return covering_cases(spec.domain, spec.cover, spec.name);
    std::vector<Case> all = all_cases(spec.domain);
    if (one)
        all.erase(std::remove_if(all.begin(),
                                 all.end(),
                                 [](const Case& at) {
                                     return name_of(at) != std::getenv("ACCURACY_CASE");
                                 }),
                  all.end());
    return all;
}

/// How far tightening moved a number, relative to its scale.
inline double moved(const Lab& lab, const Lab& tight, std::size_t k) {
    if (k >= tight.measured.size()) return HUGE_VAL;
    return std::abs(lab.measured[k].found - tight.measured[k].found)
         / lab.measured[k].scale;
}

inline void write_line(const std::string& line) {
    std::printf("%s\n", line.c_str());
    if (!asked_for("ACCURACY_OUT")) return;
    std::ofstream(std::getenv("ACCURACY_OUT"), std::ios::app) << line + "\n";
}

inline std::string line_of(const Spec& spec,
                           Lab& lab,
                           const Measured& m,
                           double shift,
                           const std::string& verdict) {
    const auto part = [](const std::string& text) { return "\t" + text; };
    const auto number = [&](double x) { return "\t" + short_number(x); };
    const int vertices = lab.simulator().resolved().num_vertices;
    return "ACCURACY" + part(spec.name) + part(spec.answer) + part(spec.own)
         + part(lab.at.preset) + number(lab.at.size) + number(lab.at.dt)
         + part(name_of(lab.at.integrator)) + part(std::to_string(vertices))
         + part(m.what) + number(m.expected) + number(m.found) + number(100.0 * m.error())
         + number(100.0 * m.own) + (shift < 0.0 ? part("-") : number(100.0 * shift))
         + number(double(lab.newton) / std::max(1, lab.steps))
         + number(double(lab.pcg) / std::max(1, lab.newton)) + number(lab.seconds)
         + part(verdict);
}

inline std::string reproduce(const Spec& spec, const Case& at) {
    return spec.name + ", ACCURACY_CASE=" + name_of(at);
}

/// One case; `tighten` repeats it with the tighter tolerance.
inline void check_case(const Spec& spec, const Case& at, bool tighten) {
    Lab lab(at, false);
    spec.run(lab);
    const bool is_known = known_to_be_wrong(spec.name, name_of(at));
    if (!lab.failed.empty()) {
        if (!is_known) ADD_FAILURE() << reproduce(spec, at) << ": " << lab.failed;
        write_line("ACCURACY-FAILED\t" + spec.name + "\t" + name_of(at) + "\t"
                   + lab.failed);
        return;
    }
    ASSERT_FALSE(lab.measured.empty()) << reproduce(spec, at);
    Lab tight(at, true);
    if (tighten) spec.run(tight);
    if (!tight.failed.empty() && !is_known)
        ADD_FAILURE() << reproduce(spec, at) << ", tighter: " << tight.failed;
    for (std::size_t k = 0; k < lab.measured.size(); ++k) {
        const Measured& m = lab.measured[k];
        const double shift = tighten ? moved(lab, tight, k) : -1.0;
        const bool right = m.error() <= kBound + m.own;  // false for NaN
        const bool firm = shift <= kBound;
        EXPECT_TRUE(right || is_known)
            << reproduce(spec, at) << ": " << m.what << " expected " << m.expected
            << ", found " << m.found << ", off by " << 100 * m.error() << " % of "
            << m.scale << ", own error of the model " << 100 * m.own << " %";
        EXPECT_TRUE(firm || is_known)
            << reproduce(spec, at) << ": tightening moves " << m.what << " from "
            << m.found << " by " << 100 * shift << " %";
        write_line(line_of(spec, lab, m, shift, right && firm ? "ok" : "FAIL"));
    }
}

}  // namespace detail

inline void check(const Spec& spec) {
    const std::vector<Case> cases = detail::cases_of(spec);
    EXPECT_FALSE(cases.empty()) << spec.name;
    for (std::size_t k = 0; k < cases.size(); ++k)
        detail::check_case(
            spec, cases[k], k % static_cast<std::size_t>(spec.tighten_every) == 0);
}

}  // namespace noli::accuracy
