// SPDX-License-Identifier: Apache-2.0
/// Boundary conditions in time: windows, ends, loads, and the way of what turns.

#include "model/boundary.hpp"

#include "model/rotation.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace noli {
namespace {

using Kind = BoundaryCondition::Kind;

/// A unit square of vertices, each of mass 1 + its index; all in one condition.
struct Square {
    Model model;
    ModelCondition condition;

    Square() {
        model.num_vertices = 4;
        model.x0 = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
        model.mass = {1, 2, 3, 4};
        model.obstacle = {0, 0, 0, 0};
        condition.vertices = {0, 1, 2, 3};
        condition.body_vertices = {0, 1, 2, 3};
        condition.start_center = {0.5, 0.5, 0};
    }

    StepBoundary at(double t, double dt, int step = 0) {
        return at(t, dt, model.x0, step);
    }
    StepBoundary at(double t, double dt, const std::vector<Vec3d>& x, int step = 0) {
        model.conditions = {condition};
        BoundaryScript script(model, {0, -10, 0});
        StepBoundary out;
        script.evaluate(t, dt, step, x, out);
        return out;
    }
};

void expect_near(const Vec3d& a, const Vec3d& b) {
    EXPECT_LT(max_abs(a - b), 1e-14) << a.x << " " << a.y << " " << a.z;
}

TEST(Boundary, LinearVelocityTakesOneLeg) {
    Square s;
    s.condition.what.kind = Kind::Velocity;
    s.condition.what.linear = {2, 0, 0};
    const StepBoundary b = s.at(0.0, 0.5);
    ASSERT_EQ(b.path.size(), 1U);
    EXPECT_EQ(b.num_prescribed, 4);
    expect_near(b.path[0][3], {2, 1, 0});
}

TEST(Boundary, LargeTurnsFollowTheArc) {
    Square s;
    s.condition.what.kind = Kind::Velocity;
    s.condition.what.angular_deg = {0, 0, 90};
    const StepBoundary b = s.at(0.0, 1.0);
    ASSERT_EQ(b.path.size(), 3U);  // 30 degrees each
    for (const std::vector<Vec3d>& leg : b.path)
        for (const Vec3d& p : leg)
            EXPECT_NEAR(norm(p - Vec3d{0.5, 0.5, 0}), std::sqrt(0.5), 1e-14);
    expect_near(b.path[2][1], {1, 1, 0});
}

TEST(Boundary, PathsTurnAboutTheStartAndFollowTheArc) {
    Square s;
    s.condition.what.kind = Kind::Path;
    s.condition.what.path = {{0.0, {0, 0, 0}, {0, 0, 0}}, {1.0, {1, 0, 0}, {0, 0, 100}}};
    const StepBoundary b = s.at(0.5, 0.5);
    ASSERT_EQ(b.path.size(), 2U);  // 50 degrees in all
    const Vec3d arm = Vec3d{0, 0, 0} - Vec3d{0.5, 0.5, 0};
    expect_near(
        b.path[0][0],
        Vec3d{0.5, 0.5, 0} + rotation_from_degrees({0, 0, 75}) * arm + Vec3d{0.75, 0, 0});
    expect_near(
        b.path[1][0],
        Vec3d{0.5, 0.5, 0} + rotation_from_degrees({0, 0, 100}) * arm + Vec3d{1, 0, 0});
}

TEST(Boundary, WindowsAreClosedBelowAndOpenAbove) {
    Square s;
    s.condition.what.t_begin = 1.0;
    s.condition.what.t_end = 2.0;
    EXPECT_EQ(s.at(0.9, 0.1).num_prescribed, 0);
    EXPECT_EQ(s.at(1.0 - 1e-12, 0.1).num_prescribed, 4);
    EXPECT_EQ(s.at(1.9, 0.1).num_prescribed, 4);
    EXPECT_EQ(s.at(2.0 - 1e-12, 0.1).num_prescribed, 0);
}

TEST(Boundary, ForcesAreSpreadByMassAndAddToGravity) {
    Square s;
    s.condition.what.kind = Kind::Force;
    s.condition.what.linear = {20, 0, 0};
    const StepBoundary b = s.at(0.0, 0.1);
    EXPECT_EQ(b.num_prescribed, 0);
    for (const Vec3d& a : b.acceleration)
        expect_near(a, {2, -10, 0});  // 20 N on 10 kg
}

TEST(Boundary, UntilReleasesOrHoldsForGood) {
    for (const bool hold : {false, true}) {
        Square s;
        s.condition.what.kind = Kind::Velocity;
        s.condition.what.linear = {1, 0, 0};
        s.condition.what.until = BoundaryCondition::Until{
            BoundaryCondition::Until::Subject::Body, 0, true, 0.5, hold};
        s.model.conditions = {s.condition};
        BoundaryScript script(s.model, {0, 0, 0});
        StepBoundary out;
        std::vector<Vec3d> x = s.model.x0;
        script.evaluate(0.0, 0.1, 0, x, out);
        EXPECT_EQ(out.num_prescribed, 4);
        for (Vec3d& p : x)
            p.x += 0.5;
        script.evaluate(0.1, 0.1, 1, x, out);
        EXPECT_EQ(out.num_prescribed, hold ? 4 : 0);
        expect_near(out.path[0][0], x[0]);
        for (Vec3d& p : x)
            p.x -= 0.5;
        script.evaluate(0.2, 0.1, 2, x, out);
        EXPECT_EQ(out.num_prescribed, hold ? 4 : 0) << "ended conditions stay ended";
    }
}

TEST(Boundary, SequencesHoldTheirLastEntry) {
    Square s;
    s.condition.what.kind = Kind::Sequence;
    s.condition.sequence = {s.model.x0, s.model.x0};
    for (Vec3d& p : s.condition.sequence[1])
        p.z = 3.0;
    EXPECT_EQ(s.at(0.0, 0.1, 0).path[0][2].z, 0.0);
    EXPECT_EQ(s.at(0.1, 0.1, 1).path[0][2].z, 3.0);
    EXPECT_EQ(s.at(0.7, 0.1, 7).path[0][2].z, 3.0);
}

TEST(Boundary, ObstaclesStandWithoutConditions) {
    Square s;
    s.condition.vertices.clear();
    s.model.obstacle = {0, 1, 1, 0};
    const StepBoundary b = s.at(0.0, 0.1);
    EXPECT_EQ(b.num_prescribed, 2);
    expect_near(b.path[0][1], s.model.x0[1]);
}

/// Conditions on the square's vertices, evaluated for a step of 0.5 s.
StepBoundary together(Square& s, const std::vector<BoundaryCondition>& conditions) {
    for (const BoundaryCondition& what : conditions) {
        s.model.conditions.push_back(s.condition);
        s.model.conditions.back().what = what;
    }
    BoundaryScript script(s.model, {0, -10, 0});
    StepBoundary out;
    script.evaluate(0.0, 0.5, 0, s.model.x0, out);
    return out;
}

BoundaryCondition moving(const Vector3& linear, int axes) {
    BoundaryCondition what;
    what.kind = Kind::Velocity;
    what.linear = linear;
    what.axes = axes;
    return what;
}

TEST(BoundaryAxes, OneAxisLeavesTheOthersFree) {
    Square s;
    const StepBoundary b = together(s, {moving({2, 4, 6}, 1)});
    EXPECT_EQ(b.num_prescribed, 0);
    EXPECT_EQ(b.prescribed, (std::vector<std::uint8_t>{0, 0, 0, 0}));
    EXPECT_EQ(b.axes, (std::vector<std::uint8_t>{1, 1, 1, 1}));
    expect_near(b.path[0][3], {2, 1, 0});
}

TEST(BoundaryAxes, ThreeConditionsMakeAPrescribedVertex) {
    Square s;
    const StepBoundary two = together(s, {moving({2, 4, 6}, 1), moving({2, 4, 6}, 4)});
    EXPECT_EQ(two.axes[0], 5);
    const StepBoundary three = together(s, {moving({2, 4, 6}, 2)});
    EXPECT_TRUE(three.axes.empty());
    EXPECT_EQ(three.num_prescribed, 4);
    expect_near(three.path[0][0], {1, 2, 3});
}

TEST(BoundaryAxes, TheLaterConditionWinsOnItsAxes) {
    Square s;
    const StepBoundary b = together(
        s, {moving({2, 4, 6}, kAllAxes), moving({20, 40, 60}, 2), moving({8, 8, 8}, 3)});
    EXPECT_TRUE(b.axes.empty());
    EXPECT_EQ(b.num_prescribed, 4);
    expect_near(b.path[0][0], {4, 4, 3});
    Square whole;
    const StepBoundary w =
        together(whole, {moving({20, 40, 60}, 2), moving({2, 4, 6}, kAllAxes)});
    expect_near(w.path[0][0], {1, 2, 3});
}

TEST(BoundaryAxes, AHeldEndKeepsItsAxesOnly) {
    Square s;
    BoundaryCondition what = moving({2, 4, 6}, 6);
    what.until =
        BoundaryCondition::Until{.subject = BoundaryCondition::Until::Subject::Body,
                                 .axis = 0,
                                 .above = true,
                                 .value = -1.0,
                                 .then_hold = true};
    const StepBoundary b = together(s, {what});
    EXPECT_EQ(b.axes[2], 6);
    expect_near(b.path[0][2], s.model.x0[2]);
}

TEST(BoundaryAxes, ObstaclesStayPrescribed) {
    Square s;
    s.model.obstacle = {1, 1, 1, 1};
    const StepBoundary b = together(s, {moving({2, 4, 6}, 2)});
    EXPECT_TRUE(b.axes.empty());
    EXPECT_EQ(b.num_prescribed, 4);
    expect_near(b.path[0][1], {1, 2, 0});
}

}  // namespace
}  // namespace noli
