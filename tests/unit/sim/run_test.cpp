// SPDX-License-Identifier: Apache-2.0
#include "noli/simulator.hpp"

#include "output/file.hpp"
#include "output/stats.hpp"
#include "sim/run_repro.hpp"
#include "unit/output/scratch_folder.hpp"

#include <gtest/gtest.h>

#include <filesystem>

namespace noli {
namespace {

/// A box in free fall, 10 steps.
Scene falling_box() {
    Scene scene;
    scene.name = "falling box";
    scene.duration = 0.1;
    scene.dt = 0.01;
    scene.bodies.emplace_back();
    scene.bodies[0].name = "box";
    scene.bodies[0].mesh.generator = "box";
    return scene;
}

RunOptions into(const std::string& directory) {
    RunOptions options;
    options.directory = directory;
    options.simulator.device = Device::Cpu;
    return options;
}

TEST(RunScene, CallsBackForEveryStep) {
    const ScratchFolder scratch;
    RunOptions options = into(scratch / "run");
    std::vector<int> range;
    std::vector<int> steps;
    options.on_start = [&](const Resolved& resolved, int first, int last) {
        EXPECT_GT(resolved.num_vertices, 0);
        range = {first, last};
    };
    options.on_step = [&](const StepReport& report) { steps.push_back(report.step); };
    const Result<RunSummary> summary = run_scene(falling_box(), options);
    ASSERT_TRUE(summary) << summary.error().where << ": " << summary.error().message;
    EXPECT_EQ(range, (std::vector<int>{1, 10}));
    EXPECT_EQ(steps, (std::vector<int>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10}));
    EXPECT_EQ(summary.value().steps_done, 10);
    EXPECT_FALSE(summary.value().interrupted);
    EXPECT_NEAR(summary.value().time, 0.1, 1e-15);
}

TEST(RunScene, EndsInTheStateOfTheSimulatorAlone) {
    const ScratchFolder scratch;
    const Result<RunSummary> summary = run_scene(falling_box(), into(scratch / "run"));
    ASSERT_TRUE(summary);
    SimulatorOptions options;
    options.device = Device::Cpu;
    Result<Simulator> alone = Simulator::create(falling_box(), options);
    ASSERT_TRUE(alone);
    for (int i = 0; i < 10; ++i)
        alone.value().step();
    EXPECT_EQ(summary.value().state_hash, alone.value().state_hash());
}

TEST(RunScene, StopsWhenAskedAndResumesBitwise) {
    const ScratchFolder scratch;
    const Result<RunSummary> whole = run_scene(falling_box(), into(scratch / "whole"));
    ASSERT_TRUE(whole);
    std::atomic<bool> stop{false};
    RunOptions options = into(scratch / "run");
    options.stop = &stop;
    options.on_step = [&](const StepReport& report) { stop = report.step == 4; };
    const Result<RunSummary> first = run_scene(falling_box(), options);
    ASSERT_TRUE(first);
    EXPECT_TRUE(first.value().interrupted);
    EXPECT_EQ(first.value().steps_done, 4);

    std::vector<std::string> notes;
    RunOptions rest = into(scratch / "run");
    rest.resume = true;
    rest.on_note = [&](const std::string& text) { notes.push_back(text); };
    const Result<RunSummary> second = run_scene(falling_box(), rest);
    ASSERT_TRUE(second);
    EXPECT_EQ(second.value().steps_done, 10);
    EXPECT_EQ(second.value().state_hash, whole.value().state_hash);
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_NE(notes[0].find("after step 4"), std::string::npos);
    for (const char* frame :
         {"frames/frame_000003.vtu", "frames/frame_000010.vtu", "frames.pvd"})
        EXPECT_EQ(read_file(scratch / ("run/" + std::string(frame))).value(),
                  read_file(scratch / ("whole/" + std::string(frame))).value())
            << frame;
}

TEST(RunScene, RefusesWhatItCannotDo) {
    const ScratchFolder scratch;
    EXPECT_EQ(run_scene(falling_box(), into("")).error().code, Error::Code::RunDirectory);
    RunOptions both = into(scratch / "run");
    both.resume = both.overwrite = true;
    EXPECT_EQ(run_scene(falling_box(), both).error().code, Error::Code::RunDirectory);
    Scene scene = falling_box();
    scene.output.formats = {"stl"};
    const Result<RunSummary> run = run_scene(scene, into(scratch / "run"));
    EXPECT_EQ(run.error().code, Error::Code::InvalidScene);
    EXPECT_FALSE(std::filesystem::exists(scratch / "run"));
}

TEST(RunScene, WritesOnlyTheInitialStateWithZeroSteps) {
    const ScratchFolder scratch;
    RunOptions options = into(scratch / "run");
    options.steps = 0;
    const Result<RunSummary> summary = run_scene(falling_box(), options);
    ASSERT_TRUE(summary);
    EXPECT_EQ(summary.value().steps_done, 0);
    EXPECT_EQ(list_folder(scratch / "run/frames"),
              std::vector<std::string>{"frame_000000.vtu"});
    EXPECT_EQ(read_file(scratch / "run/stats.csv").value(), kStatsHeader);
}

TEST(ReproCommand, NamesTheOptionsOfTheRun) {
    SimulatorOptions options;
    EXPECT_EQ(repro_command(options, 7, false),
              "noli run scene.json -o run --overwrite --steps 7 --iteration-log");
    options.threads = 2;
    options.device = Device::Cpu;
    options.verify = true;
    EXPECT_EQ(repro_command(options, 7, true),
              "noli run scene.json -o run --resume --steps 7 --iteration-log --threads 2 "
              "--device cpu --verify");
}

}  // namespace
}  // namespace noli
