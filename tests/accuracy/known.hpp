// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Cases that are known to be wrong, and why. They run, are in the table of
/// docs/accuracy.md and are not asserted; all others are.

#include <algorithm>
#include <string>
#include <vector>

namespace noli::accuracy {

/// Cases of one scene, as name_of(Case) calls them.
struct Known {
    std::string scene, why;
    std::vector<std::string> cases;
};

inline const std::vector<Known>& known_cases() {
    static const std::vector<Known> all{
        {"a block pressed by a plate",
         "frictionless plates: directions just above the tolerance lower the energy by "
         "1e-10 of it an iteration until max_newton, perhaps a slip aside; the first "
         "three at default settings, the others when tightened",
         {"polyethylene/0.001/0.001/implicit_euler/0",
          "wood/0.01/0.001/implicit_euler/0",
          "steel/0.01/0.001/implicit_euler/0",
          "cork/0.001/0.001/bdf2/0",
          "glass/0.001/0.001/bdf2/0",
          "cork/0.001/0.004/implicit_euler/1"}},
        {"a block slides down a tilted obstacle, tan 0.5, mu 0.3",
         "goes up to 70 of its sizes a step: 1.5 % slow, or another motion when "
         "tightened; cause not looked into",
         {"aluminium/0.001/0.04/implicit_euler/1",
          "glass/0.001/0.04/newmark/0",
          "soft_silicone/0.001/0.04/implicit_euler/0"}},
        {"a block sticks on a slope, tan 0.5, mu 0.6",
         "tightening moves the creep by 2 % of the speed without friction",
         {"soft_tissue/0.01/0.01/bdf2/1"}},
        {"spinning projectile",
         "spin 2 to 4 % off after 30 steps of 40 ms; cause not looked into",
         {"steel/0.001/0.04/newmark/0"}},
        {"pendulum: a bar on a hinge",
         "8 % off after half a turn under Newmark; cause not looked into",
         {"foam/0.001/0.004/newmark/0"}},
        {"a ball rests on a half-space",
         "the tightened run is 1.6 % off; cause not looked into",
         {"cork/0.001/0.004/implicit_euler/0"}},
    };
    return all;
}

inline bool known_to_be_wrong(const std::string& scene, const std::string& at) {
    const auto& all = known_cases();
    return std::any_of(all.begin(), all.end(), [&](const Known& known) {
        return known.scene == scene
            && std::find(known.cases.begin(), known.cases.end(), at) != known.cases.end();
    });
}

}  // namespace noli::accuracy
