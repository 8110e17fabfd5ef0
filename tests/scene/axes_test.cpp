// SPDX-License-Identifier: Apache-2.0
/// Boundary conditions on single axes, against closed answers.

#include "scene_support.hpp"

#include <algorithm>
#include <cmath>

namespace noli::test {
namespace {

using Kind = BoundaryCondition::Kind;

constexpr int kX = 1, kY = 2, kZ = 4;
constexpr Integrator kAll[] = {
    Integrator::ImplicitEuler, Integrator::Bdf2, Integrator::Newmark};

/// Vertices of the face where coordinate k is least or largest.
Selection face(std::size_t k, bool high) {
    Selection selection;
    selection.kind = Selection::Kind::Box;
    selection.box_min = {-0.1, -0.1, -0.1};
    selection.box_max = {1.1, 1.1, 1.1};
    (high ? selection.box_min : selection.box_max)[k] = high ? 0.99 : 0.01;
    return selection;
}

BoundaryCondition fixed_on(int axes, const Selection& selection = {}) {
    BoundaryCondition condition;
    condition.axes = axes;
    condition.selection = selection;
    return condition;
}

/// Exact linear algebra, so that only the method is looked at.
Scene exact_scene(double dt) {
    Scene scene;
    scene.dt = dt;
    scene.gravity = {0, 0, 0};
    scene.solver.tolerance = 1e-7;
    scene.solver.pcg_tolerance = 1e-18;
    return scene;
}

Body bar() {
    Body body = generated("bar", "box", {{"size", {1, 0.2, 0.3}}, {"cells", {6, 2, 2}}});
    body.material = {.model = Material::Model::NeoHookean,
                     .density = 1000,
                     .young = 1e5,
                     .poisson = 0.3};
    return body;
}

/// Symmetry planes at three faces, and the fourth pulled along x by `pull` in 0.1 s.
Scene pulled_bar(double pull) {
    Scene scene = exact_scene(0.02);
    scene.damping.mass = 20.0;
    Body body = bar();
    body.boundary = {fixed_on(kX, face(0, false)),
                     fixed_on(kY, face(1, false)),
                     fixed_on(kZ, face(2, false))};
    BoundaryCondition end = fixed_on(kX, face(0, true));
    end.kind = Kind::Path;
    end.path = {{0.0, {0, 0, 0}, {}}, {0.1, {pull, 7, 7}, {}}};
    body.boundary.push_back(end);
    scene.bodies = {body};
    return scene;
}

/// Lateral stretch b of a bar of stretch a whose sides are free of stress:
/// mu (b^2 - 1) + lambda ln(a b^2) = 0, the neo-Hookean law with ln J.
double lateral_stretch(double a, double young, double poisson) {
    const double mu = 0.5 * young / (1.0 + poisson);
    const double lambda = 2.0 * mu * poisson / (1.0 - 2.0 * poisson);
    double low = 0.5, high = 1.5;
    for (int k = 0; k < 100; ++k) {
        const double b = 0.5 * (low + high);
        (mu * (b * b - 1.0) + lambda * std::log(a * b * b) > 0.0 ? high : low) = b;
    }
    return low;
}

double extent(const std::vector<Vector3>& x, std::size_t k) {
    const auto [low, high] = std::minmax_element(
        x.begin(), x.end(), [k](const auto& a, const auto& b) { return a[k] < b[k]; });
    return (*high)[k] - (*low)[k];
}

TEST(SingleAxes, APulledBarContractsByPoissonsRatio) {
    for (const Integrator integrator : kAll) {
        SCOPED_TRACE(static_cast<int>(integrator));
        Scene scene = pulled_bar(0.15);
        scene.solver.integrator = integrator;
        Simulator simulator = start(scene, checked_options());
        run_clean(simulator, 150);
        const std::vector<Vector3> x = simulator.positions();
        const double b = lateral_stretch(1.15, 1e5, 0.3);
        EXPECT_NEAR(extent(x, 0), 1.15, 1e-14);
        // Newmark leaves stiff modes ringing, which mass damping, made of the average
        // velocity of a step, hardly feels.
        const double ringing = integrator == Integrator::Newmark ? 2e-3 : 1e-5;
        EXPECT_NEAR(extent(x, 1) / 0.2, b, ringing);
        EXPECT_NEAR(extent(x, 2) / 0.3, b, ringing);
        EXPECT_LT(b, 0.97);
    }
}

TEST(SingleAxes, EverySolverFindsTheSameMotion) {
    Simulator reference = start(pulled_bar(0.1), checked_options());
    run_clean(reference, 8);
    const std::vector<Vector3> expected = reference.positions();
    for (const LinearSolver linear : {LinearSolver::Cholmod,
                                      LinearSolver::BlockJacobi,
                                      LinearSolver::IncompleteCholesky}) {
        SCOPED_TRACE(static_cast<int>(linear));
        Scene scene = pulled_bar(0.1);
        scene.solver.linear = linear;
        Result<Simulator> made = Simulator::create(scene, checked_options());
        if (!made && linear == LinearSolver::Cholmod) continue;  // not in this build
        ASSERT_TRUE(made) << made.error().message;
        run_clean(made.value(), 8);
        const std::vector<Vector3> x = made.value().positions();
        for (std::size_t v = 0; v < x.size(); ++v)
            for (std::size_t k = 0; k < 3; ++k)
                EXPECT_NEAR(x[v][k], expected[v][k], 1e-8);
    }
}

TEST(SingleAxes, PrescribedAndFreeAxesKeepTheirOwnMotion) {
    constexpr double kDt = 0.01;
    constexpr int kSteps = 12;
    for (const Integrator integrator : kAll) {
        SCOPED_TRACE(static_cast<int>(integrator));
        Scene scene = exact_scene(kDt);
        scene.gravity = {3, -9.81, 0};
        scene.solver.integrator = integrator;
        Body body = bar();
        body.velocity = {0.4, 0, 1};
        BoundaryCondition drive = fixed_on(kX);
        drive.kind = Kind::Velocity;
        drive.linear = {0.25, 5, 5};
        body.boundary = {drive};
        scene.bodies = {body};
        Simulator simulator = start(scene, checked_options());
        const std::vector<Vector3> from = simulator.positions();
        run_clean(simulator, kSteps);
        const std::vector<Vector3> x = simulator.positions();
        const std::vector<Vector3> v = simulator.velocities();
        for (std::size_t i = 0; i < x.size(); ++i) {
            EXPECT_NEAR(x[i][0] - from[i][0], 0.25 * kSteps * kDt, 1e-14);
            EXPECT_NEAR(v[i][0], 0.25, 1e-12);
            EXPECT_NEAR(v[i][1], -9.81 * kSteps * kDt, 1e-6);
            EXPECT_NEAR(v[i][2], 1.0, 1e-6);
        }
    }
}

TEST(SingleAxes, ABlockOnARailSlidesAlongItAlone) {
    constexpr double kDt = 0.01;
    constexpr int kSteps = 15;
    for (const Integrator integrator : kAll) {
        SCOPED_TRACE(static_cast<int>(integrator));
        Scene scene = exact_scene(kDt);
        scene.gravity = {2, -9.81, 1};
        scene.solver.integrator = integrator;
        Body body = bar();
        body.velocity = {1, 0, 0};
        body.boundary = {fixed_on(kY | kZ)};
        scene.bodies = {body};
        Simulator simulator = start(scene, checked_options());
        const std::vector<Vector3> from = simulator.positions();
        run_clean(simulator, kSteps);
        const std::vector<Vector3> x = simulator.positions();
        const std::vector<Vector3> v = simulator.velocities();
        for (std::size_t i = 0; i < x.size(); ++i) {
            EXPECT_NEAR(v[i][0], 1.0 + 2.0 * kSteps * kDt, 1e-6);
            EXPECT_EQ(x[i][1], from[i][1]);
            EXPECT_EQ(x[i][2], from[i][2]);
            EXPECT_EQ(v[i][1], 0.0);
            EXPECT_EQ(v[i][2], 0.0);
        }
    }
}

/// Guided between walls without friction, a box falls onto the ground and rests there.
TEST(SingleAxes, ContactTreatsTheFreeAxesAsFree) {
    Scene scene;
    scene.dt = 0.01;
    Body body = generated("box", "box", {{"cells", {2, 2, 2}}});
    body.transform = placed(0, 0.52, 0);
    body.boundary = {fixed_on(kX | kZ)};
    scene.bodies = {body};
    scene.half_spaces = {ground(0.5)};
    scene.damping.mass = 5.0;
    scene.solver.tolerance = 1e-4;
    Simulator simulator = start(scene, checked_options());
    const std::vector<Vector3> from = simulator.positions();
    const auto reports = run_clean(simulator, 160);
    EXPECT_GT(most_contacts(reports), 0);
    const std::vector<Vector3> x = simulator.positions();
    for (std::size_t i = 0; i < x.size(); ++i) {
        EXPECT_EQ(x[i][0], from[i][0]);
        EXPECT_EQ(x[i][2], from[i][2]);
    }
    EXPECT_LT(mean(x)[1], 0.505);
    EXPECT_NEAR(mean(simulator.velocities())[1], 0.0, 1e-2);
    // Held sideways, it bears its weight in uniaxial strain.
    double force = 0.0;
    for (const Vector3& f : simulator.fields().contact_force)
        force += f[1];
    const double weight = simulator.resolved().total_mass * 9.80665;
    EXPECT_NEAR(force, weight, 0.02 * weight);
}

TEST(SingleAxes, TheSameBitsForEveryNumberOfThreadsAndAfterARestore) {
    std::vector<std::uint64_t> hashes;
    for (const int threads : {1, 2, 4}) {
        Simulator simulator = start(pulled_bar(0.1), checked_options(threads));
        run_clean(simulator, 6);
        hashes.push_back(simulator.state_hash());
    }
    Simulator first = start(pulled_bar(0.1), checked_options());
    run_clean(first, 3);
    Simulator second = start(pulled_bar(0.1), checked_options());
    ASSERT_TRUE(second.restore(first.save()));
    run_clean(second, 3);
    hashes.push_back(second.state_hash());
    for (const std::uint64_t hash : hashes)
        EXPECT_EQ(hash, hashes[0]);
}

}  // namespace
}  // namespace noli::test
