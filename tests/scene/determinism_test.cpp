// SPDX-License-Identifier: Apache-2.0
/// The same bits for any number of threads, for every SIMD width, and across a stop and
/// resume.

#include "scene_support.hpp"

namespace noli::test {
namespace {

Scene pile() {
    Scene scene;
    scene.name = "pile";
    scene.dt = 0.02;
    for (int k = 0; k < 4; ++k) {
        Body body = generated("ball" + std::to_string(k),
                              k % 2 == 0 ? "sphere" : "torus",
                              {{"edge_length", {k % 2 == 0 ? 0.16 : 0.1}}});
        body.transform = placed(0.07 * k, 0.55 + 0.75 * k, 0.05 * (k % 3));
        body.friction = 0.4;
        body.velocity = {0, -2, 0};
        scene.bodies.push_back(body);
    }
    scene.half_spaces = {ground(0.4)};
    return scene;
}

Scene twisted_bar() {
    Scene scene;
    scene.name = "twist";
    scene.dt = 0.04;
    scene.gravity = {0, 0, 0};
    Body bar = generated("bar", "box", {{"size", {1, 0.2, 0.2}}, {"cells", {12, 3, 3}}});
    bar.material.model = Material::Model::FixedCorotated;
    for (const double side : {0.0, 1.0}) {
        BoundaryCondition turn;
        turn.kind = BoundaryCondition::Kind::Velocity;
        turn.angular_deg = {side > 0 ? 120.0 : -120.0, 0, 0};
        turn.selection.kind = Selection::Kind::Box;
        turn.selection.box_min = {side - 0.01, -1, -1};
        turn.selection.box_max = {side + 0.01, 2, 2};
        bar.boundary.push_back(turn);
    }
    scene.bodies = {bar};
    return scene;
}

Scene squeeze() {
    Scene scene;
    scene.name = "squeeze";
    scene.dt = 0.02;
    scene.solver.integrator = Integrator::Bdf2;
    Body ball = generated("ball", "sphere", {{"edge_length", {0.14}}});
    ball.material.model = Material::Model::NeoHookean;
    ball.friction = 0.2;
    ball.transform = placed(0, 0.52, 0);
    Body lid = generated("lid", "plane_surface", {{"width", {2}}, {"depth", {2}}});
    lid.transform = placed(0, 1.1, 0);
    BoundaryCondition press;
    press.kind = BoundaryCondition::Kind::Velocity;
    press.linear = {0.3, -0.5, 0};
    press.t_end = 0.5;
    lid.boundary = {press};
    scene.bodies = {ball, lid};
    scene.half_spaces = {ground(0.2)};
    return scene;
}

/// Large and stiff enough for the coarse space.
Scene stiff_pile() {
    Scene scene = pile();
    scene.name = "stiff_pile";
    for (Body& body : scene.bodies)
        body.material.young = 1e8;
    return scene;
}

Scene factored_pile() {
    Scene scene = stiff_pile();
    scene.name = "factored_pile";
    scene.solver.linear = LinearSolver::IncompleteCholesky;
    return scene;
}

constexpr int kSteps = 30;

std::uint64_t hash_after(const Scene& scene, int threads) {
    SimulatorOptions options;
    options.device = Device::Cpu;
    options.threads = threads;
    Simulator simulator = start(scene, options);
    int contacts = 0;
    for (int k = 0; k < kSteps; ++k)
        contacts = std::max(contacts, simulator.step().contacts);
    EXPECT_EQ(simulator.steps_done(), kSteps);
    return simulator.state_hash();
}

std::uint64_t hash_with_resume(const Scene& scene) {
    SimulatorOptions options;
    options.device = Device::Cpu;
    options.threads = 1;
    Simulator first = start(scene, options);
    for (int k = 0; k < kSteps / 2; ++k)
        first.step();
    const std::vector<std::byte> saved = first.save();
    options.threads = 2;
    Simulator second = start(scene, options);
    const Status restored = second.restore(saved);
    EXPECT_TRUE(bool(restored));
    for (int k = kSteps / 2; k < kSteps; ++k)
        second.step();
    return second.state_hash();
}

class StateHash : public ::testing::TestWithParam<Scene> {};

TEST_P(StateHash, IsTheSameForEveryThreadCountAndAcrossAResume) {
    const std::uint64_t one = hash_after(GetParam(), 1);
    for (const int threads : {2, 3, 4})
        EXPECT_EQ(hash_after(GetParam(), threads), one) << threads << " threads";
    EXPECT_EQ(hash_with_resume(GetParam()), one) << "resume";
}

INSTANTIATE_TEST_SUITE_P(
    Scenes,
    StateHash,
    ::testing::Values(pile(), stiff_pile(), factored_pile(), twisted_bar(), squeeze()),
    [](const auto& tested) { return tested.param.name; });

TEST(StateHash, DiffersWhenTheSceneDiffers) {
    Scene scene = squeeze();
    const std::uint64_t as_is = hash_after(scene, 2);
    scene.bodies[0].velocity = {1e-12, 0, 0};
    EXPECT_NE(hash_after(scene, 2), as_is);
}

}  // namespace
}  // namespace noli::test
