// SPDX-License-Identifier: Apache-2.0
/// Real scenes of the field, if they are at hand: every step exactly intersection-free,
/// without inversions, converged, with about the reference's number of Newton iterations.

#include "scene_support.hpp"

namespace noli::test {
namespace {

const std::string kScenes = std::string(NOLI_SHARED_DIR) + "/ipc-scenes/";

struct Reference {
    const char* name;
    const char* script;
    int steps;
    int newton;  ///< of the field's CPU reference program, same steps
};

class IpcScene : public ::testing::TestWithParam<Reference> {};

TEST_P(IpcScene, RunsCleanWithinTheReferenceIterations) {
    const Reference& reference = GetParam();
    const std::string path = kScenes + reference.script;
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
    Result<Scene> scene = read_scene(path);
    ASSERT_TRUE(bool(scene)) << scene.error().where << ": " << scene.error().message;
    Simulator simulator = start(scene.value(), checked_options());
    int newton = 0;
    double seconds = 0.0;
    for (int k = 0; k < reference.steps && !HasFailure(); ++k) {
        const StepReport report = simulator.step();
        expect_clean(report);
        newton += report.newton;
        seconds += report.wall_s;
    }
    std::printf("%s: %d steps, %d Newton iterations (reference %d), %.2f s\n",
                reference.name,
                reference.steps,
                newton,
                reference.newton,
                seconds);
    EXPECT_LE(newton, 1.2 * reference.newton);
}

// Counts of REFERENCE.md and NEWTON_COUNTS.md; the longer scenes are run by bench/
// (docs/performance.md).
INSTANTIATE_TEST_SUITE_P(
    Reference,
    IpcScene,
    ::testing::Values(
        Reference{"cubes_fall", "input/tutorialExamples/2cubesFall.txt", 200, 737},
        Reference{"cube_stack", "input/paperExamples/10_cubeStack.txt", 200, 651},
        Reference{"rods_twist", "timed/rodsTwist_120.txt", 120, 295},
        Reference{
            "spike_spike", "input/paperExamples/11_erleben/spikeSpikeCO.txt", 60, 174}),
    [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace noli::test
