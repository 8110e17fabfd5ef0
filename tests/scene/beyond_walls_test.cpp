// SPDX-License-Identifier: Apache-2.0
/// Scenes that start with vertices where a half-space or container forbids them to be, or
/// closer than the minimum separation: who, where, how deep, and what to do.

#include "scene_support.hpp"

#include <fstream>
#include <sstream>

namespace noli::test {
namespace {

void expect_parts(const std::string& text, const std::vector<std::string>& parts) {
    for (const std::string& part : parts)
        EXPECT_NE(text.find(part), std::string::npos) << part << " in: " << text;
}

/// A box of 1 m whose lower side, of nine vertices, is 0.25 m below the ground.
Scene sunk() {
    Scene scene;
    scene.name = "sunk";
    Body box = generated("box", "box", {{"cells", {2, 2, 2}}});
    box.transform = placed(0, 0.25, 0);
    scene.bodies = {box};
    scene.half_spaces = {ground()};
    return scene;
}

const std::vector<std::string> kSunk{"9 vertices of \"box\"",
                                     "half-space \"ground\"",
                                     "the deepest is vertex ",
                                     "0.25 m deep",
                                     "move the body by 0.25",
                                     "along 0 1 0"};

TEST(BeyondWalls, CheckNamesAndMarksThem) {
    const std::string folder = scratch_folder("sunk");
    const Result<CheckReport> checked = check_scene(sunk(), folder);
    ASSERT_TRUE(checked) << checked.error().message;
    const CheckReport& report = checked.value();
    EXPECT_EQ(report.intersections.num_intersections, 9);
    EXPECT_TRUE(report.intersections.intersections.empty());
    std::vector<std::string> errors;
    for (const Finding& finding : report.findings)
        if (finding.severity == Finding::Severity::Error)
            errors.push_back(finding.where + ": " + finding.message);
    ASSERT_EQ(errors.size(), 1U);
    expect_parts(errors[0], kSunk);
    ASSERT_FALSE(report.marked_mesh.empty());
    std::ifstream mesh(report.marked_mesh);
    std::stringstream text;
    text << mesh.rdbuf();
    EXPECT_NE(text.str().find("220 30 30"), std::string::npos);
    EXPECT_NE(text.str().find("190 190 190"), std::string::npos);
}

TEST(BeyondWalls, ARunRefusesThem) {
    RunOptions options;
    options.directory = scratch_folder("sunk_run") + "/out";
    options.simulator.device = Device::Cpu;
    const Result<RunSummary> ran = run_scene(sunk(), options);
    ASSERT_FALSE(ran);
    EXPECT_EQ(ran.error().code, Error::Code::InitialContact);
    expect_parts(ran.error().message, kSunk);
}

TEST(BeyondWalls, AStepNamesThem) {
    Simulator simulator = start(sunk(), checked_options());
    const StepReport report = simulator.step();
    EXPECT_NE(report.outcome, Outcome::Converged);
    expect_parts(report.message, kSunk);
}

TEST(BeyondWalls, ASingleVertexOutsideOfAContainerIsNamed) {
    Scene scene;
    scene.name = "outside";
    // A corner of the tetrahedron is 0.5 m outside of the drum.
    const std::string folder = scratch_folder("outside");
    scene.bodies = {body_of_tets(
        folder, "tet", {{0, 0, 0}, {2.5, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{{0, 1, 2, 3}}})};
    Container drum;
    drum.name = "drum";
    drum.radius = 2.0;
    scene.containers = {drum};
    const Result<CheckReport> checked = check_scene(scene, folder);
    ASSERT_TRUE(checked) << checked.error().message;
    ASSERT_EQ(checked.value().intersections.beyond_walls.size(), 1U);
    const BeyondWall& at = checked.value().intersections.beyond_walls[0];
    EXPECT_EQ(at.vertices, std::vector<int>{1});
    EXPECT_EQ(at.deepest, 1);
    EXPECT_NEAR(at.depth, 0.5, 1e-12);
    expect_parts(at.message,
                 {"vertex 1 of \"tet\" is outside of container \"drum\"",
                  "at 2.5 0 0",
                  "0.5 m deep",
                  "make the radius larger by 0.5"});
}

TEST(BeyondWalls, AnObstacleMayBeThere) {
    Scene scene = sunk();
    scene.bodies[0].transform = placed(0, 1, 0);
    Body plate = generated("plate", "plane_surface");
    plate.transform = placed(0, -1, 0);
    scene.bodies.push_back(plate);
    const Result<CheckReport> checked = check_scene(scene, "");
    ASSERT_TRUE(checked) << checked.error().message;
    EXPECT_EQ(checked.value().intersections.num_intersections, 0);
}

/// A box that falls onto another one, which stands on the ground; dhat is 1 mm.
Scene separated(double min_separation) {
    Scene scene;
    scene.name = "separated";
    scene.dt = 0.01;
    scene.contact.dhat = 1e-3;
    scene.contact.dhat_absolute = true;
    scene.contact.min_separation = min_separation;
    Body below = generated("below", "box", {{"size", {0.4, 0.1, 0.4}}});
    below.transform = placed(0, 0.05 + min_separation + 1.5e-3, 0);
    Body above = generated("above", "box", {{"size", {0.2, 0.1, 0.2}}});
    above.transform = placed(0.01, 0.15 + 2.0 * min_separation + 3e-3, 0.02);
    for (Body* body : {&below, &above}) {
        body->material.young = 1e6;
        body->velocity = {0, -0.5, 0};
        scene.bodies.push_back(*body);
    }
    scene.half_spaces = {ground()};
    scene.damping.mass = 10.0;
    return scene;
}

TEST(MinSeparation, BodiesRestBeyondIt) {
    // Half of dhat, dhat itself and ten times it: barriers begin at dhat beyond it.
    for (const double separation : {0.5e-3, 1e-3, 1e-2}) {
        SCOPED_TRACE(separation);
        Simulator simulator = start(separated(separation), checked_options());
        const std::vector<StepReport> reports = run_clean(simulator, 80);
        EXPECT_GT(smallest_gap(reports), separation);
        EXPECT_LT(reports.back().min_gap, separation + 1e-3);
        EXPECT_GT(reports.back().contacts, 0);
        for (const Vector3& v : simulator.velocities())
            ASSERT_LT(std::abs(v[1]), 0.02);
    }
}

TEST(MinSeparation, AStartThatIsCloserIsNamed) {
    Scene scene = separated(1e-2);
    scene.bodies[1].transform = placed(0, 0.15 + 1e-2 + 1.5e-3 + 0.8e-2, 0);
    const Result<CheckReport> checked = check_scene(scene, "");
    ASSERT_TRUE(checked) << checked.error().message;
    EXPECT_EQ(checked.value().intersections.num_intersections, 1);
    const std::vector<std::string> parts{
        "\"above\"", "\"below\"", "0.008 m apart", "contact/min_separation = 0.01 m"};
    expect_parts(checked.value().intersections.too_close, parts);
    RunOptions options;
    options.directory = scratch_folder("close_run") + "/out";
    options.simulator.device = Device::Cpu;
    const Result<RunSummary> ran = run_scene(scene, options);
    ASSERT_FALSE(ran);
    expect_parts(ran.error().message, parts);
}

}  // namespace
}  // namespace noli::test
