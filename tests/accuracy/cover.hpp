// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Which cases of the grid a scene runs on: all of them under FULL=1, else a covering
/// set. A greedy set takes the case that adds most values (or pairs of values) not yet
/// seen; ties go to coarse meshes and then to an order that differs from scene to scene,
/// so that the suite as a whole sees most pairs.

#include "case.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <set>

namespace noli::accuracy {

enum class Cover { Values, Pairs };

/// The part of the grid on which a scene has its answer.
struct Domain {
    std::vector<std::string> presets = kPresets;
    std::vector<double> sizes = kSizes;
    std::vector<double> steps = kSteps;
    std::vector<Integrator> integrators = kIntegrators;
    std::vector<int> meshes{0, 1, 2};
    std::function<bool(const Case&)> holds;  ///< none: everywhere
};

inline std::vector<Case> all_cases(const Domain& domain) {
    std::vector<Case> out;
    for (const std::string& preset : domain.presets)
        for (const double size : domain.sizes)
            for (const double dt : domain.steps)
                for (const Integrator integrator : domain.integrators)
                    for (const int mesh : domain.meshes) {
                        const Case at{preset, size, dt, integrator, mesh};
                        if (!domain.holds || domain.holds(at)) out.push_back(at);
                    }
    return out;
}

namespace detail {

/// The values of a case, or the pairs of them, as texts that differ.
inline std::vector<std::string> features(const Case& at, Cover cover) {
    const std::vector<std::string> values{"p" + at.preset,
                                          "s" + short_number(at.size),
                                          "t" + short_number(at.dt),
                                          "i" + name_of(at.integrator),
                                          "m" + std::to_string(at.mesh)};
    if (cover == Cover::Values) return values;
    std::vector<std::string> pairs;
    for (std::size_t a = 0; a < values.size(); ++a)
        for (std::size_t b = a + 1; b < values.size(); ++b)
            pairs.push_back(values[a] + values[b]);
    return pairs;
}

/// FNV-1a.
inline std::uint32_t hash_of(const std::string& text) {
    std::uint32_t hash = 2166136261u;
    for (const char c : text)
        hash = (hash ^ static_cast<unsigned char>(c)) * 16777619u;
    return hash;
}

}  // namespace detail

inline std::vector<Case> covering_cases(const Domain& domain,
                                        Cover cover,
                                        const std::string& seed) {
    struct Candidate {
        Case at;
        std::vector<std::string> features;
        int order;
    };
    constexpr std::array<int, 4> kWeight{0, 200, 600, 2000};  // of the finer meshes
    std::vector<Candidate> left;
    for (const Case& at : all_cases(domain)) {
        const int noise = static_cast<int>(detail::hash_of(seed + name_of(at)) % 1000);
        left.push_back({at,
                        detail::features(at, cover),
                        noise + kWeight[static_cast<std::size_t>(at.mesh)]});
    }
    std::sort(left.begin(), left.end(), [](const Candidate& a, const Candidate& b) {
        return a.order < b.order;
    });
    std::vector<Case> out;
    std::set<std::string> seen;
    for (;;) {
        std::ptrdiff_t most = 0;
        const Candidate* best = nullptr;
        for (const Candidate& candidate : left) {
            const auto fresh =
                std::count_if(candidate.features.begin(),
                              candidate.features.end(),
                              [&](const std::string& f) { return seen.count(f) == 0; });
            if (fresh > most) {
                most = fresh;
                best = &candidate;
            }
        }
        if (best == nullptr) return out;
        out.push_back(best->at);
        seen.insert(best->features.begin(), best->features.end());
    }
}

}  // namespace noli::accuracy
