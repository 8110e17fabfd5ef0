// SPDX-License-Identifier: Apache-2.0
/// What a step leaves unbalanced on a body: within what its tests for the end allow at
/// default settings, and seen where they allow too much.

#include "sim/net_force.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace noli {
namespace {

Scene stack_of_cubes(double young, double size) {
    Scene scene;
    scene.dt = 0.01;
    for (int k = 0; k < 3; ++k) {
        Body body;
        body.name = "cube " + std::to_string(k);
        body.mesh.generator = "box";
        body.mesh.parameters = {{"size", {size, size, size}}, {"cells", {2, 2, 2}}};
        body.material.young = young;
        body.friction = 0.4;
        body.velocity = {0.3 * k, 0, 0};
        body.transform.rows = {
            {{1, 0, 0, 0}, {0, 1, 0, (0.52 + 1.02 * k) * size}, {0, 0, 1, 0}}};
        scene.bodies.push_back(body);
    }
    scene.half_spaces.emplace_back();
    return scene;
}

/// Largest of `steps` steps.
double worst_unbalanced(const Scene& scene, int steps) {
    Result<Simulator> made = Simulator::create(scene);
    EXPECT_TRUE(made);
    Simulator& simulator = made.value();
    double worst = 0.0;
    for (int k = 0; k < steps; ++k) {
        const StepReport report = simulator.step();
        EXPECT_EQ(report.outcome, Outcome::Converged) << report.message;
        worst = std::max(
            worst,
            unbalanced(simulator.topology(),
                       simulator.net_forces(),
                       simulator.fields().contact_force,
                       simulator.resolved().tolerance * scene.dt,
                       scene.dt,
                       scene.solver.gap_tolerance + scene.contact.friction_tolerance
                           + report.lag_change));
    }
    return worst;
}

TEST(NetForce, IsWithinWhatTheEndOfAStepAllows) {
    for (const double young : {1e5, 1e9, 2e11})
        for (const double size : {0.01, 0.1, 1.0}) {
            const double worst = worst_unbalanced(stack_of_cubes(young, size), 15);
            EXPECT_LE(worst, 1.0) << young << " Pa, " << size << " m";
        }
}

TEST(NetForce, NamesWhatARoughEndLeaves) {
    // Without contact the net force of a step is that of the last direction alone, and a
    // body that falls is solved exactly: only what acts at the contacts can be left.
    Scene scene = stack_of_cubes(1e6, 0.1);
    scene.solver.gap_tolerance = 0.0;
    scene.solver.tolerance = 1.0;
    scene.contact.friction_iterations = 1;
    Result<Simulator> made = Simulator::create(scene);
    ASSERT_TRUE(made);
    Simulator& simulator = made.value();
    double worst = 0.0;
    for (int k = 0; k < 15; ++k) {
        ASSERT_EQ(simulator.step().outcome, Outcome::Converged);
        worst = std::max(worst,
                         unbalanced(simulator.topology(),
                                    simulator.net_forces(),
                                    simulator.fields().contact_force,
                                    1e-3 * simulator.resolved().diagonal * scene.dt,
                                    scene.dt,
                                    0.05));
    }
    EXPECT_GT(worst, 1.0);
}

}  // namespace
}  // namespace noli
