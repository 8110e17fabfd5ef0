// SPDX-License-Identifier: Apache-2.0
/// Unit tests of the supplement's section 7: one tetrahedron falls on another so that
/// exactly one kind of contact decides (Fig. 6), and conforming or sharp pairs (Fig. 7).

#include "scene_support.hpp"

namespace noli::test {
namespace {

const std::vector<Int4> kOneTet{{{0, 1, 2, 3}}};

/// `below` is held, `above` falls on it from a small height.
Scene two_tets(const std::string& name,
               const std::vector<Vec3d>& below,
               const std::vector<Vec3d>& above) {
    const std::string folder = scratch_folder("fig6_" + name);
    Scene scene;
    scene.name = name;
    scene.dt = 0.01;
    scene.contact.dhat = 1e-3;
    Body held = body_of_tets(folder, "below", below, kOneTet);
    held.boundary.push_back(fixed_everywhere());
    Body falling = body_of_tets(folder, "above", above, kOneTet);
    falling.velocity = {0, -1, 0};
    scene.bodies = {held, falling};
    return scene;
}

void expect_contact_without_intersection(const Scene& scene, int steps = 60) {
    Simulator simulator = start(scene, checked_options());
    const std::vector<StepReport> reports = run_clean(simulator, steps);
    EXPECT_GT(most_contacts(reports), 0) << "the bodies never met";
    EXPECT_LT(smallest_gap(reports), simulator.resolved().dhat);
}

// A tetrahedron with a horizontal top face at y = 0, another with its tip down.
const std::vector<Vec3d> kTopFace{{-1, 0, -1}, {1, 0, -1}, {0, 0, 1}, {0, -1, 0}};
const std::vector<Vec3d> kTipDown{
    {0.05, 0.05, -0.1}, {-0.4, 0.8, -0.4}, {0.6, 0.8, -0.4}, {0.1, 0.8, 0.5}};
// A tetrahedron with a horizontal top edge along x at y = 0.
const std::vector<Vec3d> kTopEdgeX{{-1, 0, 0}, {1, 0, 0}, {0, -1, -0.7}, {0, -1, 0.7}};
// Bottom edges along z and along x.
const std::vector<Vec3d> kBottomEdgeZ{
    {0.1, 0.05, -1}, {0.1, 0.05, 1}, {-0.6, 1, 0}, {0.8, 1, 0}};
const std::vector<Vec3d> kBottomEdgeX{
    {-0.8, 0.05, 0.0}, {0.9, 0.05, 0.0}, {0.05, 1, -0.7}, {0.05, 1, 0.7}};
const std::vector<Vec3d> kTipOverEdge{
    {0.1, 0.05, 0.0}, {-0.4, 0.8, -0.4}, {0.6, 0.8, -0.4}, {0.1, 0.8, 0.5}};
const std::vector<Vec3d> kTipUp{
    {0, 0, 0}, {-0.5, -0.8, -0.5}, {0.5, -0.8, -0.5}, {0, -0.8, 0.6}};
const std::vector<Vec3d> kTipOverTip{
    {0, 0.05, 0}, {-0.5, 0.85, -0.5}, {0.5, 0.85, -0.5}, {0, 0.85, 0.6}};

TEST(SupplementFig6, PointOnTriangle) {
    expect_contact_without_intersection(two_tets("pt", kTopFace, kTipDown));
}
TEST(SupplementFig6, EdgeAcrossEdge) {
    expect_contact_without_intersection(two_tets("ee", kTopEdgeX, kBottomEdgeZ));
}
TEST(SupplementFig6, EdgeAlongParallelEdge) {
    expect_contact_without_intersection(two_tets("ee_parallel", kTopEdgeX, kBottomEdgeX));
}
TEST(SupplementFig6, PointOnEdge) {
    expect_contact_without_intersection(two_tets("pe", kTopEdgeX, kTipOverEdge));
}
TEST(SupplementFig6, PointOnPoint) {
    expect_contact_without_intersection(two_tets("pp", kTipUp, kTipOverTip));
}

/// A unit cube held below, another one above it.
Scene two_cubes(double dx, double gap, double scale = 1.0) {
    Scene scene;
    scene.name = "cubes";
    scene.dt = 0.01;
    Body held = generated("below", "box", {{"cells", {2, 2, 2}}});
    held.boundary.push_back(fixed_everywhere());
    Body falling = generated("above", "box", {{"cells", {2, 2, 2}}});
    falling.transform = placed(dx, 0.5 + 0.5 * scale + gap, 0, scale);
    scene.bodies = {held, falling};
    return scene;
}

TEST(SupplementFig7, AlignedCubesWithConformingFaces) {
    expect_contact_without_intersection(two_cubes(0.0, 0.02));
}
TEST(SupplementFig7, CubesThatStartVeryClose) {
    // A hundredth of dhat: the barrier acts from the first moment.
    expect_contact_without_intersection(two_cubes(0.0, 3e-5));
}
TEST(SupplementFig7, ShiftedCubesWithParallelEdges) {
    expect_contact_without_intersection(two_cubes(0.25, 0.02));
}
TEST(SupplementFig7, SmallCubeOnLargeFace) {
    expect_contact_without_intersection(two_cubes(0.1, 0.02, 0.5));
}

TEST(SupplementFig7, SharpOnSharpStaysApartWhenPressed) {
    // Two tips driven against each other at 5 m/s, slightly off centre.
    std::vector<Vec3d> above = kTipOverTip;
    for (Vec3d& p : above)
        p.x += 0.003;
    Scene scene = two_tets("sharp", kTipUp, above);
    scene.bodies[1].velocity = {0, -5, 0};
    expect_contact_without_intersection(scene);
}

}  // namespace
}  // namespace noli::test
