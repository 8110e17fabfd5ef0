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
        // LIST
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
