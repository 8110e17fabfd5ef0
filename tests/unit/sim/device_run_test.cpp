// SPDX-License-Identifier: Apache-2.0
/// run_scene on a device, without a GPU: an executor that takes its decisions, counts
/// what crosses to the host and can run out of memory is put in its place.
#include "noli/simulator.hpp"

#include "output/checkpoint.hpp"
#include "output/file.hpp"
#include "output/run_folder.hpp"
#include "parity/scenes.hpp"
#include "sim/guarded_engine.hpp"
#include "support/device_like_exec.hpp"
#include "unit/output/scratch_folder.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace noli {
namespace {

using test::DeviceLikeExec;
using test::DeviceMemory;

constexpr int kSteps = 9;

class RunOnDevice : public testing::Test {
  protected:
    void SetUp() override {
        device_engine_maker() =
            [](const EngineInput& input) -> Result<std::unique_ptr<Engine>> {
            return std::unique_ptr<Engine>(
                std::make_unique<GuardedEngine<DeviceLikeExec>>(input, "a small device"));
        };
    }
    void TearDown() override {
        device_engine_maker() = make_cuda_engine;
        DeviceMemory::limit() = std::size_t{1} << 33;
    }

    [[nodiscard]] static Scene scene() {
        Scene scene = test::pile_of_boxes();
        scene.bodies[1].transform.rows[1][3] += 0.06;  // touches in step 5 or so
        scene.duration = kSteps * scene.dt;
        scene.output.every = 0;
        scene.output.checkpoint_seconds = 1e6;
        return scene;
    }
    [[nodiscard]] RunOptions into(const std::string& name) const {
        RunOptions options;
        options.directory = scratch_ / name;
        options.simulator.device = Device::Cuda;
        return options;
    }

    ScratchFolder scratch_;
};

TEST_F(RunOnDevice, EndsWithACheckpointWhenTheDeviceIsFullAndResumesBitwise) {
    const Result<RunSummary> whole = run_scene(scene(), into("whole"));
    ASSERT_TRUE(whole) << whole.error().message;
    ASSERT_EQ(whole.value().steps_done, kSteps);

    // The boxes touch later: then there is no room for their contacts.
    RunOptions options = into("run");
    options.on_step = [](const StepReport& report) {
        if (report.step == 2) DeviceMemory::limit() = DeviceMemory::used();
    };
    const Result<RunSummary> full = run_scene(scene(), options);
    ASSERT_TRUE(full) << full.error().message;
    EXPECT_EQ(full.value().outcome, Outcome::DeviceFailed);
    EXPECT_NE(
        full.value().message.find("a small device: not enough memory on the device"),
        std::string::npos)
        << full.value().message;
    EXPECT_NE(full.value().message.find(" MB asked for"), std::string::npos);
    EXPECT_GE(full.value().steps_done, 2);
    ASSERT_LT(full.value().steps_done, kSteps);

    const RunPaths paths(scratch_ / "run");
    const Result<RunRecord> record =
        decode_run_record(read_file(paths.record).value(), "run.json");
    ASSERT_TRUE(record) << record.error().message;
    EXPECT_EQ(record.value().status, "failed");
    EXPECT_EQ(record.value().outcome, "device_failed");
    EXPECT_EQ(record.value().steps_done, full.value().steps_done);
    const FoundCheckpoint found =
        load_newest_checkpoint(paths.checkpoints, record.value().fingerprint);
    ASSERT_TRUE(found.found);
    EXPECT_EQ(found.checkpoint.step, full.value().steps_done);
    EXPECT_EQ(found.checkpoint.state_hash, record.value().state_hash);

    DeviceMemory::limit() = std::size_t{1} << 33;
    RunOptions rest = into("run");
    rest.resume = true;
    const Result<RunSummary> resumed = run_scene(scene(), rest);
    ASSERT_TRUE(resumed) << resumed.error().message;
    EXPECT_EQ(resumed.value().outcome, Outcome::Converged);
    EXPECT_EQ(resumed.value().steps_done, kSteps);
    EXPECT_EQ(resumed.value().state_hash, whole.value().state_hash);
}

TEST_F(RunOnDevice, BringsTheStateToTheHostOnlyWhereItIsWritten) {
    std::vector<long> largest;
    RunOptions options = into("run");
    options.on_step = [&](const StepReport& /*report*/) {
        largest.push_back(DeviceLikeExec::traffic().largest);
        DeviceLikeExec::traffic() = {};
    };
    Scene quiet = scene();
    quiet.output.hash_every = 6;
    const Result<RunSummary> summary = run_scene(quiet, options);
    ASSERT_TRUE(summary) << summary.error().message;
    ASSERT_EQ(largest.size(), std::size_t{kSteps});
    for (std::size_t step = 2; step <= kSteps; ++step)
        EXPECT_EQ(largest[step - 1] > 1000, step == 6)
            << step << ' ' << largest[step - 1];
    EXPECT_NE(summary.value().state_hash, 0U);
    RunOptions every_step = into("hashed");
    quiet.output.hash_every = 1;
    const Result<RunSummary> hashed = run_scene(quiet, every_step);
    ASSERT_TRUE(hashed);
    EXPECT_EQ(summary.value().state_hash, hashed.value().state_hash);
}

}  // namespace
}  // namespace noli
