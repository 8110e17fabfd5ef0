// SPDX-License-Identifier: Apache-2.0
#include "sim/start_checks.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace noli {

namespace {

// What solids have: from the lightest aerogels in use to osmium, and diamond.
constexpr double kLightest = 10.0;  ///< kg/m^3
constexpr double kHeaviest = 25e3;  ///< kg/m^3
constexpr double kStiffest = 2e12;  ///< Pa
constexpr double kMostSag = 1.0;    ///< strain under its own weight

class MaterialCheck {
  public:
    MaterialCheck(const Scene& scene, std::size_t index, Findings& out)
        : material_(scene.bodies[index].material), index_(index), out_(out) {}

    /// `height`: of the body along gravity g (m/s^2), m.
    void check(double height, double g) {
        const double sag = material_.density * g * height / material_.young;
        if (sag > kMostSag)
            warn(
                "young",
                fmt::format("a column of this material as high as the body ({:.3g} m) is "
                            "squashed by its own weight: density * gravity * height / "
                            "young = {:.3g}, where a solid has far less than 1; young = "
                            "{:g} Pa is probably meant in other units (\"2 MPa\" is 2e6)",
                            height,
                            sag,
                            material_.young));
        if (material_.young > kStiffest)
            warn("young",
                 fmt::format("{:g} Pa is stiffer than diamond (1e12 Pa); is it meant in "
                             "other units? (\"200 GPa\" is 2e11)",
                             material_.young));
        if (material_.density < kLightest)
            warn(
                "density",
                fmt::format("{:g} kg/m^3 is lighter than foam; is it meant in g/cm^3? (1 "
                            "g/cm^3 is 1000 kg/m^3)",
                            material_.density));
        if (material_.density > kHeaviest)
            warn(
                "density",
                fmt::format("{:g} kg/m^3 is heavier than any metal; is it meant in other "
                            "units? (steel has 7850 kg/m^3)",
                            material_.density));
        if (material_.poisson > 0.495)
            warn("poisson",
                 "nearly incompressible: linear tetrahedra lock; 0.49 is usually stiff "
                 "enough");
    }

  private:
    void warn(const char* what, std::string message) {
        out_.push_back({Finding::Severity::Warning,
                        fmt::format("/bodies/{}/material/{}", index_, what),
                        std::move(message)});
    }
    const Material& material_;
    std::size_t index_;
    Findings& out_;
};

/// Extent of each body along a unit vector, m; 0 without vertices that have mass.
std::vector<double> extents_along(const Model& model, const Vec3d& up) {
    std::vector<double> low(model.body_names.size(), HUGE_VAL);
    std::vector<double> high(low.size(), -HUGE_VAL);
    for (std::size_t v = 0; v < model.x0.size(); ++v) {
        if (!(model.mass[v] > 0.0)) continue;
        const std::size_t b = static_cast<std::size_t>(model.body[v]);
        const double at = dot(up, model.x0[v]);
        low[b] = std::min(low[b], at);
        high[b] = std::max(high[b], at);
    }
    for (std::size_t b = 0; b < low.size(); ++b)
        high[b] = std::max(0.0, high[b] - low[b]);
    return high;
}

}  // namespace

void check_materials(const Scene& scene, const Model& model, Findings& out) {
    const Vec3d gravity{scene.gravity[0], scene.gravity[1], scene.gravity[2]};
    const double g = norm(gravity);
    const Vec3d up = g > 0.0 ? (-1.0 / g) * gravity : Vec3d{0, 1, 0};
    const std::vector<double> height = extents_along(model, up);
    const std::vector<std::size_t> source = scene_body_of(scene);
    for (std::size_t b = 0; b < source.size() && b < height.size(); ++b) {
        const bool is_copy = b > 0 && source[b] == source[b - 1];
        if (!is_copy && height[b] > 0.0)
            MaterialCheck(scene, source[b], out).check(height[b], g);
    }
}

}  // namespace noli
