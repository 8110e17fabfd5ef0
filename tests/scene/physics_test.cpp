// SPDX-License-Identifier: Apache-2.0
/// Oracles from mechanics: what a simulator of elastic bodies must get right, in closed
/// form.

#include "scene_support.hpp"

#include <functional>
#include <numbers>

namespace noli::test {
namespace {

constexpr double kGravity = 9.80665;

TEST(FreeFall, ImplicitEulerFollowsItsClosedForm) {
    Scene scene;
    scene.name = "fall";
    scene.dt = 0.01;
    scene.solver.tolerance = 1e-8;
    scene.solver.pcg_tolerance = 1e-20;
    scene.bodies = {generated("ball", "sphere", {{"edge_length", {0.25}}})};
    Simulator simulator = start(scene, checked_options());
    const Vector3 before = mean(simulator.positions());
    const int n = 20;
    run_clean(simulator, n);
    // v_k = -k g dt, so the drop is g dt^2 n (n + 1) / 2.
    const double drop = kGravity * scene.dt * scene.dt * n * (n + 1) / 2.0;
    EXPECT_NEAR(before[1] - mean(simulator.positions())[1], drop, 1e-9 * drop);
}

/// A stiff block on a plane tilted so that tan(angle) = 0.5, through the direction of
/// gravity.
Scene slope(double mu) {
    Scene scene;
    scene.name = "slope";
    scene.dt = 0.025;
    const double angle = std::atan(0.5);
    scene.gravity = {kGravity * std::sin(angle), -kGravity * std::cos(angle), 0};
    Body block = generated("block", "box", {{"cells", {1, 1, 1}}});
    block.material.model = Material::Model::FixedCorotated;
    block.material.young = 1e9;
    block.transform = placed(0, 0.5 + 0.02, 0);
    scene.bodies = {block};
    scene.half_spaces = {ground(mu)};
    scene.contact.epsv = 1e-5;
    scene.contact.friction_iterations = 0;
    scene.solver.tolerance = 1e-6;
    return scene;
}

/// Mean speed along the slope in the last `steps` steps.
double late_speed(Simulator& simulator, const Vector3& along, int steps) {
    const Vector3 from = mean(simulator.positions());
    const double start_time = simulator.time();
    run_clean(simulator, steps);
    const Vector3 to = mean(simulator.positions());
    double distance = 0.0;
    for (std::size_t k = 0; k < 3; ++k)
        distance += (to[k] - from[k]) * along[k];
    return distance / (simulator.time() - start_time);
}

TEST(Slope, SticksJustAboveTheCriticalCoefficient) {
    // One percent above tan(angle): the block that lands sliding must come to rest,
    // creeping below epsv.
    Simulator simulator = start(slope(0.505), checked_options());
    run_clean(simulator, 60);
    EXPECT_LE(std::abs(late_speed(simulator, {1, 0, 0}, 40)), simulator.resolved().epsv);
}

TEST(Slope, SticksAtTheCriticalCoefficient) {
    // At tan(angle) = mu itself friction only just holds a block: one that lies at rest
    // and is tilted slowly must stay, creeping at epsv, where the smoothed law reaches
    // mu lambda. Tilting rocks it a little, so epsv is its default here.
    Scene scene = slope(0.5);
    scene.contact.epsv = ContactSettings{}.epsv;
    scene.bodies[0].transform = placed(0, 0.5 + 1e-3, 0);
    const double pull = scene.gravity[0];
    scene.gravity[0] = 0.0;
    const int parts = 200;
    for (int k = 0; k < parts; ++k) {
        BoundaryCondition tilt;
        tilt.kind = BoundaryCondition::Kind::Acceleration;
        tilt.linear = {pull / parts, 0, 0};
        tilt.t_begin = (40 + k) * scene.dt;
        scene.bodies[0].boundary.push_back(tilt);
    }
    Simulator simulator = start(scene, checked_options());
    run_clean(simulator, 40 + parts);
    const double epsv = simulator.resolved().epsv;
    EXPECT_LE(late_speed(simulator, {1, 0, 0}, 100), 1.001 * epsv);
    EXPECT_GE(late_speed(simulator, {1, 0, 0}, 100), 0.5 * epsv);
}

TEST(Slope, KeepsItsSpeedAtTheCriticalCoefficient) {
    // A block that bounces when it lands slides on: friction that balances the slope
    // exactly neither slows it nor lets it speed up.
    Simulator simulator = start(slope(0.5), checked_options());
    run_clean(simulator, 20);
    const double early = late_speed(simulator, {1, 0, 0}, 20);
    const double late = late_speed(simulator, {1, 0, 0}, 20);
    EXPECT_GT(early, 10.0 * simulator.resolved().epsv);
    EXPECT_NEAR(late, early, 0.1 * early);
}

/// The field's own slope script with its own tolerance, ten times coarser than epsv.
void with_field_slope(double mu, const std::function<void(Simulator&)>& check) {
    const std::string path =
        std::string(NOLI_SHARED_DIR)
        + "/ipc-scenes/input/otherExamples/friction/slopeTest_highSchoolPhysics_0.5.txt";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
    Result<Scene> scene = read_scene(path);
    ASSERT_TRUE(bool(scene)) << scene.error().message;
    for (HalfSpace& plane : scene.value().half_spaces)
        plane.friction = mu;
    Simulator simulator = start(scene.value(), checked_options());
    run_clean(simulator, 20);
    check(simulator);
}

const double kUnitSlope = 1.0 / std::sqrt(5.0);
const Vector3 kDownFieldSlope{2 * kUnitSlope, -kUnitSlope, 0};

TEST(Slope, FieldScriptDoesNotSpeedUpAtTheCriticalCoefficient) {
    // At mu = tan(angle) friction balances the slope for every speed above epsv: what the
    // landing leaves stays, and must not grow.
    with_field_slope(0.5, [](Simulator& simulator) {
        const double early = late_speed(simulator, kDownFieldSlope, 40);
        const double late = late_speed(simulator, kDownFieldSlope, 40);
        EXPECT_LE(std::abs(late - early), 0.1 * simulator.resolved().epsv);
        EXPECT_LE(std::abs(late), 1e-4);
    });
}

TEST(Slope, FieldScriptSticksAboveIt) {
    with_field_slope(0.505, [](Simulator& simulator) {
        EXPECT_LE(std::abs(late_speed(simulator, kDownFieldSlope, 80)),
                  1.01 * simulator.resolved().epsv);
    });
}

TEST(Slope, FieldScriptSlidesBelowIt) {
    with_field_slope(0.49, [](Simulator& simulator) {
        const double early = late_speed(simulator, kDownFieldSlope, 1);
        run_clean(simulator, 59);
        const double late = late_speed(simulator, kDownFieldSlope, 1);
        const double angle = std::atan(0.5);
        const double expected = kGravity * (std::sin(angle) - 0.49 * std::cos(angle));
        EXPECT_NEAR((late - early) / (60 * 0.025), expected, 0.01 * expected);
    });
}

TEST(Slope, SlidesBelowItWithTheAnalyticAcceleration) {
    Simulator simulator = start(slope(0.49), checked_options());
    run_clean(simulator, 20);
    const double v0 = mean(simulator.velocities())[0];
    run_clean(simulator, 80);
    const double acceleration = (mean(simulator.velocities())[0] - v0) / (80 * 0.025);
    const double angle = std::atan(0.5);
    const double expected = kGravity * (std::sin(angle) - 0.49 * std::cos(angle));
    EXPECT_NEAR(acceleration, expected, 0.005 * expected);
}

TEST(Coulomb, SlidingBlockDeceleratesAtMuG) {
    Scene scene = slope(0.3);
    scene.gravity = {0, -kGravity, 0};
    scene.bodies[0].velocity = {2, 0, 0};
    Simulator simulator = start(scene, checked_options());
    run_clean(simulator, 4);
    const double v0 = mean(simulator.velocities())[0];
    run_clean(simulator, 16);
    const double deceleration = (v0 - mean(simulator.velocities())[0]) / (16 * scene.dt);
    EXPECT_NEAR(deceleration, 0.3 * kGravity, 0.01 * 0.3 * kGravity);
}

Vector3 cross_sum(const std::span<const double> mass,
                  const std::vector<Vector3>& x,
                  const std::vector<Vector3>& v) {
    Vector3 sum{};
    for (std::size_t i = 0; i < x.size(); ++i) {
        sum[0] += mass[i] * (x[i][1] * v[i][2] - x[i][2] * v[i][1]);
        sum[1] += mass[i] * (x[i][2] * v[i][0] - x[i][0] * v[i][2]);
        sum[2] += mass[i] * (x[i][0] * v[i][1] - x[i][1] * v[i][0]);
    }
    return sum;
}

double size(const Vector3& v) {
    return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/// Two balls meet off centre, without friction and gravity.
Scene free_collision() {
    Scene scene;
    scene.name = "collision";
    scene.dt = 0.005;
    scene.gravity = {0, 0, 0};
    scene.solver.tolerance = 1e-12;
    scene.solver.pcg_tolerance = 1e-24;
    Body left = generated("left", "sphere", {{"edge_length", {0.25}}});
    left.transform = placed(-0.52, 0, 0);
    left.velocity = {2, 0, 0};
    Body right = generated("right", "sphere", {{"edge_length", {0.25}}});
    right.transform = placed(0.52, 0.2, 0.1);
    right.velocity = {-1, 0.3, 0};
    scene.bodies = {left, right};
    return scene;
}

TEST(Collision, ConservesLinearMomentum) {
    Simulator simulator = start(free_collision(), checked_options());
    const Simulator::Balance before = simulator.balance();
    const std::vector<StepReport> reports = run_clean(simulator, 40);
    EXPECT_GT(most_contacts(reports), 0);
    const Simulator::Balance after = simulator.balance();
    for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(after.linear[k], before.linear[k], 1e-9 * size(before.linear)) << k;
}

TEST(Collision, ForcesExertNoTorque) {
    // Implicit Euler itself loses angular momentum: L' - L = dt sum m v' x v + torque.
    // What the forces must do exactly is exert no torque about any point at the end of
    // the step: sum m x' x (v' - v) = 0.
    Simulator simulator = start(free_collision(), checked_options());
    const double scale = size(simulator.balance().angular);
    for (int k = 0; k < 40; ++k) {
        const std::vector<Vector3> v0 = simulator.velocities();
        run_clean(simulator, 1);
        std::vector<Vector3> change = simulator.velocities();
        for (std::size_t i = 0; i < v0.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c)
                change[i][c] -= v0[i][c];
        EXPECT_LE(
            size(cross_sum(simulator.topology().mass, simulator.positions(), change)),
            1e-9 * scale)
            << "step " << k;
    }
}

TEST(Energy, NeverGrowsWithoutWork) {
    Scene scene;
    scene.name = "bounce";
    scene.dt = 0.01;
    scene.solver.tolerance = 1e-7;
    scene.solver.pcg_tolerance = 1e-14;
    Body ball = generated("ball", "sphere", {{"edge_length", {0.2}}});
    ball.transform = placed(0, 0.8, 0);
    ball.material.young = 2e5;
    scene.bodies = {ball};
    scene.half_spaces = {ground(0.2)};
    Simulator simulator = start(scene, checked_options());
    const auto total = [&] {
        const Simulator::Balance b = simulator.balance();
        return b.kinetic + b.elastic + b.gravitational + b.contact;
    };
    // Even in free fall implicit Euler loses m g^2 dt^2 / 2 a step.
    const double lost =
        0.5 * simulator.resolved().total_mass * std::pow(kGravity * scene.dt, 2);
    double last = total();
    int in_contact = 0;
    for (int k = 0; k < 80; ++k) {
        in_contact += run_clean(simulator, 1).back().contacts > 0 ? 1 : 0;
        const double now = total();
        EXPECT_LE(now, last - 0.99 * lost * (in_contact == 0 ? 1.0 : 0.0))
            << "step " << k;
        last = now;
    }
    EXPECT_GT(in_contact, 5);
}

/// A bar whose ends turn against each other by 150 degrees a step, until its law alone
/// would let elements turn inside out.
void expect_violent_twist_is_clean(Material::Model model) {
    Scene scene;
    scene.name = "violent twist";
    // Looser than the defaults, at which the third step of stable neo-Hookean does not
    // end within max_newton: what is asked here is that nothing inverts.
    scene.solver.tolerance = 1e-2;
    scene.solver.gap_tolerance = 0.0;
    scene.solver.pcg_tolerance = 1e-4;
    scene.solver.start = NewtonStart::Last;
    scene.dt = 1.0;
    scene.gravity = {0, 0, 0};
    Body bar =
        generated("bar", "box", {{"size", {1.0, 0.25, 0.25}}, {"cells", {12, 3, 3}}});
    bar.material.model = model;
    bar.material.young = 1e4;
    for (const double side : {-1.0, 1.0}) {
        BoundaryCondition turn;
        turn.kind = BoundaryCondition::Kind::Velocity;
        turn.selection.kind = Selection::Kind::Box;
        turn.selection.box_min = {side < 0 ? -0.01 : 0.99, -0.1, -0.1};
        turn.selection.box_max = {side < 0 ? 0.01 : 1.01, 1.1, 1.1};
        turn.angular_deg = {side * 150.0, 0, 0};
        bar.boundary.push_back(turn);
    }
    scene.bodies = {bar};
    Simulator simulator = start(scene, checked_options());
    const std::vector<StepReport> reports = run_clean(simulator, 3);
    int newton = 0;
    for (const StepReport& report : reports)
        newton += report.newton;
    std::printf("%d Newton iterations in 3 steps\n", newton);
}

TEST(Crush, ViolentTwistInvertsNothing) {
    expect_violent_twist_is_clean(Material::Model::StableNeoHookean);
    expect_violent_twist_is_clean(Material::Model::FixedCorotated);
    expect_violent_twist_is_clean(Material::Model::NeoHookean);
}

/// Tip deflection of a clamped bar under its own weight, at rest (large time steps damp
/// it).
double sag(int nx, int ny) {
    Scene scene;
    scene.name = "bar";
    scene.dt = 0.5;
    scene.solver.tolerance = 1e-6;
    scene.solver.pcg_tolerance = 1e-10;
    Body bar = generated(
        "bar",
        "box",
        {{"size", {1.0, 0.1, 0.1}}, {"cells", {double(nx), double(ny), double(ny)}}});
    bar.material.young = 1e8;
    bar.material.poisson = 0.0;
    BoundaryCondition clamp = fixed_everywhere();
    clamp.selection.kind = Selection::Kind::Box;
    clamp.selection.box_min = {-0.01, -0.1, -0.1};
    clamp.selection.box_max = {1e-6, 1.1, 1.1};
    bar.boundary = {clamp};
    scene.bodies = {bar};
    scene.contact.enabled = false;
    Simulator simulator = start(scene, checked_options());
    run_clean(simulator, 30);
    const std::vector<Vector3> x = simulator.positions();
    int count = 0;
    double tip = 0.0;
    for (const Vector3& p : x)
        if (p[0] > 0.5 - 0.01) {
            tip += p[1];
            ++count;
        }
    return -tip / count;
}

TEST(Beam, SagApproachesBeamTheoryUnderRefinement) {
    // Euler-Bernoulli: w = q L^4 / (8 E I), q = rho A g, I = h^4 / 12, plus shear 1.2 q
    // L^2 / (2 G A).
    const double area = 0.01;
    const double q = 1000 * area * kGravity;
    const double inertia = std::pow(0.1, 4) / 12.0;
    const double bending = q / (8 * 1e8 * inertia);
    const double shear = 1.2 * q / (2 * 0.5e8 * area);
    const double theory = bending + shear;
    const double coarse = std::abs(sag(20, 2) - theory) / theory;
    const double fine = std::abs(sag(40, 4) - theory) / theory;
    const double finer = std::abs(sag(80, 8) - theory) / theory;
    EXPECT_LT(fine, 0.6 * coarse);
    EXPECT_LT(finer, 0.6 * fine);
    EXPECT_LT(finer, 0.05);
}

/// Position of a vibrating bar after 0.04 s, for a step size and integrator.
std::vector<Vector3> vibrate(Integrator integrator, double dt) {
    Scene scene;
    scene.name = "vibration";
    scene.dt = dt;
    scene.gravity = {0, 0, 0};
    scene.solver.integrator = integrator;
    scene.solver.tolerance = 1e-11;
    scene.solver.pcg_tolerance = 1e-22;
    scene.contact.enabled = false;
    Body bar = generated("bar", "box", {{"size", {1.0, 0.3, 0.3}}, {"cells", {4, 1, 1}}});
    bar.material.young = 1e5;
    bar.velocity = {0.0, 0.5, 0.0};
    BoundaryCondition clamp = fixed_everywhere();
    clamp.selection.kind = Selection::Kind::Box;
    clamp.selection.box_min = {-0.01, -0.1, -0.1};
    clamp.selection.box_max = {1e-6, 1.1, 1.1};
    bar.boundary = {clamp};
    scene.bodies = {bar};
    Simulator simulator = start(scene, checked_options());
    run_clean(simulator, static_cast<int>(std::lround(0.04 / dt)));
    return simulator.positions();
}

double distance(const std::vector<Vector3>& a, const std::vector<Vector3>& b) {
    double sum = 0.0;
    for (std::size_t v = 0; v < a.size(); ++v)
        for (std::size_t k = 0; k < 3; ++k)
            sum += (a[v][k] - b[v][k]) * (a[v][k] - b[v][k]);
    return std::sqrt(sum);
}

/// Observed order from three step sizes by Richardson: log2(|x_h - x_h/2| / |x_h/2 -
/// x_h/4|).
double observed_order(Integrator integrator, double dt) {
    const auto coarse = vibrate(integrator, dt);
    const auto middle = vibrate(integrator, dt / 2);
    const auto fine = vibrate(integrator, dt / 4);
    return std::log2(distance(coarse, middle) / distance(middle, fine));
}

TEST(Integrators, ImplicitEulerIsFirstOrder) {
    EXPECT_NEAR(observed_order(Integrator::ImplicitEuler, 0.001), 1.0, 0.15);
}
TEST(Integrators, Bdf2IsSecondOrder) {
    EXPECT_NEAR(observed_order(Integrator::Bdf2, 0.001), 2.0, 0.25);
}
TEST(Integrators, NewmarkIsSecondOrder) {
    EXPECT_NEAR(observed_order(Integrator::Newmark, 0.001), 2.0, 0.25);
}

}  // namespace
}  // namespace noli::test
