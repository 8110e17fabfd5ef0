// SPDX-License-Identifier: Apache-2.0
#include "sim/squeeze.hpp"

#include "sim/start_checks.hpp"

#include <fmt/format.h>
#include <map>

namespace noli {

namespace {

constexpr double kPressed = 0.1;  ///< gap over dhat of what presses a body

struct Press {
    double gap = 0.0;
    std::string name;
    bool moves = false;
};

/// What nothing can push away and is close to each elastic body.
std::map<int, std::vector<Press>> presses_of(const Model& model,
                                             const std::vector<BodyGap>& gaps) {
    const std::vector<double> mass = body_masses(model);
    const auto is_elastic = [&](int b) {
        return b >= 0 && mass[static_cast<std::size_t>(b)] > 0.0;
    };
    std::map<int, std::vector<Press>> out;
    for (const BodyGap& gap : gaps) {
        if (!(gap.closest.gap < kPressed * model.dhat)) continue;
        if (gap.plane >= 0) {
            const std::string& name =
                model.walls[static_cast<std::size_t>(gap.plane)].name;
            out[gap.a].push_back({gap.closest.gap, "half-space \"" + name + "\"", false});
        } else if (is_elastic(gap.a) != is_elastic(gap.b)) {
            const int body = is_elastic(gap.a) ? gap.a : gap.b;
            const int other = is_elastic(gap.a) ? gap.b : gap.a;
            const std::string& name = model.body_names[static_cast<std::size_t>(other)];
            out[body].push_back(
                {gap.closest.gap, "\"" + name + "\"", is_moved(model, other)});
        }
    }
    return out;
}

}  // namespace

std::string describe_squeeze(const Model& model, const std::vector<BodyGap>& gaps) {
    for (const auto& [body, presses] : presses_of(model, gaps)) {
        std::string between;
        bool moving = false;
        for (const Press& press : presses) {
            if (!between.empty()) between += " and ";
            between += fmt::format("{} (gap {:.2g} m)", press.name, press.gap);
            moving = moving || press.moves;
        }
        if (presses.size() < 2 || !moving) continue;
        return fmt::format(
            "\"{}\" is squeezed between {}, which move and cannot give way: there is no "
            "room left for it; end that motion earlier, or leave more room between them",
            model.body_names[static_cast<std::size_t>(body)],
            between);
    }
    return "";
}

}  // namespace noli
