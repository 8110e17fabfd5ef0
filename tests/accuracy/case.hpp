// SPDX-License-Identifier: Apache-2.0
#pragma once
/// One point of the grid that the accuracy suite covers, and the words for it.

#include "noli/scene.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace noli::accuracy {

inline constexpr double kGravity = 9.80665;

inline const std::vector<std::string> kPresets{"soft_tissue",
                                               "gelatin",
                                               "soft_silicone",
                                               "foam",
                                               "silicone",
                                               "rubber",
                                               "cork",
                                               "polyethylene",
                                               "abs",
                                               "wood",
                                               "concrete",
                                               "glass",
                                               "aluminium",
                                               "steel"};
inline const std::vector<double> kSizes{1e-3, 1e-2, 0.1, 1.0, 10.0};    // m
inline const std::vector<double> kSteps{1e-3, 4e-3, 1e-2, 2e-2, 4e-2};  // s
inline const std::vector<Integrator> kIntegrators{
    Integrator::ImplicitEuler, Integrator::Bdf2, Integrator::Newmark};

/// Cells along an edge of a cube by level of refinement: 8, 64, 343 and 4913 vertices.
inline constexpr std::array<int, 4> kCells{1, 3, 6, 16};

struct Case {
    std::string preset;
    double size;  ///< m, edge of a cube
    double dt;    ///< s
    Integrator integrator;
    int mesh;  ///< level of refinement, index of kCells
};

inline std::string name_of(Integrator integrator) {
    switch (integrator) {
        case Integrator::ImplicitEuler:
            return "implicit_euler";
        case Integrator::Bdf2:
            return "bdf2";
        default:
            return "newmark";
    }
}

inline std::string short_number(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", x);
    return text;
}

/// "steel/0.1/0.01/bdf2/1": what ACCURACY_CASE takes to run this case alone.
inline std::string name_of(const Case& at) {
    return at.preset + "/" + short_number(at.size) + "/" + short_number(at.dt) + "/"
         + name_of(at.integrator) + "/" + std::to_string(at.mesh);
}

/// The constants of a preset, read as a scene of a user would read them.
inline Material preset(const std::string& name) {
    static std::map<std::string, Material> known;
    if (const auto found = known.find(name); found != known.end()) return found->second;
    const auto folder = std::filesystem::temp_directory_path();
    const std::string path =
        (folder / ("noli_accuracy_" + name + std::to_string(std::rand()) + ".json"))
            .string();
    std::ofstream(path)
        << R"({"format_version": 1, "bodies": [{"mesh": {"generator": "box"},)"
        << R"( "material": ")" << name << "\"}]}";
    Result<Scene> scene = read_scene(path);
    std::filesystem::remove(path);
    if (!scene) throw std::runtime_error(scene.error().message);
    return known[name] = scene.value().bodies.at(0).material;
}

/// Speed of sound in a bar, m/s.
inline double sound_speed(const Material& material) {
    return std::sqrt(material.young / material.density);
}

}  // namespace noli::accuracy
