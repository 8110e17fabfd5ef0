// SPDX-License-Identifier: Apache-2.0
/// Bodies given by a function that is positive inside: sphere, pebble, star.
#include "mesh/generate.hpp"
#include "mesh/implicit.hpp"
#include "mesh/parameters.hpp"

#include <algorithm>
#include <numbers>
#include <random>

namespace noli {

namespace {

using detail::ParameterCheck;

constexpr double kPi = std::numbers::pi;

/// A smooth random function with values in [-1, 1]: a mean of plane waves.
class Bumps {
  public:
    explicit Bumps(std::uint32_t seed) {
        std::mt19937 random(
            seed);  // its sequence is fixed by the standard; the distributions are not
        const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
        for (Wave& wave : waves_) {
            const double z = 2.0 * uniform() - 1.0, angle = 2.0 * kPi * uniform(),
                         r = std::sqrt(1.0 - z * z);
            const double frequency = 2.0 + 3.0 * uniform();
            wave = {frequency * Vec3d{r * std::cos(angle), r * std::sin(angle), z},
                    2.0 * kPi * uniform()};
        }
    }

    double operator()(const Vec3d& y) const {
        double sum = 0.0;
        for (const Wave& wave : waves_)
            sum += std::cos(dot(wave.k, y) + wave.phase);
        return sum / kWaves;
    }

  private:
    static constexpr int kWaves = 8;
    struct Wave {
        Vec3d k;
        double phase;
    };
    Wave waves_[kWaves];
};

Result<Mesh> meshed(ParameterCheck& check, const ImplicitBody& body, double edge_length) {
    check.elements(estimated_tets(body, edge_length), kMaxGeneratedElements);
    if (check.error()) return *check.error();
    return tetrahedralized(body, edge_length);
}

}  // namespace

Result<Mesh> make_sphere(const SphereParams& p) {
    ParameterCheck check("sphere");
    check.above("radius", p.radius, 0.0)
        .above("edge_length", p.edge_length, 0.0, p.radius);
    const double r = p.radius;
    return meshed(check,
                  {[r](const Vec3d& x) { return r - norm(x); }, {-r, -r, -r}, {r, r, r}},
                  p.edge_length);
}

Result<Mesh> make_pebble(const PebbleParams& p) {
    ParameterCheck check("pebble");
    for (int k = 0; k < 3; ++k)
        check.above("radii", p.radii[k], 0.0);
    check.range("bumpiness", p.bumpiness, 0.0, 0.3);
    check.above(
        "edge_length", p.edge_length, 0.0, std::min({p.radii.x, p.radii.y, p.radii.z}));
    const auto f = [p, bumps = Bumps(p.seed)](const Vec3d& x) {
        const Vec3d y{x.x / p.radii.x, x.y / p.radii.y, x.z / p.radii.z};
        return 1.0 + p.bumpiness * bumps(y) - norm(y);
    };
    const Vec3d reach = (1.0 + p.bumpiness) * p.radii;
    return meshed(check, {f, -reach, reach}, p.edge_length);
}

Result<Mesh> make_star(const StarParams& p) {
    ParameterCheck check("star");
    check.above("radius", p.radius, 0.0)
        .above("thickness", p.thickness, 0.0, 2.0 * p.radius);
    check.range("arms", p.arms, 3, 8).range("notch", p.notch, 0.0, 0.7);
    check.above("edge_length", p.edge_length, 0.0, 0.5 * p.thickness);
    const auto f = [p](const Vec3d& x) {
        const double rho_sq = (x.x * x.x + x.y * x.y) / (p.radius * p.radius);
        const double wave =
            std::cos(p.arms * (std::atan2(x.y, x.x) - 0.5 * kPi));  // one arm points up
        const double smooth = rho_sq / (rho_sq + 0.02);  // no crease at the axis
        const double outline = 1.0 - 0.5 * p.notch * (1.0 - wave) * smooth;
        const double z = 2.0 * x.z / p.thickness;
        return 1.0 - std::sqrt(rho_sq / (outline * outline) + z * z);
    };
    const Vec3d reach{p.radius, p.radius, 0.5 * p.thickness};
    return meshed(check, {f, -reach, reach}, p.edge_length);
}

}  // namespace noli
