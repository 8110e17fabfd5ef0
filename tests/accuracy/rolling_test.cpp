// SPDX-License-Identifier: Apache-2.0
/// Balls that slip and roll. A mesh of a ball is a polyhedron, which the answers of round
/// bodies do not describe; each row says what remains true for it.

#include "check.hpp"
#include "discrete.hpp"
#include "settle.hpp"

namespace noli::accuracy {
namespace {

/// Mass, moment of inertia about z, lowest point.
struct BallData {
    double mass = 0.0, inertia = 0.0, low = HUGE_VAL;
};

BallData measure(Lab& lab) {
    BallData out;
    const Motion at = lab.motion();
    const auto mass = lab.simulator().topology().mass;
    const std::vector<Vector3> x = lab.simulator().positions();
    out.mass = at.mass;
    for (std::size_t v = 0; v < x.size(); ++v) {
        const double a = x[v][0] - at.x[0];
        const double b = x[v][1] - at.x[1];
        out.inertia += mass[v] * (a * a + b * b);
        out.low = std::min(out.low, x[v][1] - at.x[1]);
    }
    return out;
}

/// A ball half of dhat above a plane of slope `angle`.
bool start_ball(Lab& lab, double angle, double mu, double speed) {
    Scene scene = lab.scene();
    scene.gravity = {kGravity * std::sin(angle), -kGravity * std::cos(angle), 0};
    scene.half_spaces = {plane(mu)};
    scene.bodies = {lab.ball("ball", placed({0, lab.size(), 0}))};
    if (!lab.start(scene)) return false;
    const BallData data = measure(lab);
    const double gap = lab.resting_gap(data.mass, 1);
    scene.bodies[0].transform = placed({0, gap - data.low, 0});
    scene.bodies[0].velocity = {speed, 0, 0};
    return lab.start(scene);
}

TEST(Rolling, SlippingBallObeysCoulomb) {
    // While the ball slips, friction is mu times the normal force, whatever its shape:
    // the loss of m v_x is mu times the gain of m v_y plus weight times time. Lasts v0 /
    // (mu g (1 + m R^2 / I)) = v0 / (3.5 mu g) for a round ball; the run ends at half of
    // that.
    Domain domain = settling(1.0);
    domain.integrators = {Integrator::ImplicitEuler};
    domain.meshes = {1, 2};
    check({"a ball slips before it rolls, mu 0.2",
           "m dv_x = -mu (m g t + m dv_y)",
           "dt: the last step's share, none for implicit Euler",
           domain,
           Cover::Values,
           [](Lab& lab) {
               const double mu = 0.2;
               const double v0 = 60 * mu * kGravity * lab.at.dt;
               if (!start_ball(lab, 0.0, mu, v0) || !lab.run(8)) return;
               const Motion now = lab.motion();
               const double lost = mu * (8 * kGravity * lab.at.dt + now.v[1]);
               lab.expect("change of velocity", -lost, now.v[0] - v0);
           }});
}

/// Distance that a ball rolls down a slope of sin 0.1 in 40 steps from rest.
double roll(Lab& lab) {
    if (!start_ball(lab, std::asin(0.1), 0.5, 0.0)) return 0.0;
    const double from = lab.motion().x[0];
    return lab.run(40) ? lab.motion().x[0] - from : 0.0;
}

/// And that of a round body of the same mass, inertia and radius.
double roll_if_round(Lab& lab) {
    const BallData data = measure(lab);
    const double a =
        0.1 * kGravity / (1 + data.inertia / (data.mass * data.low * data.low));
    Discrete<double> point(lab.at.integrator, lab.at.dt, 0.0, 0.0, a);
    for (int k = 0; k < 40; ++k)
        fall(point, a, lab.at.dt);
    return point.x;
}

TEST(Rolling, BallDownASlope) {
    // A polyhedron that starts on a vertex tips onto a facet, rocks and loses energy at
    // each edge: 5/7 g sin is that of a round ball. What is asked here: tightening moves
    // nothing.
    Domain domain = settling(1.0);
    domain.integrators = {Integrator::ImplicitEuler};
    domain.meshes = {1, 2};
    domain.holds = [holds = domain.holds](const Case& at) {
        // 40 steps shall be about the time of a turn.
        return holds(at) && kGravity * at.dt * at.dt * 80 < 3.0 * at.size;
    };
    check({"a ball rolls down a slope, sin 0.1",
           "the same mesh to convergence; round: a = g sin / (1 + I/mR^2)",
           "the mesh is a polyhedron: it tips from edge to edge",
           domain,
           Cover::Values,
           [](Lab& lab) {
               Lab exact(lab.at, true);
               const double converged = roll(exact);
               const double found = roll(lab);
               if (!exact.failed.empty()) lab.failed = "tight run: " + exact.failed;
               if (!lab.failed.empty()) return;
               lab.expect("distance", converged, found, roll_if_round(lab));
           },
           1000});
}

}  // namespace
}  // namespace noli::accuracy
