// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Tolerances between a device and the CPU, and why they are what they are.
///
/// A loop does the same operations per item on both, and only three things may differ:
/// the last bit of log, sqrt of sums and their like; the order in which sums are taken;
/// eigenvectors of nearly equal eigenvalues, which the projected Hessians are free of.
/// An estimate, to be checked on a device: sums in another order differ by some 1e-13 of
/// the largest entry, and stiff terms cancel three digits more. So 1e-10 of the largest
/// entry for one assembly, and for a linear solve to 1e-20 in squared norm the same times
/// a condition number of 1e3.

#include "exec/cpu.hpp"
#include "parity/loops.hpp"
#include "parity/scenes.hpp"
#include "sim/engine_on.hpp"
#include "sim/step_settings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace noli::test {

inline constexpr double kAssemblyTolerance = 1e-10;
inline constexpr double kSolutionTolerance = 1e-7;

inline void expect_same_loops(const std::vector<LoopResult>& got,
                              const std::vector<LoopResult>& expected) {
    ASSERT_EQ(got.size(), expected.size());
    for (std::size_t k = 0; k < got.size(); ++k) {
        ASSERT_EQ(got[k].values.size(), expected[k].values.size()) << got[k].name;
        double largest = 0.0;
        double difference = 0.0;
        for (std::size_t i = 0; i < got[k].values.size(); ++i) {
            const double a = got[k].values[i];
            const double b = expected[k].values[i];
            if (a == b) continue;  // infinities too
            largest = std::max(largest, std::fabs(b));
            const double here = std::fabs(a - b);
            difference = here <= difference ? difference : here;  // NaN stays
        }
        const double tolerance = expected[k].is_exact           ? 0.0
                               : expected[k].name == "solution" ? kSolutionTolerance
                                                                : kAssemblyTolerance;
        EXPECT_LE(difference, tolerance * largest) << got[k].name;
    }
}

/// A state in contact: where the scene is after some steps on the CPU, and a little off.
struct LoopCase {
    Model model;
    BlockPattern pattern;
    StepSettings settings;
    std::vector<Vec3d> x_start, x, x_tilde, p;
    std::vector<std::uint8_t> fixed;

    explicit LoopCase(const Scene& scene, int steps)
        : model(build_model(scene).value()),
          pattern(build_block_pattern(model.num_vertices, model.tets)),
          settings(step_settings(scene, model)) {
        const auto engine = make_cpu_engine({model, pattern, settings, scene.gravity, 1});
        for (int k = 0; k < steps; ++k)
            EXPECT_EQ(engine->step().outcome, Outcome::Converged);
        x_start = engine->state().x;
        const std::vector<Vec3d> v = engine->state().v;
        for (std::size_t i = 0; i < x_start.size(); ++i) {
            const double wave = 1e-3 * std::sin(0.7 * static_cast<double>(i));
            x.push_back(x_start[i] + 1e-3 * settings.dt * v[i]);
            x_tilde.push_back(x_start[i] + settings.dt * v[i] + Vec3d{0, -1e-3, wave});
            p.push_back(settings.dt * v[i] + Vec3d{wave, -2e-3, 0.5 * wave});
            fixed.push_back(i % 13 == 0 ? 1 : model.obstacle[i]);
        }
    }
    [[nodiscard]] LoopInput input() const {
        return {model,
                pattern,
                settings.dt * settings.dt,
                settings.dhat,
                1e6,
                settings.epsv * settings.dt,
                x_start,
                x,
                x_tilde,
                p,
                fixed};
    }
};

/// Steps after which a scene's loops are compared.
inline constexpr int kStepsToContact = 8;

}  // namespace noli::test
