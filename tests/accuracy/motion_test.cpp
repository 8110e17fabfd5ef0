// SPDX-License-Identifier: Apache-2.0
/// Bodies that nothing touches: their centres of mass obey the integrator's own
/// recurrence for a point, whatever they are made of, since inner forces add up to
/// nothing.

#include "check.hpp"
#include "discrete.hpp"

namespace noli::accuracy {
namespace {

constexpr int kStepsOfFlight = 20;

/// A point from rest at x = 0 under a, with mass damping alpha.
Discrete<double> point_after(
    const Case& at, int steps, double v, double a, double alpha = 0) {
    Discrete<double> point(at.integrator, at.dt, 0.0, v, a);
    for (int k = 0; k < steps; ++k)
        fall(point, a, at.dt, alpha);
    return point;
}

void expect_flight(
    Lab& lab, const Motion& from, int steps, const Vector3& v, const Vector3& a) {
    Vector3 speed{};
    Vector3 way{};
    Vector3 gone{};
    const Motion now = lab.motion();
    for (std::size_t k = 0; k < 3; ++k) {
        const Discrete<double> point = point_after(lab.at, steps, v[k], a[k]);
        speed[k] = point.v;
        way[k] = point.x;
        gone[k] = now.x[k] - from.x[k];
    }
    lab.expect_vector("velocity", speed, now.v, norm(speed));
    lab.expect_vector("distance", way, gone, norm(way));
}

void fly(Lab& lab, Scene scene, const Vector3& v, const Vector3& a) {
    scene.bodies[0].velocity = v;
    if (!lab.start(scene)) return;
    const Motion from = lab.motion();
    if (lab.run(kStepsOfFlight)) expect_flight(lab, from, kStepsOfFlight, v, a);
}

TEST(Flight, FreeFall) {
    // v_n = -n g dt for every integrator; the distance by its recurrence.
    check({"free fall",
           "v = g t",
           "none",
           {},
           Cover::Pairs,
           [](Lab& lab) {
               Scene scene = lab.scene();
               scene.bodies = {lab.block("block", {})};
               fly(lab, scene, {0, 0, 0}, {0, -kGravity, 0});
           },
           8});
}

TEST(Flight, LargeMeshFalls) {
    Domain domain;
    domain.meshes = {3};
    domain.sizes = {0.1};
    domain.steps = {1e-2};
    domain.presets = {"soft_tissue", "rubber", "steel"};
    check({"free fall, 4913 vertices",
           "v = g t",
           "none",
           domain,
           Cover::Values,
           [](Lab& lab) {
               Scene scene = lab.scene();
               scene.bodies = {lab.block("block", {})};
               scene.solver.integrator = lab.at.integrator;
               if (!lab.start(scene)) return;
               const Motion from = lab.motion();
               if (lab.run(5)) expect_flight(lab, from, 5, {0, 0, 0}, {0, -kGravity, 0});
           }});
}

TEST(Flight, BallFalls) {
    check({"free fall of a ball", "v = g t", "none", {}, Cover::Pairs, [](Lab& lab) {
               Scene scene = lab.scene();
               scene.bodies = {lab.ball("ball", {})};
               fly(lab, scene, {0, 0, 0}, {0, -kGravity, 0});
           }});
}

TEST(Flight, Projectile) {
    check({"projectile",
           "v = v0 + g t, x = v0 t + g t^2/2 in the integrator's discrete form",
           "none",
           {},
           Cover::Pairs,
           [](Lab& lab) {
               Scene scene = lab.scene();
               scene.bodies = {lab.block("block", {})};
               fly(lab, scene, {3, 4, -1}, {0, -kGravity, 0});
           }});
}

TEST(Flight, KeepsItsVelocityWithoutForces) {
    check({"flight without forces", "v = v0", "none", {}, Cover::Pairs, [](Lab& lab) {
               Scene scene = lab.scene();
               scene.gravity = {0, 0, 0};
               scene.bodies = {lab.block("block", {})};
               const double L = lab.size();
               fly(lab, scene, {L, -2 * L, 0.5 * L}, {0, 0, 0});
           }});
}

TEST(Flight, GravityMayPointAnywhere) {
    check(
        {"free fall across the axes", "v = g t", "none", {}, Cover::Pairs, [](Lab& lab) {
             Scene scene = lab.scene();
             scene.gravity = {3, -5, 7};
             scene.bodies = {lab.block("block", placed({0, 0, 0}, 0.7))};
             fly(lab, scene, {0, 0, 0}, {3, -5, 7});
         }});
}

TEST(Flight, AppliedAcceleration) {
    // Active in the first half of the run, so v = a t/2 afterwards.
    check({"applied acceleration",
           "v = a t while it acts",
           "none",
           {},
           Cover::Pairs,
           [](Lab& lab) {
               Scene scene = lab.scene();
               scene.gravity = {0, 0, 0};
               Body block = lab.block("block", {});
               auto push = condition(BoundaryCondition::Kind::Acceleration, {2, 0, -1});
               push.t_end = 9.5 * lab.at.dt;
               block.boundary = {push};
               scene.bodies = {block};
               if (!lab.start(scene) || !lab.run(20)) return;
               Vector3 expected{};
               for (std::size_t k = 0; k < 3; ++k) {
                   Discrete<double> point(
                       lab.at.integrator, lab.at.dt, 0.0, 0.0, push.linear[k]);
                   for (int n = 0; n < 20; ++n)
                       fall(point, n < 10 ? push.linear[k] : 0.0, lab.at.dt);
                   expected[k] = point.v;
               }
               lab.expect_vector("velocity", expected, lab.motion().v, norm(expected));
           }});
}

TEST(Flight, ForceOnOneFace) {
    // The centre of mass of any body obeys F = m a. The push is so weak that it strains
    // the body by at most 1 %.
    check({"force on one face", "v = F t / m", "none", {}, Cover::Pairs, [](Lab& lab) {
               Scene scene = lab.scene();
               scene.gravity = {0, 0, 0};
               Body block = lab.block("block", {});
               const double L = lab.size();
               const double a = std::min(
                   kGravity, 0.01 * lab.material.young / (lab.material.density * L));
               const double mass = lab.material.density * L * L * L;
               auto push = condition(BoundaryCondition::Kind::Force, {mass * a, 0, 0});
               push.selection = part({1, 0, 0}, {1, 1, 1});
               block.boundary = {push};
               scene.bodies = {block};
               if (!lab.start(scene)) return;
               const Motion from = lab.motion();
               if (lab.run(20)) expect_flight(lab, from, 20, {0, 0, 0}, {a, 0, 0});
           }});
}

TEST(Flight, HeldThenReleased) {
    check(
        {"held, then released", "v = g (t - t0)", "none", {}, Cover::Pairs, [](Lab& lab) {
             Scene scene = lab.scene();
             Body block = lab.block("block", {});
             auto hold = condition(BoundaryCondition::Kind::Fixed);
             hold.t_end = 4.5 * lab.at.dt;
             block.boundary = {hold};
             scene.bodies = {block};
             if (!lab.start(scene) || !lab.run(20)) return;
             // Newmark starts from the acceleration of the held body, which is 0, and
             // BDF2 from positions at rest.
             Discrete<double> point(lab.at.integrator, lab.at.dt, 0.0, 0.0, 0.0);
             for (int n = 0; n < 20; ++n)
                 if (n < 5)
                     point.accept(0.0);
                 else
                     fall(point, -kGravity, lab.at.dt);
             lab.expect("velocity", point.v, lab.motion().v[1]);
         }});
}

TEST(Flight, FarApartBodiesFallAlike) {
    // Each of two cubes 300 m apart keeps its volume and falls.
    Domain domain;
    domain.sizes = {1e-3, 1e-2, 0.1, 1.0};
    check({"two cubes 300 m apart",
           "v = g t, volume kept",
           "none",
           domain,
           Cover::Values,
           [](Lab& lab) {
               Scene scene = lab.scene();
               scene.bodies = {lab.block("near", {}),
                               lab.block("far", placed({300, 0, 0}))};
               if (!lab.start(scene) || !lab.run(10)) return;
               const double L = lab.size();
               const std::vector<Vector3> x = lab.simulator().positions();
               for (const int body : {0, 1}) {
                   lab.expect(
                       "velocity", -10 * kGravity * lab.at.dt, lab.motion(body).v[1]);
                   double low = HUGE_VAL;
                   double high = -HUGE_VAL;
                   for (const std::size_t v : lab.vertices(body)) {
                       low = std::min(low, x[v][0]);
                       high = std::max(high, x[v][0]);
                   }
                   lab.expect("width", L, high - low);
               }
           }});
}

/// Falls at `far` from the origin.
void expect_fall_far_away(const char* name, double far) {
    Domain domain;
    // Positions there are known to 2e-16 of the distance only: velocities of a step to
    // that over dt, which must be well below g dt.
    domain.holds = [=](const Case& at) {
        return 2.3e-16 * far / at.dt < 1e-3 * kGravity * at.dt && at.size > 1e-9 * far;
    };
    check({name,
           "v = g t",
           "rounding of the positions over dt",
           domain,
           Cover::Values,
           [far](Lab& lab) {
               Scene scene = lab.scene();
               scene.bodies = {lab.block("block", placed({far, -far, 0.5 * far}))};
               if (!lab.start(scene) || !lab.run(20)) return;
               lab.expect("velocity", -20 * kGravity * lab.at.dt, lab.motion().v[1]);
           }});
}

TEST(Flight, TenKilometresAway) {
    expect_fall_far_away("free fall 1e4 m from the origin", 1e4);
}
TEST(Flight, AThousandKilometresAway) {
    expect_fall_far_away("free fall 1e6 m from the origin", 1e6);
}

TEST(Damping, MassDampingIsExactInItsDiscreteForm) {
    check({"decay by mass damping",
           "v = v0 exp(-alpha t) in the integrator's discrete form",
           "none: the discrete form is expected",
           {},
           Cover::Pairs,
           [](Lab& lab) {
               Scene scene = lab.scene();
               scene.gravity = {0, 0, 0};
               scene.damping.mass = 0.1 / lab.at.dt;
               Body block = lab.block("block", {});
               block.velocity = {3 * lab.size(), 0, 0};
               scene.bodies = {block};
               if (!lab.start(scene) || !lab.run(10)) return;
               const double v0 = block.velocity[0];
               const double v = point_after(lab.at, 10, v0, 0.0, scene.damping.mass).v;
               lab.expect("velocity", v, lab.motion().v[0]);
           }});
}

TEST(Damping, TerminalSpeed) {
    check({"terminal speed under mass damping",
           "v = g / alpha",
           "none",
           {},
           Cover::Pairs,
           [](Lab& lab) {
               Scene scene = lab.scene();
               scene.damping.mass = 0.5 / lab.at.dt;
               scene.bodies = {lab.block("block", {})};
               if (!lab.start(scene) || !lab.run(40)) return;
               lab.expect("velocity", -kGravity / scene.damping.mass, lab.motion().v[1]);
           }});
}

}  // namespace
}  // namespace noli::accuracy
