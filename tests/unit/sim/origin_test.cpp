// SPDX-License-Identifier: Apache-2.0
/// A scene far from the origin is the same scene: same motion, same work.

#include "model/origin.hpp"

#include "noli/simulator.hpp"

#include "output/file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fmt/format.h>

namespace noli {
namespace {

Affine at(const Vector3& place) {
    Affine out;
    out.rows = {{{1, 0, 0, place[0]}, {0, 1, 0, place[1]}, {0, 0, 1, place[2]}}};
    return out;
}

Body box(const std::string& name, const Vector3& place) {
    Body body;
    body.name = name;
    body.mesh.generator = "box";
    body.mesh.parameters = {{"size", {0.5, 0.5, 0.5}}, {"cells", {2, 2, 2}}};
    body.transform = at(place);
    body.material.young = 1e5;
    return body;
}

Vector3 plus(const Vector3& a, const Vector3& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

/// Everything that has a place in the world, moved by `by`.
Scene scene_at(const Vector3& by) {
    Scene scene;
    scene.dt = 0.01;
    scene.bodies = {box("falls", plus(by, {0, 0.2525, 0})),
                    box("turns", plus(by, {1, 0.5, 0})),
                    box("goes", plus(by, {2, 0.5, 0}))};
    scene.bodies[0].velocity = {0.5, 0, 0};
    scene.bodies[0].friction = 0.3;
    BoundaryCondition turn;
    turn.kind = BoundaryCondition::Kind::Path;
    turn.center = plus(by, {1, 0.25, 0});
    turn.path = {{.time = 0.0}, {.time = 1.0, .rotation_deg = {0, 90, 0}}};
    turn.selection.kind = Selection::Kind::Box;
    turn.selection.frame = Selection::Frame::World;
    turn.selection.box_min = plus(by, {0.5, 0.7, -1});
    turn.selection.box_max = plus(by, {1.5, 0.8, 1});
    scene.bodies[1].boundary = {turn};
    BoundaryCondition go;
    go.kind = BoundaryCondition::Kind::Velocity;
    go.linear = {1, 0, 0};
    go.until = BoundaryCondition::Until{.axis = 0, .value = by[0] + 1.785};
    scene.bodies[2].boundary = {go};
    HalfSpace floor;
    floor.point = by;
    scene.half_spaces = {floor};
    Container ball;
    ball.center = plus(by, {1, 1, 0});
    ball.radius = 4.0;
    scene.containers = {ball};
    return scene;
}

TEST(Origin, IsZeroNearTheOriginAndAMultipleOfAPowerOfTwoFarAway) {
    const Result<Model> near = build_model(scene_at({300, 0, 0}));
    ASSERT_TRUE(near);
    EXPECT_EQ(max_abs(near.value().origin), 0.0);
    const Result<Model> far = build_model(scene_at({1e6, -2e6, 0}));
    ASSERT_TRUE(far);
    EXPECT_NEAR(far.value().origin.x, 1e6, 8.0);
    EXPECT_EQ(far.value().origin.y, -2e6);
    EXPECT_EQ(std::fmod(far.value().origin.x, 4.0), 0.0);
    EXPECT_LT(max_abs(far.value().x0.front()), 8.0);
}

TEST(Origin, ASceneFarAwayMovesAsAtTheOriginWithTheSameWork) {
    for (const double far : {1e6, 1e10}) {
        // A power of two keeps the digits of the boxes in the world.
        const Vector3 by{std::exp2(std::round(std::log2(far))), 0, -std::exp2(20)};
        Result<Simulator> here = Simulator::create(scene_at({0, 0, 0}));
        Result<Simulator> there = Simulator::create(scene_at(by));
        ASSERT_TRUE(here && there);
        for (int step = 0; step < 8; ++step) {
            const StepReport a = here.value().step();
            const StepReport b = there.value().step();
            ASSERT_EQ(a.outcome, Outcome::Converged) << a.message;
            ASSERT_EQ(b.outcome, Outcome::Converged) << b.message;
            EXPECT_EQ(a.newton, b.newton) << far << " step " << step;
            EXPECT_NEAR(a.contacts, b.contacts, 1) << far << " step " << step;
        }
        const std::vector<Vector3> x = here.value().positions();
        const std::vector<Vector3> y = there.value().positions();
        const double rounding = 2.3e-16 * far;
        for (std::size_t v = 0; v < x.size(); ++v)
            for (std::size_t k = 0; k < 3; ++k)
                ASSERT_NEAR(y[v][k] - by[k], x[v][k], 1e-9 + 2 * rounding) << v;
    }
}

TEST(Origin, PlacesInReportsAreThoseOfTheScene) {
    Scene scene = scene_at({1e6, 0, 0});
    scene.bodies = {box("a", {1e6, 1, 0}), box("b", {1e6 + 0.3, 1.1, 0.1})};
    Result<Simulator> simulator = Simulator::create(scene);
    ASSERT_TRUE(simulator);
    const VerifyReport report = simulator.value().verify();
    ASSERT_FALSE(report.intersections.empty());
    EXPECT_NEAR(report.intersections.front().place[0], 1e6, 1.0);
    scene.bodies = {box("a", {1e6, -1, 0})};
    simulator = Simulator::create(scene);
    ASSERT_TRUE(simulator);
    const VerifyReport beyond = simulator.value().verify();
    ASSERT_FALSE(beyond.beyond_walls.empty());
    EXPECT_NEAR(beyond.beyond_walls.front().place[0], 1e6, 1.0);
}

TEST(Origin, SequencesCountFromTheWorldToo) {
    const auto folder = std::filesystem::temp_directory_path();
    const auto frame = [&](int k) {
        const double x = 1e6 + 0.01 * k;
        const std::string path = (folder / fmt::format("noli_far_{}.obj", k)).string();
        EXPECT_TRUE(write_file(path,
                               fmt::format("v {0:.17g} 0 0\nv {1:.17g} 0 0\n"
                                           "v {0:.17g} 1 0\nf 1 2 3\n",
                                           x,
                                           x + 1)));
        return path;
    };
    Body obstacle;
    obstacle.name = "obstacle";
    obstacle.mesh.file = frame(0);
    BoundaryCondition follow;
    follow.kind = BoundaryCondition::Kind::Sequence;
    follow.sequence = {frame(1), frame(2)};
    obstacle.boundary = {follow};
    Scene scene;
    scene.gravity = {0, 0, 0};
    scene.bodies = {box("b", {1e6, 3, 0}), obstacle};
    Result<Simulator> simulator = Simulator::create(scene);
    ASSERT_TRUE(simulator) << simulator.error().message;
    for (int step = 0; step < 2; ++step)
        ASSERT_EQ(simulator.value().step().outcome, Outcome::Converged);
    EXPECT_NEAR(simulator.value().positions()[27][0], 1e6 + 0.02, 1e-9);
}

}  // namespace
}  // namespace noli
