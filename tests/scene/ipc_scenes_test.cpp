// SPDX-License-Identifier: Apache-2.0
/// Real scenes of the field, if they are at hand: every step exactly intersection-free,
/// without inversions, converged, with about the reference's number of Newton iterations.

#include "scene_support.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>

namespace noli::test {
namespace {

const std::string kScenes = std::string(NOLI_SHARED_DIR) + "/ipc-scenes/";

struct Reference {
    const char* name;
    const char* script;
    int steps;
    int newton;  ///< of the field's CPU reference program, same steps
    const char* positions = nullptr;  ///< its last positions, where they can be compared
};

/// Positions that the reference program ended with; empty if the file is not there.
std::vector<Vector3> reference_positions(const std::string& name) {
    std::ifstream in(kScenes + "reference/" + name);
    std::vector<Vector3> out;
    std::string line;
    while (std::getline(in, line)) {
        if (line.starts_with('#')) continue;
        Vector3 p{};
        std::istringstream(line) >> p[0] >> p[1] >> p[2];
        out.push_back(p);
    }
    return out;
}

struct Difference {
    double diagonal;              ///< of the reference's bounding box, m
    double mean;                  ///< distance of the mean positions, m
    double box;                   ///< largest difference of the bounding boxes, m
    double median, p95, largest;  ///< per-vertex distances, m
};

double distance(const Vector3& a, const Vector3& b) {
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

Difference difference(const std::vector<Vector3>& ours,
                      const std::vector<Vector3>& reference) {
    Difference out{};
    Vector3 extent{};
    for (std::size_t k = 0; k < 3; ++k) {
        const auto less = [k](const Vector3& a, const Vector3& b) { return a[k] < b[k]; };
        const auto [a0, a1] = std::minmax_element(ours.begin(), ours.end(), less);
        const auto [b0, b1] =
            std::minmax_element(reference.begin(), reference.end(), less);
        out.box = std::max(
            {out.box, std::abs((*a0)[k] - (*b0)[k]), std::abs((*a1)[k] - (*b1)[k])});
        extent[k] = (*b1)[k] - (*b0)[k];
    }
    out.diagonal = std::hypot(extent[0], extent[1], extent[2]);
    out.mean = distance(mean(ours), mean(reference));
    std::vector<double> apart;
    for (std::size_t i = 0; i < ours.size(); ++i)
        apart.push_back(distance(ours[i], reference[i]));
    std::sort(apart.begin(), apart.end());
    out.median = apart[apart.size() / 2];
    out.p95 = apart[apart.size() * 95 / 100];
    out.largest = apart.back();
    return out;
}

class IpcScene : public ::testing::TestWithParam<Reference> {};

TEST_P(IpcScene, RunsCleanWithinTheReferenceIterations) {
    const Reference& reference = GetParam();
    const std::string path = kScenes + reference.script;
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
    Result<Scene> scene = read_scene(path);
    ASSERT_TRUE(bool(scene)) << scene.error().where << ": " << scene.error().message;
    // The reference's own stopping rules.
    scene.value().solver.tolerance = 1e-2;
    scene.value().solver.gap_tolerance = 0.0;
    scene.value().contact.friction_iterations = 1;
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
    if (reference.positions == nullptr || HasFailure()) return;
    const std::vector<Vector3> theirs = reference_positions(reference.positions);
    std::vector<Vector3> ours = simulator.positions();
    ASSERT_GE(ours.size(), theirs.size());
    ours.resize(theirs.size());  // ours are followed by those of the obstacles
    const Difference apart = difference(ours, theirs);
    std::printf(
        "  apart, relative to the diagonal of %.3f m: mean %.2e, box %.2e, "
        "vertices %.2e (median) %.2e (95 %%) %.2e (largest)\n",
        apart.diagonal,
        apart.mean / apart.diagonal,
        apart.box / apart.diagonal,
        apart.median / apart.diagonal,
        apart.p95 / apart.diagonal,
        apart.largest / apart.diagonal);
    // Two programs may end each step anywhere within the tolerance of the solution, so
    // after n steps they may be n tolerances apart; they are not.
    const double per_step =
        scene.value().solver.tolerance * simulator.resolved().diagonal * scene.value().dt;
    EXPECT_LE(apart.mean, 2.0 * per_step);
    EXPECT_LE(apart.box, 10.0 * per_step);
    EXPECT_LE(apart.p95, 10.0 * per_step);
}

// Counts of REFERENCE.md and NEWTON_COUNTS.md.
INSTANTIATE_TEST_SUITE_P(
    Reference,
    IpcScene,
    ::testing::Values(
        Reference{"cubes_fall", "input/tutorialExamples/2cubesFall.txt", 200, 737},
        Reference{"cube_stack", "input/paperExamples/10_cubeStack.txt", 200, 651},
        Reference{
            "rods_twist", "timed/rodsTwist_120.txt", 120, 295, "rodsTwist.step120.txt"},
        Reference{"mat_twist", "timed/mat40x40_twist_100.txt", 100, 595},
        Reference{"rollers", "timed/sphere1K_rollers_25.txt", 25, 1352},
        Reference{
            "dolphin", "timed/dolphinFunnel_50.txt", 50, 596, "dolphinFunnel.step50.txt"},
        Reference{
            "spike_spike", "input/paperExamples/11_erleben/spikeSpikeCO.txt", 60, 174}),
    [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace noli::test
