// SPDX-License-Identifier: Apache-2.0
/// Bodies that turn. Implicit Euler damps spin by itself: a stiff body that turned by D
/// in a step turns by atan2(sin D, 2 - cos D) in the next (discrete.hpp). That is the
/// answer here, since it is what the model says; BDF2 and Newmark lose less.

#include "check.hpp"
#include "discrete.hpp"

namespace noli::accuracy {
namespace {

constexpr double kDegree = 0.017453292519943295;

/// So slow that centrifugal strain, about rho w^2 L^2 / E, stays below 1e-4.
double safe_spin(const Lab& lab, double longest) {
    return std::min(90 * kDegree,
                    0.01 * sound_speed(lab.material) / (longest * lab.size()));
}

/// Where the spin is so slow that the default tolerance, 1e-3 to 1e-2 of the diagonal per
/// second, is more than a hundredth of it, nothing is promised.
bool spins_fast_enough(const Case& at, double longest) {
    return 0.01 * sound_speed(preset(at.preset)) / (longest * at.size) >= 90 * kDegree;
}

/// Angle about z and about the centre of mass since x0, of all vertices of body 0.
double turned(Lab& lab, const std::vector<Vector3>& x0) {
    const auto mass = lab.simulator().topology().mass;
    const std::vector<Vector3> x = lab.simulator().positions();
    Motion from;
    for (std::size_t v = 0; v < x0.size(); ++v) {
        from.mass += mass[v];
        for (std::size_t k = 0; k < 3; ++k)
            from.x[k] += mass[v] * x0[v][k];
    }
    for (double& c : from.x)
        c /= from.mass;
    const Motion to = lab.motion();
    double along = 0.0;
    double across = 0.0;
    for (std::size_t v = 0; v < x0.size(); ++v) {
        const double a = x0[v][0] - from.x[0];
        const double b = x0[v][1] - from.x[1];
        const double c = x[v][0] - to.x[0];
        const double d = x[v][1] - to.x[1];
        along += mass[v] * (a * c + b * d);
        across += mass[v] * (a * d - b * c);
    }
    return std::atan2(across, along);
}

/// Angular momentum about z and the centre of mass, kg m^2/s.
double momentum_about_centre(Lab& lab) {
    const Simulator::Balance balance = lab.simulator().balance();
    const Motion at = lab.motion();
    return balance.angular[2] - at.mass * (at.x[0] * at.v[1] - at.x[1] * at.v[0]);
}

void turn(Lab& lab, Scene scene, double omega, int steps) {
    scene.bodies[0].angular_velocity_deg = {0, 0, omega / kDegree};
    if (!lab.start(scene)) return;
    const std::vector<Vector3> x0 = lab.simulator().positions();
    const double before = momentum_about_centre(lab);
    if (!lab.run(steps)) return;
    Discrete<Complex> z(lab.at.integrator, lab.at.dt, {1, 0}, {0, omega});
    double angle = 0.0;
    for (int k = 0; k < steps; ++k) {
        const Complex last = z.x;
        spin(z);
        angle += std::arg(z.x / last);
    }
    lab.expect("angle", angle, turned(lab, x0));
    lab.expect("angular momentum",
               before * std::imag(std::conj(z.x) * z.v) / omega,
               momentum_about_centre(lab));
}

const char* const kSpinAnswer =
    "spin kept, less implicit Euler's own loss: D' = atan2(sin D, 2 - cos D) a step";
const char* const kSpinOwn = "centrifugal strain rho w^2 L^2/E, below 0.01 %";

Domain spinning(double longest) {
    Domain domain;
    domain.holds = [=](const Case& at) { return spins_fast_enough(at, longest); };
    return domain;
}

TEST(Spin, FreeCube) {
    check({"spin of a cube, 90 deg/s",
           kSpinAnswer,
           kSpinOwn,
           spinning(1.0),
           Cover::Pairs,
           [](Lab& lab) {
               Scene scene = lab.scene();
               scene.gravity = {0, 0, 0};
               scene.bodies = {lab.block("block", {})};
               turn(lab, scene, safe_spin(lab, 1.0), 30);
           },
           8});
}

TEST(Spin, FreeBall) {
    check({"spin of a ball",
           kSpinAnswer,
           kSpinOwn,
           spinning(1.0),
           Cover::Pairs,
           [](Lab& lab) {
               Scene scene = lab.scene();
               scene.gravity = {0, 0, 0};
               scene.bodies = {lab.ball("ball", {})};
               turn(lab, scene, safe_spin(lab, 1.0), 30);
           }});
}

TEST(Spin, BarEndOverEnd) {
    Domain domain = spinning(2.0);
    domain.meshes = {0, 1};
    check({"spin of a bar end over end",
           kSpinAnswer,
           kSpinOwn,
           domain,
           Cover::Pairs,
           [](Lab& lab) {
               Scene scene = lab.scene();
               scene.gravity = {0, 0, 0};
               scene.bodies = {lab.block("bar", {}, {2, 1, 1})};
               turn(lab, scene, safe_spin(lab, 2.0), 30);
           }});
}

TEST(Spin, StiffnessDampingLeavesSpinAlone) {
    check({"spin with stiffness damping",
           kSpinAnswer,
           kSpinOwn,
           spinning(1.0),
           Cover::Pairs,
           [](Lab& lab) {
               Scene scene = lab.scene();
               scene.gravity = {0, 0, 0};
               scene.damping.stiffness = 0.1 * lab.at.dt;
               scene.bodies = {lab.block("block", {})};
               turn(lab, scene, safe_spin(lab, 1.0), 30);
           }});
}

TEST(Spin, TumblingFlight) {
    // Gravity exerts no torque about the centre of mass.
    check({"spinning projectile",
           "parabola of the centre and spin kept, both in discrete form",
           kSpinOwn,
           spinning(1.0),
           Cover::Pairs,
           [](Lab& lab) {
               Scene scene = lab.scene();
               Body block = lab.block("block", {});
               block.velocity = {2, 3, 0};
               scene.bodies = {block};
               turn(lab, scene, safe_spin(lab, 1.0), 30);
               if (!lab.failed.empty()) return;
               Discrete<double> point(lab.at.integrator, lab.at.dt, 0, 3, -kGravity);
               for (int k = 0; k < 30; ++k)
                   fall(point, -kGravity, lab.at.dt);
               lab.expect("height", point.x, lab.motion().x[1], 90 * lab.at.dt);
           }});
}

/// A bar that hangs from one edge of its upper end. About the hinge x_i = z r_i + c with
/// c = 0 always; gravity enters through the first moment of mass. Newmark's first
/// acceleration is gravity alone, the hinge left out, which c carries along.
struct Swing {
    double angle = 0.0, widest = 0.0;  ///< rad, at the end and at most
};

Swing swing(Lab& lab, const std::vector<Complex>& r, int steps) {
    const auto mass = lab.simulator().topology().mass;
    double inertia = 0.0;
    Complex moment{};
    for (std::size_t v = 0; v < r.size(); ++v) {
        inertia += mass[v] * std::norm(r[v]);
        moment += mass[v] * std::conj(r[v]);
    }
    const Vector3 pull = lab.started().gravity;
    const Complex g{pull[0], pull[1]};
    Discrete<Complex> z(lab.at.integrator, lab.at.dt, {1, 0}, {}, {});
    Discrete<Complex> c(lab.at.integrator, lab.at.dt, {}, {}, g);
    Swing out;
    for (int k = 0; k < steps; ++k) {
        const Complex last = z.x;
        const Complex best = inertia * z.predicted({}) + moment * c.predicted(g);
        z.accept(best / std::abs(best));
        c.accept({});
        out.angle += std::arg(z.x / last);
        out.widest = std::max(out.widest, std::abs(out.angle));
    }
    return out;
}

TEST(Pendulum, StiffBarOnAnEdge) {
    Domain domain;
    domain.meshes = {0, 1};
    // Resolved in time, and bent by less than 1e-4: rho g L (L/w)^2 / E with L = 5 w.
    domain.holds = [](const Case& at) {
        const Material m = preset(at.preset);
        return at.dt * std::sqrt(kGravity / at.size) < 0.5
            && 25 * m.density * kGravity * at.size / m.young < 1e-4;
    };
    check({"pendulum: a bar on a hinge",
           "rigid pendulum, I th'' = torque, in discrete form",
           "bending of the bar, about 25 rho g L/E, below 0.01 %",
           domain,
           Cover::Pairs,
           [](Lab& lab) {
               Scene scene = lab.scene();
               scene.gravity = {kGravity * std::sin(0.5), -kGravity * std::cos(0.5), 0};
               const double L = lab.size();
               const double n = lab.at.mesh == 0 ? 1 : 2;
               Body bar = lab.body(
                   "bar", "box", {{"size", {L / 5, L, L / 5}}, {"cells", {n, 5 * n, n}}});
               auto hinge = condition(BoundaryCondition::Kind::Fixed);
               hinge.selection = part({0, 1, 0}, {0, 1, 1});
               bar.boundary = {hinge};
               scene.bodies = {bar};
               if (!lab.start(scene)) return;
               std::vector<Complex> r;
               for (const Vector3& x : lab.simulator().positions())
                   r.emplace_back(x[0] + L / 10, x[1] - L / 2);
               const int steps = 40;
               const Swing expected = swing(lab, r, steps);
               if (!lab.run(steps)) return;
               const auto mass = lab.simulator().topology().mass;
               const std::vector<Vector3> x = lab.simulator().positions();
               Complex sum{};
               for (std::size_t v = 0; v < r.size(); ++v)
                   sum += mass[v] * std::conj(r[v])
                        * Complex(x[v][0] + L / 10, x[v][1] - L / 2);
               const double off = std::arg(sum * std::polar(1.0, -expected.angle));
               lab.expect("angle", expected.angle, expected.angle + off, expected.widest);
           }});
}

}  // namespace
}  // namespace noli::accuracy
