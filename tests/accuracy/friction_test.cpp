// SPDX-License-Identifier: Apache-2.0
/// Blocks that slide, stick and stop. The answers are those of a point under Coulomb's
/// law as it is smoothed here (epsv), in the integrator's own discrete form
/// (discrete.hpp): the normal force of a block that stays down is m g cos in every step.

#include "check.hpp"
#include "discrete.hpp"
#include "settle.hpp"

namespace noli::accuracy {
namespace {

constexpr int kSlideSteps = 25;

/// Where a block is a point. Its weight strains it by at most 3 %. Sound crosses it four
/// times a step: it starts unstrained, and while its weight travels up it presses less.
/// The way that g would take it in the time of the run is 10 times dhat (1.7e-3 sizes):
/// within dhat the barrier decides, not the plane. OfABlockThatBounces has limits of its
/// own.
Domain blocks(double height = 1.0) {
    Domain domain;
    domain.holds = [=](const Case& at) {
        const Material m = preset(at.preset);
        const double time = kSlideSteps * at.dt;
        return m.density * kGravity * height * at.size <= 0.03 * m.young
            && sound_speed(m) * at.dt >= 4 * height * at.size
            && 0.5 * kGravity * time * time >= 10 * 1.7e-3 * height * at.size;
    };
    return domain;
}

/// A block on a plane of slope `angle` (gravity is turned). It starts where the barrier
/// carries it, or at a share of dhat.
bool start_on_slope(
    Lab& lab, double angle, double mu, double speed, double gap_ratio = 0) {
    Scene scene = lab.scene();
    scene.gravity = {kGravity * std::sin(angle), -kGravity * std::cos(angle), 0};
    scene.half_spaces = {plane(mu)};
    scene.bodies = {lab.block("block", placed({0, lab.size(), 0}))};
    if (!lab.start(scene)) return false;
    const double gap = gap_ratio > 0 ? gap_ratio * lab.simulator().resolved().dhat
                                     : lab.resting_gap(lab.motion().mass,
                                                       lab.vertices_of_face(),
                                                       kGravity * std::cos(angle));
    scene.bodies[0].transform = placed({0, 0.5 * lab.size() + gap, 0});
    scene.bodies[0].velocity = {speed, 0, 0};
    return lab.start(scene);
}

/// Runs the block and the point that it is side by side. Drive and weight in m/s^2 along
/// `down` and across it, along `up`. Within dhat the barrier decides how high the block
/// is, so the point is given the block's own height: what friction is held against is
/// the normal force that this height needs. Rest.* say that it carries the weight.
class Sliding {
  public:
    Sliding(Lab& lab, double drive, double weight, double mu, double v)
        : lab_(lab),
          slider_(lab.at.integrator, lab.at.dt, v, drive, weight),
          mu_(mu),
          from_(lab.motion(0).x) {}

    void belt(double speed) { belt_ = speed; }
    void tilted(const Vector3& up) { up_ = up; }

    bool run(int steps) {
        const double epsv = lab_.simulator().resolved().epsv;
        return lab_.run(steps, [&](const StepReport& report) {
            const Vector3 x = lab_.motion(0).x;
            double height = 0.0;
            for (std::size_t k = 0; k < 3; ++k)
                height += up_[k] * (x[k] - from_[k]);
            const bool touches = report.contacts > 0;
            slider_.step(mu_, epsv, belt_, height, touches || touched_);
            touched_ = touches;
        });
    }
    [[nodiscard]] const Discrete<double>& point() const { return slider_.along; }
    /// The block may rock by dhat over its length, and its centre, half of that above the
    /// base, goes dhat / 2 while the base sticks: the model's own error, m.
    [[nodiscard]] double rocking() const {
        return 0.5 * lab_.simulator().resolved().dhat;
    }
    /// The same as a share of a distance, and of a speed over the run.
    [[nodiscard]] double of_way(double way) const { return rocking() / std::abs(way); }
    [[nodiscard]] double of_speed(double speed) const {
        return rocking() / (lab_.steps * lab_.at.dt * std::abs(speed));
    }

  private:
    Lab& lab_;
    Slider slider_;
    double mu_, belt_ = 0.0;
    Vector3 from_, up_{0, 1, 0};
    bool touched_ = true;  // at the end of the last step
};

/// A block that friction holds creeps, below epsv. What counts is how that compares with
/// the speed at which its drive (m/s^2) would take it away.
void expect_creep(Lab& lab, double creep, double found, double epsv, double drive) {
    lab.expect_at_most("creep against epsv", epsv, found, epsv);
    lab.expect("creep", creep, found, drive * lab.steps * lab.at.dt);
}

const char* const kSlideOwn =
    "epsv and dt are part of the answer; rocking within dhat, dhat/2 of the way";

TEST(Friction, SlidesDownASlope) {
    // tan = 0.5, mu = 0.3: a = g (sin - mu cos).
    check({"a block slides down a slope, tan 0.5, mu 0.3",
           "a = g (sin - mu cos)",
           kSlideOwn,
           blocks(),
           Cover::Pairs,
           [](Lab& lab) {
               const double angle = std::atan(0.5);
               const double drive = kGravity * std::sin(angle);
               const double weight = kGravity * std::cos(angle);
               if (!start_on_slope(lab, angle, 0.3, 0.0)) return;
               Sliding block(lab, drive, weight, 0.3, 0.0);
               if (!block.run(kSlideSteps)) return;
               const Discrete<double>& at = block.point();
               lab.expect("velocity", at.v, lab.motion().v[0], 0.0, block.of_speed(at.v));
               lab.expect("distance", at.x, lab.motion().x[0], 0.0, block.of_way(at.x));
           },
           8});
}

TEST(Friction, SlidesWithinAHairOfSticking) {
    // mu = 0.45: a tenth of gravity's pull is left, so errors of the normal force count
    // nine times.
    check(
        {"a block slides down a slope, tan 0.5, mu 0.45",
         "a = g (sin - mu cos)",
         "epsv and dt are part of the answer; 1 % is of g sin t, since the answer is the "
         "small difference of drive and friction",
         blocks(),
         Cover::Pairs,
         [](Lab& lab) {
             const double angle = std::atan(0.5);
             const double drive = kGravity * std::sin(angle);
             const double weight = kGravity * std::cos(angle);
             if (!start_on_slope(lab, angle, 0.45, 0.0)) return;
             Sliding block(lab, drive, weight, 0.45, 0.0);
             if (!block.run(kSlideSteps)) return;
             const double time = kSlideSteps * lab.at.dt;
             lab.expect("velocity",
                        block.point().v,
                        lab.motion().v[0],
                        drive * time,
                        block.of_speed(drive * time));
         }});
}

TEST(Friction, SticksOnASlope) {
    // Below epsv friction is mu N (2 y - y^2), y = v / epsv: the creep at which it holds
    // the block has 2 y - y^2 = tan / mu.
    check({"a block sticks on a slope, tan 0.5, mu 0.6",
           "creep epsv (1 - sqrt(1 - tan / mu))",
           "none; 1 % is of the speed without friction, and of epsv as a bound",
           settling(1.0),
           Cover::Pairs,
           [](Lab& lab) {
               const double angle = std::atan(0.5);
               if (!start_on_slope(lab, angle, 0.6, 0.0) || !lab.run(40)) return;
               const double from = lab.motion().x[0];
               if (!lab.run(20)) return;
               const double epsv = lab.simulator().resolved().epsv;
               const double creep = epsv * (1 - std::sqrt(1 - 0.5 / 0.6));
               const double found = (lab.motion().x[0] - from) / (20 * lab.at.dt);
               expect_creep(lab, creep, found, epsv, kGravity * std::sin(angle));
           }});
}

TEST(Friction, StoppingDistance) {
    // v0 = mu g 20 dt: the block stops after about 20 steps.
    check({"a block slides to a stop, mu 0.4",
           "x = v0^2 / (2 mu g) in discrete form",
           kSlideOwn,
           blocks(),
           Cover::Pairs,
           [](Lab& lab) {
               const double brake = 0.4 * kGravity;
               const double v0 = 20 * brake * lab.at.dt;
               if (!start_on_slope(lab, 0.0, 0.4, v0)) return;
               Sliding block(lab, 0.0, kGravity, 0.4, v0);
               if (!block.run(kSlideSteps)) return;
               const double way = block.point().x;
               lab.expect("distance", way, lab.motion().x[0], 0.0, block.of_way(way));
           },
           8});
}

TEST(Friction, TwoMetresPerSecondFromWithinDhat) {
    // The classic: 0.4999 m for implicit Euler at 10 ms.
    Domain domain = blocks();
    domain.sizes = {0.1, 1.0};
    domain.steps = {1e-2, 2e-2};
    domain.integrators = {Integrator::ImplicitEuler};
    check({"a block starts within dhat with 2 m/s, mu 0.4",
           "0.4999 m at 10 ms: x = v0^2 / (2 mu g) - v0 dt / 2",
           kSlideOwn,
           domain,
           Cover::Pairs,
           [](Lab& lab) {
               const double brake = 0.4 * kGravity;
               const int steps = static_cast<int>(2 / (brake * lab.at.dt)) + 5;
               if (!start_on_slope(lab, 0.0, 0.4, 2.0) || !lab.run(steps)) return;
               Slider slider(lab.at.integrator, lab.at.dt, 2.0, 0.0, kGravity);
               for (int k = 0; k < steps; ++k)
                   slider.step(0.4, lab.simulator().resolved().epsv);
               lab.expect("distance", slider.along.x, lab.motion().x[0]);
           }});
}

TEST(Friction, PulledHarderThanFrictionHolds) {
    // A pull of 0.8 m g on all of the block against mu 0.5.
    check({"a block pulled by 0.8 m g, mu 0.5",
           "a = F / m - mu g",
           kSlideOwn,
           blocks(),
           Cover::Pairs,
           [](Lab& lab) {
               const double L = lab.size();
               const double mass = lab.material.density * L * L * L;
               Scene scene = lab.scene();
               scene.half_spaces = {plane(0.5)};
               Body block = lab.block("block", placed({0, L, 0}));
               block.boundary = {condition(BoundaryCondition::Kind::Force,
                                           {0.8 * mass * kGravity, 0, 0})};
               scene.bodies = {block};
               if (!lab.start(scene)) return;
               const double gap = lab.resting_gap(mass, lab.vertices_of_face());
               scene.bodies[0].transform = placed({0, 0.5 * L + gap, 0});
               if (!lab.start(scene)) return;
               Sliding pulled(lab, 0.8 * kGravity, kGravity, 0.5, 0.0);
               if (!pulled.run(kSlideSteps)) return;
               const double v = pulled.point().v;
               lab.expect("velocity", v, lab.motion().v[0], 0.0, pulled.of_speed(v));
           }});
}

TEST(Friction, PulledTooWeakly) {
    // A pull of 0.3 m g against mu 0.5 creeps with 2 y - y^2 = 0.6.
    check({"a block pulled by 0.3 m g, mu 0.5",
           "creep epsv (1 - sqrt(1 - 0.6))",
           "none; 1 % is of the speed without friction, and of epsv as a bound",
           settling(1.0),
           Cover::Pairs,
           [](Lab& lab) {
               const double L = lab.size();
               const double mass = lab.material.density * L * L * L;
               Scene scene = lab.scene();
               scene.half_spaces = {plane(0.5)};
               Body block = lab.block("block", placed({0, L, 0}));
               block.boundary = {condition(BoundaryCondition::Kind::Force,
                                           {0.3 * mass * kGravity, 0, 0})};
               scene.bodies = {block};
               if (!lab.start(scene)) return;
               const double gap = lab.resting_gap(mass, lab.vertices_of_face());
               scene.bodies[0].transform = placed({0, 0.5 * L + gap, 0});
               if (!lab.start(scene) || !lab.run(40)) return;
               const double from = lab.motion().x[0];
               if (!lab.run(20)) return;
               const double epsv = lab.simulator().resolved().epsv;
               const double creep = epsv * (1 - std::sqrt(1 - 0.6));
               const double found = (lab.motion().x[0] - from) / (20 * lab.at.dt);
               expect_creep(lab, creep, found, epsv, 0.3 * kGravity);
           }});
}

TEST(Friction, OnAMovingBelt) {
    // A plate that moves under a resting block with 15 steps' worth of mu g drags it
    // along.
    Domain domain = blocks();
    domain.meshes = {0, 1};
    check({"a block on a moving belt, mu 0.4",
           "v = mu g t, then that of the belt",
           kSlideOwn,
           domain,
           Cover::Pairs,
           [](Lab& lab) {
               const double L = lab.size();
               const double brake = 0.4 * kGravity;
               // So slow that the block stays on the belt.
               const double speed = std::min(15 * brake * lab.at.dt, 0.1 * L / lab.at.dt);
               Scene scene = lab.scene();
               const double reach = 60 * speed * lab.at.dt + 4 * L;
               Body belt = lab.body(
                   "belt", "plane_surface", {{"width", {reach}}, {"depth", {4 * L}}});
               belt.friction = 0.4;
               belt.boundary = {
                   condition(BoundaryCondition::Kind::Velocity, {speed, 0, 0})};
               Body block = lab.block("block", placed({0.1 * L, L, 0.05 * L}));
               scene.bodies = {block, belt};
               if (!lab.start(scene)) return;
               const double gap =
                   lab.resting_gap(lab.motion(0).mass, lab.vertices_of_face());
               scene.bodies[0].transform = placed({0.1 * L, 0.5 * L + gap, 0.05 * L});
               if (!lab.start(scene)) return;
               Sliding dragged(lab, 0.0, kGravity, 0.4, 0.0);
               dragged.belt(speed);
               for (const int part : {10, 15}) {
                   if (!dragged.run(part)) return;
                   lab.expect("velocity at step " + std::to_string(lab.steps),
                              dragged.point().v,
                              lab.motion(0).v[0],
                              0.0,
                              dragged.of_speed(dragged.point().v));
               }
           }});
}

TEST(Friction, BlockOnABlockKeepsMomentum) {
    // The upper block slides on a lower one, which is free on a floor without friction:
    // they end with m1 v0 / (m1 + m2) = v0 / 3.
    Domain domain = blocks(1.5);
    domain.meshes = {0, 1};
    check(
        {"a block brakes on a free one twice as heavy",
         "v = v0 m1 / (m1 + m2), momentum kept",
         kSlideOwn,
         domain,
         Cover::Pairs,
         [](Lab& lab) {
             const double L = lab.size();
             const double slip =
                 0.5 * kGravity * 1.5;  // of the blocks against each other
             const double v0 = std::min(15 * slip * lab.at.dt, std::sqrt(0.6 * L * slip));
             Scene scene = lab.scene();
             Body lower = lab.block("lower", placed({0, L, 0}), {2, 1, 1});
             Body upper = lab.block("upper", placed({-0.5 * L, 3 * L, 0}), {1, 1, 0.999});
             upper.friction = 0.5;
             upper.velocity = {v0, 0, 0};
             scene.half_spaces = {plane(0.0)};
             scene.bodies = {lower, upper};
             if (!lab.start(scene)) return;
             const double gap = 0.5 * lab.simulator().resolved().dhat;
             scene.bodies[0].transform = placed({0, gap + 0.5 * L, 0});
             scene.bodies[1].transform = placed({-0.4 * L, 2 * gap + 1.5 * L, 0});
             if (!lab.start(scene)) return;
             const double m1 = lab.motion(1).mass;
             const double m2 = lab.motion(0).mass;
             if (!lab.run(90)) return;
             const Motion low = lab.motion(0);
             const Motion high = lab.motion(1);
             const double common = v0 * m1 / (m1 + m2);
             lab.expect("momentum", m1 * v0, m1 * high.v[0] + m2 * low.v[0]);
             lab.expect("upper velocity", common, high.v[0]);
             lab.expect("lower velocity", common, low.v[0]);
         }});
}

TEST(Friction, SlidesDownATiltedPlate) {
    // An obstacle and a block, both really tilted, gravity straight down.
    Domain domain = blocks();
    domain.meshes = {0, 1};
    check({"a block slides down a tilted obstacle, tan 0.5, mu 0.3",
           "a = g (sin - mu cos)",
           kSlideOwn,
           domain,
           Cover::Pairs,
           [](Lab& lab) {
               const double L = lab.size();
               const double angle = -std::atan(0.5);
               const double drive = kGravity * std::sin(-angle);
               const double weight = kGravity * std::cos(angle);
               const double time = kSlideSteps * lab.at.dt;
               const double reach = 2 * drive * time * time + 4 * L;
               const Vector3 up{-std::sin(angle), std::cos(angle), 0};
               const Vector3 down{std::cos(angle), std::sin(angle), 0};
               Scene scene = lab.scene();
               Body plate = lab.body("plate",
                                     "plane_surface",
                                     {{"width", {reach}}, {"depth", {4 * L}}},
                                     placed({0, 0, 0}, angle));
               plate.friction = 0.3;
               scene.bodies = {lab.block("block", placed({0, 3 * L, 0}, angle)), plate};
               if (!lab.start(scene)) return;
               const double height = 0.5 * L
                                   + lab.resting_gap(lab.motion(0).mass,
                                                     lab.vertices_of_face(),
                                                     kGravity * std::cos(angle));
               const double along = 0.17 * L;
               scene.bodies[0].transform = placed({height * up[0] + along * down[0],
                                                   height * up[1] + along * down[1],
                                                   0.05 * L},
                                                  angle);
               if (!lab.start(scene)) return;
               const Vector3 from = lab.motion(0).x;
               Sliding block(lab, drive, weight, 0.3, 0.0);
               block.tilted(up);
               if (!block.run(kSlideSteps)) return;
               const Motion now = lab.motion(0);
               const Discrete<double>& point = block.point();
               lab.expect("velocity",
                          point.v,
                          now.v[0] * down[0] + now.v[1] * down[1],
                          0.0,
                          block.of_speed(point.v));
               lab.expect("distance",
                          point.x,
                          (now.x[0] - from[0]) * down[0] + (now.x[1] - from[1]) * down[1],
                          0.0,
                          block.of_way(point.x));
           }});
}

TEST(Friction, OfABlockThatBounces) {
    // Starts at half of dhat, from where the barrier may throw it up. While it slides,
    // friction is mu times the normal force, and the motion of the centre of mass says
    // what that was in each step.
    Domain domain = blocks();
    domain.holds = [](const Case& at) {
        const Material m = preset(at.preset);
        // A point, not an elastic body whose base sticks while it shears: shear waves
        // cross it ten times a step, (size / c_s dt)^2 below 1 %.
        return m.density * kGravity * at.size <= 0.03 * m.young
            && sound_speed(m) / std::sqrt(2 * (1 + m.poisson)) * at.dt >= 10 * at.size;
    };
    check({"a block slides and bounces, tan 0.5, mu 0.3",
           "friction = mu times the normal force of the step, as the bounce shows it",
           kSlideOwn,
           domain,
           Cover::Pairs,
           [](Lab& lab) {
               const double angle = std::atan(0.5);
               if (!start_on_slope(lab, angle, 0.3, 0.0, 0.5)) return;
               Sliding block(
                   lab, kGravity * std::sin(angle), kGravity * std::cos(angle), 0.3, 0.0);
               if (!block.run(kSlideSteps)) return;
               const double v = block.point().v;
               lab.expect("velocity", v, lab.motion().v[0], 0.0, block.of_speed(v));
           }});
}

TEST(Friction, WithoutFrictionSlidesFreely) {
    check({"a block on a slope without friction",
           "a = g sin",
           "none",
           blocks(),
           Cover::Pairs,
           [](Lab& lab) {
               const double angle = std::atan(0.5);
               if (!start_on_slope(lab, angle, 0.0, 0.0) || !lab.run(kSlideSteps)) return;
               const double time = kSlideSteps * lab.at.dt;
               lab.expect(
                   "velocity", kGravity * std::sin(angle) * time, lab.motion().v[0]);
           }});
}

}  // namespace
}  // namespace noli::accuracy
