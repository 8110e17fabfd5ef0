// SPDX-License-Identifier: Apache-2.0
/// What is found before the first step, and that a run says it too.
#include "sim/start_checks.hpp"

#include "output/file.hpp"
#include "parity/scenes.hpp"
#include "unit/output/scratch_folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

namespace noli {
namespace {

using Severity = Finding::Severity;

Body box(const std::string& name, double x, double y, double size = 1.0) {
    Body body;
    body.name = name;
    body.mesh.generator = "box";
    body.mesh.parameters = {{"size", {size, size, size}}};
    body.transform.rows[0][3] = x;
    body.transform.rows[1][3] = y;
    return body;
}

Body plate(const std::string& name, double x, double y) {
    Body body = box(name, x, y);
    body.mesh.generator = "plane_surface";
    body.mesh.parameters = {{"width", {2}}, {"depth", {2}}};
    return body;
}

/// Two boxes of 1 m, one above the other.
Scene stack(double gap) {
    Scene scene;
    scene.dt = 0.01;
    scene.bodies = {box("low", 0, 0), box("high", 0.1, 1.0 + gap)};
    return scene;
}

std::vector<Finding> findings_of(const Scene& scene) {
    const Result<CheckReport> report = check_scene(scene);
    EXPECT_TRUE(report) << report.error().message;
    if (!report) return {};
    EXPECT_EQ(report.value().intersections.num_intersections, 0);
    return report.value().findings;
}

/// The finding whose message has the text; severity Note and no words if there is none.
Finding find(const std::vector<Finding>& findings, const std::string& text) {
    for (const Finding& finding : findings)
        if (finding.message.find(text) != std::string::npos) return finding;
    return {};
}

void expect_words(const Finding& finding, const std::vector<std::string>& words) {
    const std::string said = finding.where + ": " + finding.message;
    for (const std::string& word : words)
        EXPECT_NE(said.find(word), std::string::npos) << word << " in: " << said;
}

RunOptions into(const std::string& directory) {
    RunOptions options;
    options.directory = directory;
    options.simulator.device = Device::Cpu;
    return options;
}

TEST(StartGaps, ThatRoundingHidesRefuseTheRun) {
    const Finding found = find(findings_of(stack(1e-15)), "touch");
    EXPECT_EQ(found.severity, Severity::Error);
    expect_words(found,
                 {"\"low\" and \"high\"", " m apart", "e-16 m", "leave a gap", "dhat"});

    const ScratchFolder scratch;
    const Result<RunSummary> run = run_scene(stack(1e-15), into(scratch / "run"));
    ASSERT_FALSE(run);
    EXPECT_EQ(run.error().code, Error::Code::InitialContact);
    EXPECT_NE(run.error().message.find("touch"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(scratch / "run"));
}

TEST(StartGaps, AtAHalfSpaceTooAndNotOfBodiesThatMayOverlap) {
    Scene scene = stack(0.5);
    scene.half_spaces.push_back({.name = "floor", .point = {0, -0.5 - 1e-15, 0}});
    const Finding found = find(findings_of(scene), "touch");
    EXPECT_EQ(found.severity, Severity::Error);
    expect_words(found, {"\"low\" and half-space \"floor\"", "vertex"});

    scene = stack(1e-15);
    scene.contact.pairs.push_back({.a = "low", .b = "high", .enabled = false});
    EXPECT_EQ(find(findings_of(scene), "touch").message, "");
}

TEST(StartGaps, OfAFewDigitsAreWarnedOf) {
    const Finding found = find(findings_of(stack(1e-10)), "all but touch");
    EXPECT_EQ(found.severity, Severity::Warning);
    expect_words(found, {"\"low\" and \"high\"", "1e-10 m apart", "leave a gap"});
    EXPECT_EQ(find(findings_of(stack(0.01)), "apart").message, "");
}

TEST(StartGaps, ThatThrowBodiesApartSayHowFast) {
    Scene scene = stack(1e-4);
    scene.gravity = {0, 0, 0};
    scene.duration = 10.0;
    scene.solver.tolerance = 1e-6;
    for (Body& body : scene.bodies)
        body.material.young = 1e9;  // the speed said is that of rigid bodies
    const Finding found = find(findings_of(scene), "pushes them apart");
    EXPECT_EQ(found.severity, Severity::Warning);
    expect_words(found, {"start 0.0001 m apart", "m/s", "dhat"});

    // The speed said is a bound that a tight run comes near to.
    const std::size_t at = found.message.find("up to ") + 6;
    const double said = std::stod(found.message.substr(at));
    SimulatorOptions options;
    options.device = Device::Cpu;
    Simulator simulator = std::move(Simulator::create(scene, options).value());
    for (int k = 0; k < 10; ++k)
        ASSERT_EQ(simulator.step().outcome, Outcome::Converged);
    double low = 0.0;
    double high = 0.0;
    int count[2] = {0, 0};
    const std::vector<Vector3> v = simulator.velocities();
    const Topology topology = simulator.topology();
    for (std::size_t i = 0; i < v.size(); ++i) {
        (topology.body_of_vertex[i] == 0 ? low : high) += v[i][1];
        ++count[topology.body_of_vertex[i]];
    }
    const double apart = high / count[1] - low / count[0];
    EXPECT_LE(apart, said);
    EXPECT_GE(apart, 0.7 * said);
}

TEST(StartGaps, ThatDoNotMatterBesideGravityAreANote) {
    for (const Finding& finding : findings_of(stack(2e-3)))
        EXPECT_EQ(finding.severity, Severity::Note) << finding.message;
}

TEST(StartOverlaps, OfASolidInASolidAreNamed) {
    Scene scene;
    scene.bodies = {box("seed", 0.05, 0.02, 0.3), box("fruit", 0, 0)};
    const Finding found = find(findings_of(scene), "wholly inside");
    EXPECT_EQ(found.severity, Severity::Warning);
    expect_words(found, {"\"seed\"", "inside \"fruit\"", "move one of them out"});
}

TEST(StartOverlaps, OfObstaclesAreNoted) {
    Scene scene = stack(0.5);
    scene.bodies.push_back(plate("floor", 0, -1));
    Body wall = plate("wall", 0.9, -1);
    wall.transform.rows = {{{0, 1, 0, 0.9}, {-1, 0, 0, -1}, {0, 0, 1, 0.1}}};
    scene.bodies.push_back(wall);
    Finding found = find(findings_of(scene), "obstacles that overlap");
    EXPECT_EQ(found.severity, Severity::Note);
    expect_words(found, {"\"floor\" and \"wall\"", "nothing moves them"});

    BoundaryCondition lift;
    lift.kind = BoundaryCondition::Kind::Velocity;
    lift.linear = {0, 1, 0};
    scene.bodies[2].boundary = {lift};
    found = find(findings_of(scene), "obstacles that overlap");
    expect_words(found, {"squeezed to nothing"});
}

TEST(StartMaterials, ThatLookLikeOtherUnitsAreWarnedOf) {
    struct Case {
        double young, density;
        const char* where;
        const char* words;
    };
    for (const Case& c : {Case{2.0, 1000, "/bodies/1/material/young", "own weight"},
                          Case{2e13, 1000, "/bodies/1/material/young", "diamond"},
                          Case{1e5, 1.2, "/bodies/1/material/density", "g/cm^3"},
                          Case{1e9, 1e6, "/bodies/1/material/density", "metal"}}) {
        Scene scene = stack(0.5);
        scene.bodies[1].material.young = c.young;
        scene.bodies[1].material.density = c.density;
        const Finding found = find(findings_of(scene), c.words);
        EXPECT_EQ(found.severity, Severity::Warning) << c.words;
        EXPECT_EQ(found.where, c.where);
    }
    Scene scene = stack(0.5);
    scene.bodies[1].material.young = 2.0;
    expect_words(find(findings_of(scene), "own weight"), {"4.9e+03", "young = 2 Pa"});
}

TEST(StartLengths, DhatMustBeFarAboveTheRoundingOfCoordinates) {
    Scene scene = stack(0.5);
    scene.contact.dhat_absolute = true;
    scene.contact.dhat = 1e-14;
    Finding found = find(findings_of(scene), "the rounding of coordinates");
    EXPECT_EQ(found.severity, Severity::Error);
    expect_words(found, {"dhat = 1e-14 m", "choose a dhat of at least"});

    // What suffices at the origin does not suffice for bodies far apart.
    scene.contact.dhat = 1e-4;
    EXPECT_EQ(find(findings_of(scene), "the rounding of coordinates").message, "");
    Scene apart = scene;
    apart.bodies[1].transform.rows[0][3] += 1e6;
    found = find(findings_of(apart), "the rounding of coordinates");
    EXPECT_EQ(found.severity, Severity::Warning);
    expect_words(found, {"from the origin", "move the scene to the origin"});

    // All of it far away is computed near the origin, as long as its shapes have digits.
    const auto far = [&](double by) {
        Scene moved = scene;
        for (Body& body : moved.bodies)
            body.transform.rows[0][3] += by;
        return findings_of(moved);
    };
    EXPECT_EQ(find(far(1e6), "the rounding of coordinates").message, "");
    EXPECT_EQ(find(far(1e6), "where numbers are rounded").message, "");
    found = find(far(1e11), "where numbers are rounded");
    EXPECT_EQ(found.severity, Severity::Warning);
    expect_words(found, {"1e+11 m from the origin", "move the scene to the origin"});
}

TEST(StartLengths, DhatMustBeSmallBesideTheSmallestBody) {
    Scene scene = stack(3.0);
    scene.bodies.push_back(box("pea", 0, -1, 0.1));
    scene.contact.dhat_absolute = true;
    scene.contact.dhat = 0.03;
    const Finding found = find(findings_of(scene), "quarter of the thickness");
    EXPECT_EQ(found.severity, Severity::Warning);
    expect_words(found, {"\"pea\" (0.1 m)", "0.01 m or less"});
}

TEST(RunScene, SaysAndLogsTheWarningsOfItsStart) {
    const ScratchFolder scratch;
    Scene scene = stack(0.5);
    scene.bodies[0].material.density = 1.2;
    RunOptions options = into(scratch / "run");
    options.steps = 1;
    std::vector<Finding> said;
    options.on_warnings = [&](const std::vector<Finding>& warnings) { said = warnings; };
    ASSERT_TRUE(run_scene(scene, options));
    ASSERT_EQ(said.size(), 1U);
    EXPECT_EQ(said[0].where, "/bodies/0/material/density");
    EXPECT_NE(read_file(scratch / "run/log.txt")
                  .value()
                  .find("warning: /bodies/0/material/density: 1.2 kg/m^3"),
              std::string::npos);

    said.clear();
    options.resume = true;
    options.steps = 2;
    ASSERT_TRUE(run_scene(scene, options));
    EXPECT_TRUE(said.empty());
}

/// A ball on the ground and a lid that comes down on it and does not stop.
TEST(FailedStep, NamesTheBodyThatObstaclesSqueezeToNothing) {
    Scene scene = test::squeezed_ball();
    scene.bodies[1].boundary[0].linear = {0, -2.0, 0};
    scene.bodies[0].mesh.parameters = {{"edge_length", {0.5}}};
    scene.solver.max_newton = 100;
    SimulatorOptions options;
    options.device = Device::Cpu;
    Simulator simulator = std::move(Simulator::create(scene, options).value());
    StepReport report;
    for (int k = 0; k < 100 && report.outcome == Outcome::Converged; ++k)
        report = simulator.step();
    ASSERT_NE(report.outcome, Outcome::Converged);
    expect_words({Severity::Error, "step", report.message},
                 {"\"ball\" is squeezed between",
                  "\"lid\"",
                  "half-space \"ground\"",
                  "no room left",
                  "end that motion earlier"});
}

}  // namespace
}  // namespace noli
