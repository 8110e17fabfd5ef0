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
         "frictionless plates: the block slips aside, and Newton creeps after it until "
         "max_newton; the first three at default settings, the others when tightened",
         {"polyethylene/0.001/0.001/implicit_euler/0",
          "wood/0.01/0.001/implicit_euler/0",
          "steel/0.01/0.001/implicit_euler/0",
          "cork/0.001/0.001/bdf2/0",
          "glass/0.001/0.001/bdf2/0",
          "cork/0.001/0.004/implicit_euler/1"}},
        {"a block slides down a tilted obstacle, tan 0.5, mu 0.3",
         "crosses 30 of its sizes a step, over the seam of the two triangles that the "
         "obstacle is: 1.5 % slow, or another bounce when tightened",
         {"aluminium/0.001/0.04/implicit_euler/1",
          "glass/0.001/0.04/newmark/0",
          "soft_silicone/0.001/0.04/implicit_euler/0"}},
        {"a block sticks on a slope, tan 0.5, mu 0.6",
         "tightening moves the creep by 2 % of the speed without friction",
         {"soft_tissue/0.01/0.01/bdf2/1"}},
        {"spinning projectile",
         "Newmark damps nothing, and what the linear solver leaves of the strain of a "
         "falling cube of 1 mm adds up: spin 2 to 4 % off after 30 steps of 40 ms",
         {"steel/0.001/0.04/newmark/0"}},
        {"pendulum: a bar on a hinge",
         "Newmark goes once round, 40 steps of half of a radian: 8 % off",
         {"foam/0.001/0.004/newmark/0"}},
        {"a ball rests on a half-space",
         "still rocks after 60 steps: the tightened run is 1.6 % off",
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
