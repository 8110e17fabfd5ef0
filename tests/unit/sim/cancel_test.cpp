// SPDX-License-Identifier: Apache-2.0
/// A step that is cancelled in the middle has never been: the state before it is kept bit
/// for bit, and what follows is what an undisturbed run does.
#include "noli/simulator.hpp"

#include "linear/block_pattern.hpp"
#include "output/file.hpp"
#include "output/hash.hpp"
#include "output/run_folder.hpp"
#include "output/stats.hpp"
#include "parity/scenes.hpp"
#include "sim/guarded_engine.hpp"
#include "sim/state_bytes.hpp"
#include "sim/step_settings.hpp"
#include "support/device_like_exec.hpp"
#include "support/stopping_exec.hpp"
#include "unit/output/scratch_folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>

namespace noli {
namespace {

using test::StoppingExec;
using test::StopPlan;

constexpr const char* kBeforeSolve = "step/right_hand_side";
constexpr const char* kAfterSolve = "step/trial_point";

/// A box whose top is pushed to the ground and let go when it is low enough, in step 3.
Scene dropped_box() {
    Scene scene = test::pile_of_boxes();
    scene.bodies.resize(1);
    scene.bodies[0].transform.rows[1][3] = 0.53;
    BoundaryCondition lower;
    lower.kind = BoundaryCondition::Kind::Velocity;
    lower.linear = {0, -0.5, 0};
    lower.selection.kind = Selection::Kind::Box;
    lower.selection.box_min = {0, 1, 0};  // of the mesh's box: the top
    lower.until = BoundaryCondition::Until{
        .axis = 1, .above = false, .value = 1.0205, .then_hold = false};
    scene.bodies[0].boundary = {lower};
    return scene;
}

Scene sagging_bar() {
    Scene scene = test::twisted_bar();
    scene.gravity = {0, -9.8, 0};
    scene.solver.integrator = Integrator::Newmark;
    return scene;
}

template <class Exec>
class Cancelled : public testing::Test {
  protected:
    struct Parts {
        explicit Parts(const Scene& scene)
            : model(build_model(scene).value()),
              pattern(build_block_pattern(model.num_vertices, model.tets)),
              settings(step_settings(scene, model)),
              engine({model, pattern, settings, scene.gravity, 1}) {}
        [[nodiscard]] std::vector<std::byte> bytes() {
            return encode_state(engine.state());
        }
        Model model;
        BlockPattern pattern;
        StepSettings settings;
        EngineOn<StoppingExec<Exec>> engine;
    };

    /// Cancels the next step of `parts` at every place there is; how many there are.
    static int cancel_everywhere(Parts& parts, const char* loop) {
        const std::vector<std::byte> before = parts.bytes();
        const std::vector<Vec3d> x = parts.engine.positions();
        int count = 0;
        for (;; ++count) {
            StopPlan::set(loop, count + 1);
            const StepReport report = parts.engine.step(&StopPlan::get().stop);
            if (report.outcome == Outcome::Converged) return count;
            EXPECT_EQ(report.outcome, Outcome::Cancelled) << report.message;
            EXPECT_NE(report.message.find("given up on request after "),
                      std::string::npos);
            EXPECT_EQ(parts.engine.steps() + 1, report.step);
            EXPECT_TRUE(parts.bytes() == before) << "after " << count << " " << loop;
            EXPECT_TRUE(std::ranges::equal(
                parts.engine.positions(), x, [](const Vec3d& a, const Vec3d& b) {
                    return norm_sq(a - b) == 0.0;
                }));
            if (testing::Test::HasFailure()) return count;
        }
    }

    static void expect_undisturbed(const Scene& scene, int steps) {
        Parts undisturbed(scene);
        Parts cancelled(scene);
        int places = 0;
        for (int k = 0; k < steps; ++k) {
            StopPlan::set("", 0);
            ASSERT_EQ(undisturbed.engine.step().outcome, Outcome::Converged);
            places +=
                cancel_everywhere(cancelled, k % 2 == 0 ? kAfterSolve : kBeforeSolve);
            ASSERT_TRUE(cancelled.bytes() == undisturbed.bytes()) << "step " << k + 1;
        }
        EXPECT_GT(places, steps);
    }
};

using Executors = testing::Types<SerialExec, test::DeviceLikeExec>;
TYPED_TEST_SUITE(Cancelled, Executors);

TYPED_TEST(Cancelled, LeavesNoTraceInContactAndFriction) {
    this->expect_undisturbed(test::pile_of_boxes(), 3);
}
TYPED_TEST(Cancelled, LeavesNoTraceOfConditionsThatEnd) {
    Scene scene = dropped_box();
    this->expect_undisturbed(scene, 5);
}
TYPED_TEST(Cancelled, LeavesNoTraceOfAFirstNewmarkStep) {
    this->expect_undisturbed(sagging_bar(), 2);
}
TYPED_TEST(Cancelled, LeavesNoTraceInBdf2) {
    this->expect_undisturbed(test::squeezed_ball(), 3);
}

TYPED_TEST(Cancelled, HasTheContactForcesOfTheStateBefore) {
    typename TestFixture::Parts parts(test::tower_of_boxes());
    StopPlan::set("", 0);
    for (int k = 0; k < 3; ++k)
        ASSERT_EQ(parts.engine.step().outcome, Outcome::Converged);
    const double before = parts.engine.barrier_energy();
    EXPECT_GT(before, 0.0);
    StopPlan::set(kAfterSolve, 2);
    ASSERT_EQ(parts.engine.step(&StopPlan::get().stop).outcome, Outcome::Cancelled);
    EXPECT_NEAR(parts.engine.barrier_energy(), before, 1e-12 * before);
}

/// A step that Newton cannot finish in a lifetime, and a request from another thread.
TEST(Simulator, EndsAnEndlessStepOnRequest) {
    Scene scene = test::pile_of_boxes();
    scene.solver.tolerance_per_step = {1e-2, 1e-2, 1e-300};
    scene.solver.max_newton = 1'000'000'000;
    SimulatorOptions options;
    options.device = Device::Cpu;
    options.verify = true;
    Result<Simulator> made = Simulator::create(scene, options);
    ASSERT_TRUE(made);
    Simulator& simulator = made.value();
    ASSERT_EQ(simulator.step().outcome, Outcome::Converged);
    ASSERT_EQ(simulator.step().outcome, Outcome::Converged);
    const std::uint64_t before = simulator.state_hash();
    std::atomic<bool> stop{false};
    std::thread other([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        stop = true;
    });
    const StepReport report = simulator.step(&stop);
    other.join();
    EXPECT_EQ(report.outcome, Outcome::Cancelled) << report.message;
    EXPECT_STREQ(to_string(report.outcome), "cancelled");
    EXPECT_EQ(report.intersections, -1);  // there was nothing to test
    EXPECT_EQ(simulator.state_hash(), before);
    EXPECT_EQ(simulator.steps_done(), 2);
}

class CancelledRun : public testing::Test {
  protected:
    void SetUp() override {
        StopPlan::set("", 0);
        device_engine_maker() =
            [](const EngineInput& input) -> Result<std::unique_ptr<Engine>> {
            using Exec = StoppingExec<test::DeviceLikeExec>;
            return std::unique_ptr<Engine>(
                std::make_unique<GuardedEngine<Exec>>(input, "a device"));
        };
    }
    void TearDown() override { device_engine_maker() = make_cuda_engine; }

    [[nodiscard]] RunOptions into(const std::string& name) const {
        RunOptions options;
        options.directory = scratch_ / name;
        options.simulator.device = Device::Cuda;
        options.steps = 4;
        return options;
    }
    ScratchFolder scratch_;
};

TEST_F(CancelledRun, IsInterruptedAfterTheStepBeforeAndResumesBitwise) {
    Scene scene = test::pile_of_boxes();
    scene.output.checkpoint_seconds = 1e6;
    const Result<RunSummary> whole = run_scene(scene, into("whole"));
    ASSERT_TRUE(whole) << whole.error().message;
    RunOptions options = into("run");
    std::vector<int> said;
    options.on_step = [&](const StepReport& report) {
        said.push_back(report.step);
        // The first trial of a step is that of where it starts.
        if (report.step == 2) StopPlan::set(kAfterSolve, 2);
    };
    options.stop = &StopPlan::get().stop;
    const Result<RunSummary> first = run_scene(scene, options);
    ASSERT_TRUE(first) << first.error().message;
    EXPECT_TRUE(first.value().interrupted);
    EXPECT_EQ(first.value().outcome, Outcome::Converged);
    EXPECT_EQ(first.value().steps_done, 2);
    EXPECT_EQ(first.value().repro_folder, "");
    EXPECT_EQ(said, (std::vector<int>{1, 2}));

    const RunPaths paths(scratch_ / "run");
    const RunRecord record =
        decode_run_record(read_file(paths.record).value(), "run.json").value();
    EXPECT_EQ(record.status, "interrupted");
    EXPECT_EQ(record.outcome, "converged");
    EXPECT_EQ(record.state_hash, first.value().state_hash);
    EXPECT_NE(read_file(scratch_ / "run/log.txt")
                  .value()
                  .find("step 3 given up on request after 1 Newton iterations"),
              std::string::npos);

    StopPlan::set("", 0);
    RunOptions rest = into("run");
    rest.resume = true;
    const Result<RunSummary> second = run_scene(scene, rest);
    ASSERT_TRUE(second) << second.error().message;
    EXPECT_EQ(second.value().steps_done, 4);
    EXPECT_EQ(second.value().state_hash, whole.value().state_hash);
    EXPECT_EQ(list_folder(scratch_ / "run/frames"),
              list_folder(scratch_ / "whole/frames"));
}

}  // namespace
}  // namespace noli
