// SPDX-License-Identifier: Apache-2.0
/// Bodies in spheres and cylinders, against closed answers.

#include "scene_support.hpp"

#include <numbers>

namespace noli::test {
namespace {

constexpr double kGravity = 9.80665;

Container container(Container::Shape shape, double radius, double friction = 0.0) {
    Container c;
    c.name = "drum";
    c.shape = shape;
    c.radius = radius;
    c.axis = {0, 0, 3};
    c.friction = friction;
    return c;
}

/// Settings under which a closed answer is met: converged far beyond the defaults.
void solve_tightly(Scene& scene) {
    scene.solver.tolerance = 1e-5;
    scene.solver.pcg_tolerance = 1e-14;
}

/// A placement turned by `angle` about z at the end of an arm of `length` that hangs from
/// the origin.
Affine hung(double angle, double length) {
    const double s = std::sin(angle);
    const double c = std::cos(angle);
    Affine at;
    at.rows = {{{c, -s, 0, length * s}, {s, c, 0, -length * c}, {0, 0, 1, 0}}};
    return at;
}

double total_mass(const Simulator& simulator) {
    double sum = 0.0;
    for (const double m : simulator.topology().mass)
        sum += m;
    return sum;
}

Vector3 total_force(Simulator& simulator) {
    Vector3 sum{};
    for (const Vector3& f : simulator.fields().contact_force)
        for (std::size_t k = 0; k < 3; ++k)
            sum[k] += f[k];
    return sum;
}

TEST(Container, ABallAtRestInABowlWeighsItsWeight) {
    Scene scene;
    scene.name = "bowl";
    scene.dt = 0.01;
    Body ball = generated("ball", "sphere", {{"radius", {0.1}}, {"edge_length", {0.05}}});
    ball.material.young = 1e6;
    ball.transform = placed(0.003, -0.3995, 0.0);
    scene.bodies = {ball};
    scene.containers = {container(Container::Shape::Sphere, 0.5, 0.3)};
    scene.contact.dhat = 1e-3;
    scene.contact.dhat_absolute = true;
    scene.damping.mass = 5.0;
    solve_tightly(scene);
    Simulator simulator = start(scene, checked_options());
    run_clean(simulator, 400);
    for (const Vector3& v : simulator.velocities())
        ASSERT_LT(std::hypot(v[0], v[1], v[2]), 1e-4);
    const double weight = total_mass(simulator) * kGravity;
    const Vector3 force = total_force(simulator);
    EXPECT_NEAR(force[1], weight, 1e-3 * weight);
    EXPECT_NEAR(force[0], 0.0, 1e-3 * weight);
    EXPECT_NEAR(force[2], 0.0, 1e-3 * weight);
}

TEST(Container, ABallThatSlidesInACylinderIsAPendulum) {
    constexpr double kRadius = 1.0;
    constexpr double kBall = 0.03;
    constexpr double kAngle = 0.1;
    Scene scene;
    scene.name = "pendulum";
    scene.dt = 0.01;
    scene.solver.integrator = Integrator::Bdf2;
    Body ball =
        generated("ball", "sphere", {{"radius", {kBall}}, {"edge_length", {0.02}}});
    ball.material.young = 1e6;
    const double arm = kRadius - kBall - 1.5e-4;
    ball.transform = hung(kAngle, arm);
    scene.bodies = {ball};
    scene.containers = {container(Container::Shape::Cylinder, kRadius)};
    scene.contact.dhat = 2e-4;
    scene.contact.dhat_absolute = true;
    solve_tightly(scene);
    Simulator simulator = start(scene, checked_options());
    std::vector<double> crossings;
    Vector3 before = mean(simulator.positions());
    while (crossings.size() < 2 && simulator.time() < 3.0) {
        run_clean(simulator, 1);
        ASSERT_FALSE(testing::Test::HasFailure());
        const Vector3 now = mean(simulator.positions());
        if (before[0] * now[0] < 0.0)
            crossings.push_back(simulator.time()
                                - scene.dt * now[0] / (now[0] - before[0]));
        before = now;
    }
    ASSERT_EQ(crossings.size(), 2U);
    // Half of 2 pi sqrt(L / g) (1 + angle^2 / 16); no friction, so the ball does not
    // roll.
    const double half =
        std::numbers::pi * std::sqrt(arm / kGravity) * (1.0 + kAngle * kAngle / 16.0);
    EXPECT_NEAR(crossings[1] - crossings[0], half, 0.01 * half);
    // A polyhedron that turns may lie on a facet: nearer to the wall by at most
    // edge^2 / (8 radius).
    const double facet = 0.02 * 0.02 / (8.0 * kBall);
    EXPECT_GE(std::hypot(before[0], before[1]), arm - 2e-4);
    EXPECT_LE(std::hypot(before[0], before[1]), arm + 2e-4 + facet);
}

/// How far a small plate on the wall of a cylinder gets down within 0.2 s.
double slides(double mu, double angle) {
    Scene scene;
    scene.name = "plate";
    scene.dt = 0.005;
    Body plate =
        generated("plate", "box", {{"size", {0.06, 0.02, 0.06}}, {"cells", {2, 1, 2}}});
    plate.material.young = 1e7;
    // The plate's lower corners are off the middle of its side by 0.03.
    const double reach = std::sqrt(1.0 - 0.03 * 0.03) - 0.01 - 1.5e-4;
    plate.transform = hung(angle, reach);
    scene.bodies = {plate};
    scene.containers = {container(Container::Shape::Cylinder, 1.0, mu)};
    scene.contact.dhat = 2e-4;
    scene.contact.dhat_absolute = true;
    scene.contact.epsv = 1e-3;
    scene.contact.epsv_absolute = true;
    scene.contact.friction_iterations = 0;
    solve_tightly(scene);
    Simulator simulator = start(scene, checked_options());
    const Vector3 from = mean(simulator.positions());
    run_clean(simulator, 40);
    const Vector3 to = mean(simulator.positions());
    return std::hypot(to[0] - from[0], to[1] - from[1]);
}

TEST(Container, FrictionHoldsBelowItsAngleAndBrakesAboveIt) {
    constexpr double kAngle = 0.3;
    EXPECT_LT(slides(1.2 * std::tan(kAngle), kAngle), 2e-3);
    // A point on the circle: angle'' = -(g / L) (sin - mu (cos + L angle'^2 / g)).
    const double mu = 0.6 * std::tan(kAngle);
    const double arm = 0.99;
    double angle = kAngle;
    double rate = 0.0;
    const double dt = 1e-5;
    for (int k = 0; k < 20000; ++k) {
        const double normal = std::cos(angle) + arm * rate * rate / kGravity;
        rate -= dt * kGravity / arm * (std::sin(angle) - mu * normal);
        angle += dt * rate;
    }
    const double expected = arm * (kAngle - angle);
    EXPECT_NEAR(slides(mu, kAngle), expected, 0.05 * expected);
}

Scene balls_in_a_drum() {
    Scene scene;
    scene.name = "drum";
    scene.dt = 0.01;
    for (int k = 0; k < 3; ++k) {
        Body ball = generated("ball" + std::to_string(k),
                              "sphere",
                              {{"radius", {0.15}}, {"edge_length", {0.1}}});
        ball.transform = placed(0.1 - 0.08 * k, -0.2 + 0.32 * k, 0.02 * k);
        ball.velocity = {3.0, -1.0, 1.0 - k};
        ball.friction = 0.3;
        scene.bodies.push_back(ball);
    }
    scene.containers = {container(Container::Shape::Cylinder, 0.7, 0.4)};
    for (const double side : {-1.0, 1.0}) {
        HalfSpace end;
        end.name = side < 0.0 ? "back" : "front";
        end.point = {0, 0, 0.25 * side};
        end.normal = {0, 0, -side};
        scene.half_spaces.push_back(end);
    }
    return scene;
}

void expect_inside(Simulator& simulator, const Container& c) {
    for (const Vector3& x : simulator.positions()) {
        const double along = c.shape == Container::Shape::Cylinder ? 0.0 : x[2];
        ASSERT_LT(std::hypot(x[0], x[1], along), c.radius);
    }
}

TEST(Container, NothingLeavesADrum) {
    const Scene scene = balls_in_a_drum();
    Simulator simulator = start(scene, checked_options());
    const std::vector<StepReport> reports = run_clean(simulator, 60);
    expect_inside(simulator, scene.containers[0]);
    EXPECT_GT(most_contacts(reports), 10);
}

TEST(Container, NothingLeavesASphere) {
    for (const Integrator integrator :
         {Integrator::ImplicitEuler, Integrator::Bdf2, Integrator::Newmark}) {
        Scene scene = balls_in_a_drum();
        scene.half_spaces.clear();
        scene.containers[0].shape = Container::Shape::Sphere;
        scene.solver.integrator = integrator;
        scene.bodies.resize(2);
        Simulator simulator = start(scene, checked_options());
        run_clean(simulator, 20);
        expect_inside(simulator, scene.containers[0]);
    }
}

TEST(Container, TheBitsDoNotDependOnThreads) {
    std::vector<std::uint64_t> hashes;
    for (const int threads : {1, 2}) {
        Simulator simulator = start(balls_in_a_drum(), checked_options(threads));
        run_clean(simulator, 15);
        hashes.push_back(simulator.state_hash());
    }
    EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(Container, PairRulesNameIt) {
    // Without contact between the ball and the drum it falls out of it.
    Scene scene = balls_in_a_drum();
    scene.bodies.resize(1);
    scene.half_spaces.clear();
    ContactPairRule off;
    off.a = "drum";
    off.b = "ball0";
    off.enabled = false;
    scene.contact.pairs = {off};
    Simulator simulator = start(scene, checked_options());
    run_clean(simulator, 40);
    EXPECT_LT(mean(simulator.positions())[1], -0.7);
}

TEST(Container, MustBeLargerThanDhat) {
    Scene scene = balls_in_a_drum();
    scene.contact.dhat = 0.7;
    scene.contact.dhat_absolute = true;
    const Result<Simulator> made = Simulator::create(scene, checked_options());
    ASSERT_FALSE(made);
    EXPECT_NE(made.error().where.find("/containers/0/radius"), std::string::npos);
    EXPECT_NE(made.error().message.find("dhat"), std::string::npos);
}

}  // namespace
}  // namespace noli::test
