// SPDX-License-Identifier: Apache-2.0
/// Bodies that meet or part. Contact forces are equal and opposite, so momentum stays
/// whatever the materials do; nothing puts energy in, so energy never grows.

#include "check.hpp"
#include "discrete.hpp"

namespace noli::accuracy {
namespace {

/// An impact that strains bodies by about 2 % and moves them a fifth of their size a
/// step.
double impact_speed(const Lab& lab) {
    return std::min(0.02 * sound_speed(lab.material), 0.2 * lab.size() / lab.at.dt);
}

Vector3 momentum(Lab& lab) {
    return lab.simulator().balance().linear;
}

/// Runs a scene without outer forces; momentum stays, energy does not grow.
void meet(Lab& lab, const Scene& scene, int steps) {
    if (!lab.start(scene)) return;
    const Vector3 before = momentum(lab);
    const Motion left = lab.motion(0);
    const double scale = left.mass * norm(left.v);
    const double energy = lab.energy();
    double highest = energy;
    int touched = 0;
    const auto watch = [&](const StepReport& report) {
        highest = std::max(highest, lab.energy());
        touched += report.contacts > 0 ? 1 : 0;
    };
    if (!lab.run(steps, watch)) return;
    lab.expect_vector("momentum", before, momentum(lab), scale);
    lab.expect_at_most("energy", energy, highest, energy);
    if (touched == 0) lab.failed = "the bodies did not meet";
}

/// Half of a gap of six steps of an approach with twice the speed, and more than dhat.
double half_gap(const Lab& lab, double speed) {
    return 3.0 * speed * lab.at.dt + 0.003 * lab.size();
}

/// Where bodies with gaps of `slack` sizes at most meet within 15 steps at impact_speed.
Domain meeting(double slack) {
    Domain domain;
    domain.holds = [=](const Case& at) {
        return 8 * 0.02 * sound_speed(preset(at.preset)) * at.dt >= slack * at.size;
    };
    return domain;
}

const char* const kMeetAnswer = "momentum kept, energy never grows";

TEST(Collision, EqualCubesHeadOn) {
    check({"two cubes head-on",
           kMeetAnswer,
           "none",
           meeting(0.006),
           Cover::Pairs,
           [](Lab& lab) {
               const double v = impact_speed(lab);
               const double at = 0.5 * lab.size() + half_gap(lab, v);
               Scene scene = lab.scene();
               scene.gravity = {0, 0, 0};
               Body left = lab.block("left", placed({-at, 0, 0}));
               Body right = lab.block("right", placed({at, 0, 0}));
               left.velocity = {v, 0, 0};
               right.velocity = {-v, 0, 0};
               scene.bodies = {left, right};
               meet(lab, scene, 15);
           }});
}

TEST(Collision, UnequalCubes) {
    check({"a cube runs into a resting one of another material",
           kMeetAnswer,
           "none",
           meeting(0.012),
           Cover::Pairs,
           [](Lab& lab) {
               const double v = impact_speed(lab);
               const double at = 0.5 * lab.size() + half_gap(lab, 0.5 * v);
               Scene scene = lab.scene();
               scene.gravity = {0, 0, 0};
               Body left = lab.block("left", placed({-at, 0, 0}));
               Body right = lab.block("right", placed({at, 0.3 * lab.size(), 0}));
               left.velocity = {v, 0, 0};
               right.material = preset(lab.at.preset == "cork" ? "concrete" : "cork");
               scene.bodies = {left, right};
               meet(lab, scene, 15);
           }});
}

TEST(Collision, PlatesInFreeSpace) {
    check({"two plates meet flat",
           kMeetAnswer,
           "none",
           meeting(0.024),
           Cover::Pairs,
           [](Lab& lab) {
               const double v = 0.25 * impact_speed(lab);
               const double at = 0.05 * lab.size() + half_gap(lab, v);
               Scene scene = lab.scene();
               scene.gravity = {0, 0, 0};
               Body lower = lab.block("lower", placed({0, -at, 0}), {1, 0.1, 1});
               Body upper = lab.block("upper", placed({0, at, 0}), {1, 0.1, 1});
               lower.velocity = {0, 2 * v, 0};
               scene.bodies = {lower, upper};
               meet(lab, scene, 15);
           }});
}

TEST(Collision, BallsOffCentre) {
    Domain domain = meeting(0.1);
    domain.meshes = {0, 1};
    check({"two balls meet off centre",
           kMeetAnswer,
           "none",
           domain,
           Cover::Pairs,
           [](Lab& lab) {
               const double v = impact_speed(lab);
               const double at = 0.5 * lab.size() + half_gap(lab, v);
               Scene scene = lab.scene();
               scene.gravity = {0, 0, 0};
               Body left = lab.ball("left", placed({-at, 0, 0}));
               Body right =
                   lab.ball("right", placed({at, 0.2 * lab.size(), 0.1 * lab.size()}));
               left.velocity = {v, 0, 0};
               right.velocity = {-v, 0, 0};
               scene.bodies = {left, right};
               meet(lab, scene, 15);
           }});
}

TEST(Collision, PassingByLeavesNoTrace) {
    // Farther apart than dhat nothing acts.
    check({"two cubes pass at a distance",
           "v = v0",
           "none",
           {},
           Cover::Pairs,
           [](Lab& lab) {
               const double L = lab.size();
               const double v = 0.2 * L / lab.at.dt;
               Scene scene = lab.scene();
               scene.gravity = {0, 0, 0};
               Body left = lab.block("left", placed({-2 * L, 0, 0}));
               Body right = lab.block("right", placed({2 * L, 1.05 * L, 0}));
               left.velocity = {v, 0, 0};
               right.velocity = {-v, 0, 0};
               scene.bodies = {left, right};
               if (!lab.start(scene) || !lab.run(20)) return;
               lab.expect_vector("velocity", left.velocity, lab.motion(0).v, v);
           }});
}

/// dhat of a scene, m.
double dhat_of(Lab& lab, const Scene& scene) {
    return lab.start(scene) ? lab.simulator().resolved().dhat : 0.0;
}

TEST(Collision, BlocksThatStartNearFlyApart) {
    // In the first step they leave the reach of the barrier, and an implicit step feels
    // contact at its end only: they keep their speed exactly.
    check({"two cubes fly apart from half of dhat",
           "v = v0",
           "none: a step takes them out of reach",
           {},
           Cover::Pairs,
           [](Lab& lab) {
               const double L = lab.size();
               const double v = 0.02 * L / lab.at.dt;
               Scene scene = lab.scene();
               scene.gravity = {0, 0, 0};
               Body left = lab.block("left", placed({-0.5 * L, 0, 0}));
               Body right = lab.block("right", placed({0.6 * L, 0, 0}));
               left.velocity = {-v, 0, 0};
               right.velocity = {v, 0, 0};
               scene.bodies = {left, right};
               const double dhat = dhat_of(lab, scene);
               scene.bodies[1].transform = placed({0.5 * L + 0.5 * dhat, 0, 0});
               const double energy = [&] {
                   return lab.start(scene) ? lab.energy() : 0.0;
               }();
               if (!lab.run(20)) return;
               lab.expect("left", -v, lab.motion(0).v[0]);
               lab.expect("right", v, lab.motion(1).v[0]);
               lab.expect_at_most("energy", energy, lab.energy(), energy);
           },
           8});
}

/// A body that starts within dhat of a plane and leaves it slowly: the barrier pushes it,
/// as much as kappa of each step says. In the rigid limit that is one equation per step.
/// For that, sound must cross the body many times a step: its elasticity then takes part
/// with the square of size / (c dt), below 1 %.
void leave_plane(Lab& lab, const Vector3& gravity, double v) {
    const double L = lab.size();
    Scene scene = lab.scene();
    scene.gravity = gravity;
    scene.half_spaces = {plane(0.0)};
    scene.bodies = {lab.block("block", placed({0, L, 0}))};
    const double dhat = dhat_of(lab, scene);
    scene.bodies[0].transform = placed({0, 0.5 * L + 0.7 * dhat, 0});
    scene.bodies[0].velocity = {0, v, 0};
    if (!lab.start(scene)) return;
    const double mass = lab.motion().mass;
    const double n = (lab.cells() + 1) * (lab.cells() + 1);
    const double start = lab.motion().x[1];
    Discrete<double> point(lab.at.integrator, lab.at.dt, 0.7 * dhat, v, gravity[1]);
    const auto follow = [&](const StepReport& report) {
        press(point, gravity[1], n * report.kappa / mass, dhat);
    };
    if (!lab.run(20, follow)) return;
    const double way = point.x - 0.7 * dhat;
    lab.expect("distance", way, lab.motion().x[1] - start);
    lab.expect("velocity", point.v, lab.motion().v[1]);
}

TEST(Collision, BlockLeavesAWallSlowly) {
    Domain domain;
    domain.meshes = {0};
    domain.holds = [](const Case& at) {
        return sound_speed(preset(at.preset)) * at.dt > 10 * at.size;
    };
    check({"a block leaves a wall from 0.7 dhat",
           "v0 and the push of the barrier, solved as one equation a step",
           "elasticity of the block, (size / c dt)^2 below 1 %",
           domain,
           Cover::Pairs,
           [](Lab& lab) {
               leave_plane(lab, {0, 0, 0}, 2e-4 * lab.size() / lab.at.dt);
           }});
}

TEST(Collision, BlockUnderACeilingFalls) {
    Domain domain;
    domain.meshes = {0};
    domain.holds = [](const Case& at) {
        return sound_speed(preset(at.preset)) * at.dt > 10 * at.size;
    };
    check({"a block falls from a ceiling, from 0.7 dhat",
           "v = g t and the push of the barrier, solved as one equation a step",
           "elasticity of the block, (size / c dt)^2 below 1 %",
           domain,
           Cover::Pairs,
           [](Lab& lab) {
               leave_plane(lab, {0, kGravity, 0}, 0.0);
           }});
}

TEST(Collision, ImpulseOfAWall) {
    // The impulse of the contact force is the change of momentum: a body in contact takes
    // implicit Euler, m (v' - v) = dt F'.
    check({"impulse of a wall on a ball",
           "sum of F dt = change of m v",
           "none",
           meeting(0.1),
           Cover::Pairs,
           [](Lab& lab) {
               const double v = impact_speed(lab);
               Scene scene = lab.scene();
               scene.gravity = {0, 0, 0};
               scene.half_spaces = {plane(0.0)};
               Body ball = lab.ball(
                   "ball", placed({0, 0.5 * lab.size() + 2 * half_gap(lab, v), 0}));
               ball.velocity = {0.5 * v, -2 * v, 0};
               scene.bodies = {ball};
               if (!lab.start(scene)) return;
               const Motion before = lab.motion();
               double impulse = 0.0;
               const auto watch = [&](const StepReport&) {
                   impulse += lab.at.dt * lab.force(lab.vertices(0))[1];
               };
               if (!lab.run(15, watch)) return;
               const double change = before.mass * (lab.motion().v[1] - before.v[1]);
               lab.expect("impulse", change, impulse, before.mass * 2 * v);
               if (!(impulse > 0.0)) lab.failed = "the ball did not meet the wall";
           }});
}

TEST(Collision, DropOnTheFloorNeverGainsEnergy) {
    check({"a block drops on the floor",
           "energy never grows",
           "none",
           {},
           Cover::Pairs,
           [](Lab& lab) {
               const double L = lab.size();
               const double fall_time =
                   std::min(8 * lab.at.dt, std::sqrt(2 * L / kGravity));
               const double height = 0.5 * kGravity * fall_time * fall_time;
               Scene scene = lab.scene();
               scene.half_spaces = {plane(0.0)};
               scene.bodies = {lab.block("block", placed({0, 0.5 * L, 0}))};
               const double dhat = dhat_of(lab, scene);
               scene.bodies[0].transform = placed({0, 0.5 * L + dhat + height, 0});
               if (!lab.start(scene)) return;
               const double energy = lab.energy();
               const double work = lab.motion().mass * kGravity * height;
               double highest = energy;
               int touched = 0;
               const auto watch = [&](const StepReport& report) {
                   highest = std::max(highest, lab.energy());
                   touched += report.contacts > 0 ? 1 : 0;
               };
               if (!lab.run(40, watch)) return;
               lab.expect_at_most("energy", energy, highest, work);
               if (touched == 0) lab.failed = "the block did not land";
           },
           8});
}

}  // namespace
}  // namespace noli::accuracy
