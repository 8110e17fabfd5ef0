// SPDX-License-Identifier: Apache-2.0
/// The engine's text as a device runs it. Without a GPU: on an executor whose memory may
/// only be touched inside of kernels. With a GPU: on CUDA.
#include "noli/simulator.hpp"

#include "linear/block_pattern.hpp"
#include "sim/estimate.hpp"
#include "sim/guarded_engine.hpp"
#include "sim/step_settings.hpp"
#include "support/device_like_exec.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

namespace noli {
namespace {

using test::ClosedBuffer;
using test::DeviceLikeExec;

/// A box that lands askew on another one, which stands on a slope: all kinds of pairs,
/// friction.
Scene pile() {
    Scene scene;
    scene.dt = 0.01;
    scene.damping.stiffness = 1e-3;
    Body below;
    below.name = "below";
    below.mesh.generator = "box";
    below.transform.rows[1][3] = 0.501;
    below.friction = 0.3;
    Body above = below;
    above.name = "above";
    above.transform.rows = {{{0.8, 0, 0.6, 0.2}, {0, 1, 0, 1.503}, {-0.6, 0, 0.8, 0.1}}};
    above.velocity = {0.1, -1.0, 0};
    scene.bodies = {below, above};
    HalfSpace ground;
    ground.name = "ground";
    ground.friction = 0.3;
    scene.half_spaces = {ground};
    return scene;
}

constexpr int kSteps = 12;

double largest_difference(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
    double largest = a.size() == b.size() ? 0.0 : HUGE_VAL;
    for (std::size_t i = 0; i < a.size() && i < b.size(); ++i)
        largest = std::max(largest, max_abs(a[i] - b[i]));
    return largest;
}

void expect_device_text_matches_cpu(const Scene& scene) {
    const Result<Model> model = build_model(scene);
    ASSERT_TRUE(model) << model.error().message;
    const BlockPattern pattern =
        build_block_pattern(model.value().num_vertices, model.value().tets);
    const StepSettings settings = step_settings(scene, model.value());
    const EngineInput input{model.value(), pattern, settings, scene.gravity, 1};
    EngineOn<DeviceLikeExec> device(input);
    const std::unique_ptr<Engine> cpu = make_cpu_engine(input);
    int most_contacts = 0;
    for (int k = 0; k < kSteps; ++k) {
        const StepReport report = device.step();
        ASSERT_EQ(report.outcome, Outcome::Converged) << report.message;
        ASSERT_EQ(cpu->step().outcome, Outcome::Converged);
        most_contacts = std::max(most_contacts, report.contacts);
    }
    EXPECT_GT(most_contacts, 20);
    // The preconditioners differ, so the two agree as far as Newton's tolerance goes.
    const double tolerance = model.value().tolerance(scene.solver, 0) * scene.dt * kSteps;
    EXPECT_LT(largest_difference(device.state().x, cpu->state().x), tolerance);
    EXPECT_EQ(device.contact_forces().size(), device.state().x.size());
    EXPECT_NEAR(
        device.elastic_energy(), cpu->elastic_energy(), 0.05 * cpu->elastic_energy());
}

/// A box that falls freely onto the ground: its bottom is all that touches.
Scene drop(int cells) {
    Scene scene = pile();
    scene.damping.stiffness = 0.0;
    scene.bodies.resize(1);
    const double n = cells;
    scene.bodies[0].mesh.parameters = {{"cells", {n, n, n}}};
    return scene;
}

TEST(DeviceMemory, EndsAProgramThatTouchesItOutsideOfKernels) {
    DeviceLikeExec exec;
    ClosedBuffer<int> buffer;
    exec.upload(std::vector<int>{1, 2, 3}, buffer);
    EXPECT_EQ(exec.read(View<const int>(buffer.view()), 2), 3);
    EXPECT_DEATH(buffer.view()[2] = 4, "");
}

TEST(DeviceText, TouchesDeviceMemoryInKernelsOnlyAndMatchesTheCpu) {
    Scene scene = pile();
    scene.solver.tolerance = 1e-4;
    scene.solver.pcg_tolerance = 1e-8;
    expect_device_text_matches_cpu(scene);
}

TEST(DeviceText, DoesSoWithTheDirectSolver) {
    if (!CholmodSolver::available()) GTEST_SKIP() << "this build has no CHOLMOD";
    Scene scene = pile();
    scene.solver.tolerance = 1e-4;
    scene.solver.linear = LinearSolver::Cholmod;
    expect_device_text_matches_cpu(scene);
}

template <class Exec>
std::vector<Vec3d> positions_after_steps(const Scene& scene, const Model& model) {
    const BlockPattern pattern = build_block_pattern(model.num_vertices, model.tets);
    const StepSettings settings = step_settings(scene, model);
    EngineOn<Exec> engine({model, pattern, settings, scene.gravity, 1});
    for (int k = 0; k < kSteps; ++k)
        EXPECT_EQ(engine.step().outcome, Outcome::Converged);
    return engine.positions();
}

/// Each step ends within tolerance * dt of the same minimum, whatever the product.
TEST(ContactProduct, OfTheSupplementGivesTheSameMotionOnEveryExecutor) {
    Scene scene = pile();
    scene.solver.tolerance = 1e-4;
    scene.solver.pcg_tolerance = 1e-8;
    const Model model = build_model(scene).value();
    const std::vector<Vec3d> modes = positions_after_steps<SerialExec>(scene, model);
    scene.solver.contact_product = ContactProduct::Warp;
    const std::vector<Vec3d> warp = positions_after_steps<SerialExec>(scene, model);
    const double tolerance = model.tolerance(scene.solver, 0) * scene.dt * kSteps;
    EXPECT_LT(largest_difference(warp, modes), tolerance);
    EXPECT_GT(largest_difference(warp, modes), 0.0);  // another product it was
    EXPECT_EQ(largest_difference(positions_after_steps<ShuffledExec>(scene, model), warp),
              0.0);
    EXPECT_LT(
        largest_difference(positions_after_steps<DeviceLikeExec>(scene, model), modes),
        tolerance);
}

/// Steps of a scene on the device-like executor, and what crossed to and from it.
struct Counted {
    test::BusTraffic traffic;
    int newton = 0;
    int steps = 0;
    int num_vertices = 0;
};

Counted count_traffic(const Scene& scene) {
    const Model model = build_model(scene).value();
    const BlockPattern pattern = build_block_pattern(model.num_vertices, model.tets);
    const StepSettings settings = step_settings(scene, model);
    EngineOn<DeviceLikeExec> device({model, pattern, settings, scene.gravity, 1});
    device.step();  // everything that is constant has been uploaded
    Counted out;
    out.num_vertices = model.num_vertices;
    DeviceLikeExec::traffic() = {};
    for (; out.steps < 4; ++out.steps) {
        const StepReport report = device.step();
        EXPECT_EQ(report.outcome, Outcome::Converged) << report.message;
        EXPECT_GT(report.contacts, 0);
        out.newton += report.newton;
    }
    out.traffic = DeviceLikeExec::traffic();
    return out;
}

TEST(DeviceTraffic, IsAHandfulOfScalarsPerNewtonIterationWhateverTheMesh) {
    const Counted small = count_traffic(drop(3));
    const Counted large = count_traffic(drop(9));
    ASSERT_GT(large.num_vertices, 8 * small.num_vertices);
    for (const Counted& run : {small, large}) {
        // The state of PCG is the largest; nothing is per vertex or per pair.
        EXPECT_LE(run.traffic.largest, 256);
        EXPECT_LE(run.traffic.bytes, 1024L * run.newton);
        // A step asks for the energies and bounds of its start, and for the change of
        // friction, besides.
        EXPECT_LE(run.traffic.waits, 10L * run.newton + 12L * run.steps);
        // One copy of the positions per step starts on its way and is not waited for.
        EXPECT_EQ(run.traffic.arriving, run.steps * 24L * run.num_vertices);
    }
    const auto per_newton = [](const Counted& run) {
        return static_cast<double>(run.traffic.bytes) / run.newton;
    };
    EXPECT_LT(per_newton(large), 1.5 * per_newton(small));
    RecordProperty("bytes_per_newton_small", static_cast<int>(per_newton(small)));
    RecordProperty("bytes_per_newton_large", static_cast<int>(per_newton(large)));
    RecordProperty("waits_per_newton_large",
                   static_cast<int>(large.traffic.waits / large.newton));
    RecordProperty("loops_per_newton_large",
                   static_cast<int>(large.traffic.launches / large.newton));
}

TEST(DeviceTraffic, SendsPrescribedMotionsOnceAStepAndOnlyThose) {
    Scene scene = drop(4);
    BoundaryCondition lid;
    lid.kind = BoundaryCondition::Kind::Velocity;
    lid.selection.kind = Selection::Kind::Box;
    lid.selection.box_min = {0, 1, 0};  // of the mesh's box: the top
    lid.linear = {0, -0.1, 0};
    scene.bodies[0].boundary = {lid};
    const Counted run = count_traffic(scene);
    EXPECT_LE(run.traffic.largest, 24L * 25);  // 5 x 5 vertices
}

TEST(GuardedEngine, ReportsAFullDeviceAndKeepsTheLastWholeStep) {
    Scene scene = drop(3);
    scene.bodies[0].transform.rows[1][3] = 0.53;  // some steps of free fall first
    const Model model = build_model(scene).value();
    const BlockPattern pattern = build_block_pattern(model.num_vertices, model.tets);
    const StepSettings settings = step_settings(scene, model);
    const EngineInput input{model, pattern, settings, scene.gravity, 1};
    GuardedEngine<DeviceLikeExec> engine(input, "a small device");
    ASSERT_EQ(engine.step().outcome, Outcome::Converged);
    test::DeviceMemory::limit() = test::DeviceMemory::used();  // not a byte more
    StepReport report;
    for (int k = 0; k < 20 && report.outcome == Outcome::Converged; ++k)
        report = engine.step();
    EXPECT_EQ(report.outcome, Outcome::DeviceFailed);
    EXPECT_NE(report.message.find("a small device: not enough memory on the device"),
              std::string::npos)
        << report.message;
    EXPECT_EQ(report.step, engine.steps() + 1);
    const StepState after = engine.state();
    EXPECT_EQ(after.steps, engine.steps());
    EXPECT_GT(after.steps, 3);
    for (const Vec3d& x : after.x)
        EXPECT_TRUE(std::isfinite(norm_sq(x)));
    EXPECT_EQ(engine.contact_forces().size(), after.x.size());

    // With memory again, the simulation goes on from there as if nothing had happened.
    test::DeviceMemory::limit() = std::size_t{1} << 33;
    GuardedEngine<DeviceLikeExec> fresh(input, "a large device");
    fresh.set_state(after);
    EXPECT_EQ(fresh.step().outcome, Outcome::Converged);
    EXPECT_EQ(engine.step().outcome, Outcome::Converged);
    EXPECT_EQ(largest_difference(engine.positions(), fresh.positions()), 0.0);
}

TEST(GuardedEngine, ThrowsWhenTheDeviceIsFullFromTheStart) {
    const Scene scene = pile();
    const Model model = build_model(scene).value();
    const BlockPattern pattern = build_block_pattern(model.num_vertices, model.tets);
    const StepSettings settings = step_settings(scene, model);
    test::DeviceMemory::limit() = 100000;
    EXPECT_THROW(GuardedEngine<DeviceLikeExec>(
                     {model, pattern, settings, scene.gravity, 1}, "a tiny device"),
                 DeviceFull);
    test::DeviceMemory::limit() = std::size_t{1} << 33;
}

TEST(DeviceEstimate, IsNearWhatARunTakes) {
    for (const int cells : {6, 14}) {
        const Scene scene = drop(cells);
        const Model model = build_model(scene).value();
        const BlockPattern pattern = build_block_pattern(model.num_vertices, model.tets);
        const StepSettings settings = step_settings(scene, model);
        EngineOn<DeviceLikeExec> device({model, pattern, settings, scene.gravity, 1});
        for (int k = 0; k < 2; ++k)
            ASSERT_EQ(device.step().outcome, Outcome::Converged);
        constexpr double kFixed = 64e6;  // of the runtime, which this executor lacks
        const double estimate =
            static_cast<double>(estimate_device_bytes(model, pattern, false)) - kFixed;
        const double taken = 1.25 * static_cast<double>(test::DeviceMemory::asked());
        EXPECT_GT(estimate, 0.8 * taken) << cells;
        EXPECT_LT(estimate, 4.0 * taken) << cells;
    }
}

TEST(DeviceEstimate, SaysWithNumbersThatMemoryDoesNotSuffice) {
    const Scene scene = drop(6);
    const Model model = build_model(scene).value();
    const BlockPattern pattern = build_block_pattern(model.num_vertices, model.tets);
    const StepSettings settings = step_settings(scene, model);
    const EngineInput input{model, pattern, settings, scene.gravity, 1};
    const CudaDevice gpu{"GPU", std::size_t{1} << 30};
    EXPECT_EQ(device_memory_trouble(input, gpu, std::size_t{1} << 34, 1), "");
    EXPECT_NE(device_memory_trouble(input, gpu, std::size_t{1} << 30, 1), "");
    const std::string trouble =
        device_memory_trouble(input, gpu, std::size_t{10} << 20, std::size_t{40} << 20);
    EXPECT_NE(trouble.find("not enough memory on GPU"), std::string::npos) << trouble;
    EXPECT_NE(trouble.find("10.0 MB of 40.0 MB are free"), std::string::npos) << trouble;
}

TEST(CudaEngine, MatchesTheCpu) {
    Scene scene = pile();
    scene.solver.tolerance = 1e-4;
    scene.solver.pcg_tolerance = 1e-8;
    SimulatorOptions options;
    options.device = Device::Cuda;
    Result<Simulator> cuda = Simulator::create(scene, options);
    if (!cuda) {
        ASSERT_EQ(cuda.error().code, Error::Code::NoDevice);
        GTEST_SKIP() << cuda.error().message;
    }
    options.device = Device::Cpu;
    Result<Simulator> cpu = Simulator::create(scene, options);
    ASSERT_TRUE(cpu);
    for (int k = 0; k < kSteps; ++k) {
        const StepReport report = cuda.value().step();
        ASSERT_EQ(report.outcome, Outcome::Converged) << report.message;
        ASSERT_EQ(cpu.value().step().outcome, Outcome::Converged);
    }
    EXPECT_EQ(cuda.value().verify().num_intersections, 0);
    const auto& a = cuda.value().positions();
    const auto& b = cpu.value().positions();
    ASSERT_EQ(a.size(), b.size());
    const double tolerance = cpu.value().resolved().tolerance * scene.dt * kSteps;
    for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            ASSERT_NEAR(a[i][c], b[i][c], tolerance) << "vertex " << i;
}

}  // namespace
}  // namespace noli
