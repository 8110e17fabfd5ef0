// SPDX-License-Identifier: Apache-2.0
/// A GPU against the CPU: every loop of a Newton iteration, and whole steps of scenes.
#include "noli/simulator.hpp"

#include "parity/compare.hpp"
#include "parity_device.hpp"

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

namespace noli::test {
namespace {

class OnGpu : public testing::TestWithParam<int> {
  protected:
    void SetUp() override {
        const Result<CudaDevice> device = find_cuda_device();
        if (!device) GTEST_SKIP() << device.error().message;
    }
    [[nodiscard]] static Scene scene() {
        return parity_scenes()[static_cast<std::size_t>(GetParam())];
    }
};
INSTANTIATE_TEST_SUITE_P(Scenes, OnGpu, testing::Range(0, kNumParityScenes));

TEST_P(OnGpu, EveryLoopMatchesTheCpu) {
    const LoopCase at(scene(), kStepsToContact);
    expect_same_loops(run_loops_on_cuda(at.input()), run_loops<SerialExec>(at.input()));
}

TEST_P(OnGpu, EveryLoopRepeatsBitwise) {
    const LoopCase at(scene(), kStepsToContact);
    const auto first = run_loops_on_cuda(at.input());
    const auto second = run_loops_on_cuda(at.input());
    ASSERT_EQ(first.size(), second.size());
    for (std::size_t k = 0; k < first.size(); ++k)
        if (first[k].repeats) {
            EXPECT_EQ(first[k].values, second[k].values) << first[k].name;
        }
}

/// Both end a step within the tolerance of Newton's method, tolerance * dt, of the same
/// minimum; what one step is off moves the next one's start and its velocity, so that the
/// difference grows with the steps, not faster as long as nothing is about to tip over.
TEST_P(OnGpu, FiftyStepsMatchTheCpu) {
    constexpr int kSteps = 50;
    Scene scene = OnGpu::scene();
    scene.solver.tolerance = 1e-4;
    scene.solver.pcg_tolerance = 1e-8;
    SimulatorOptions options;
    options.verify = true;
    options.device = Device::Cuda;
    Result<Simulator> gpu = Simulator::create(scene, options);
    ASSERT_TRUE(gpu) << gpu.error().message;
    options.device = Device::Cpu;
    Result<Simulator> cpu = Simulator::create(scene, options);
    ASSERT_TRUE(cpu);
    const double per_step = cpu.value().resolved().tolerance * scene.dt;
    for (int k = 1; k <= kSteps; ++k) {
        const StepReport report = gpu.value().step();
        ASSERT_EQ(report.outcome, Outcome::Converged) << k << ": " << report.message;
        EXPECT_EQ(report.intersections + report.inversions, 0) << k;
        ASSERT_EQ(cpu.value().step().outcome, Outcome::Converged);
        double largest = 0.0;
        const auto a = gpu.value().positions();
        const auto b = cpu.value().positions();
        for (std::size_t i = 0; i < a.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c)
                largest = std::max(largest, std::fabs(a[i][c] - b[i][c]));
        ASSERT_LE(largest, 2.0 * k * per_step) << "step " << k;
    }
}

TEST_P(OnGpu, StepsRepeatBitwise) {
    SimulatorOptions options;
    options.device = Device::Cuda;
    std::uint64_t hash[2];
    for (std::uint64_t& h : hash) {
        Result<Simulator> gpu = Simulator::create(scene(), options);
        ASSERT_TRUE(gpu) << gpu.error().message;
        for (int k = 0; k < 10; ++k)
            ASSERT_EQ(gpu.value().step().outcome, Outcome::Converged);
        h = gpu.value().state_hash();
    }
    EXPECT_EQ(hash[0], hash[1]);
}

/// Numbers that are added in the order of arrival differ from run to run.
TEST(Sources, AddNoNumbersAtomically) {
    namespace fs = std::filesystem;
    const std::regex atomic(R"(\batomic(Add|Sub|Exch|CAS|Min|Max)\b|__reduce_add)");
    int num_files = 0;
    for (const auto& entry :
         fs::recursive_directory_iterator(std::string(NOLI_SOURCE_DIR) + "/src")) {
        const std::string extension = entry.path().extension().string();
        if (extension != ".hpp" && extension != ".cuh" && extension != ".cu") continue;
        // The product of the supplement, for comparison only: its boundary lanes add.
        if (entry.path().filename() == "cuda_warp.cuh") continue;
        std::ifstream file(entry.path());
        std::stringstream text;
        text << file.rdbuf();
        EXPECT_FALSE(std::regex_search(text.str(), atomic)) << entry.path();
        ++num_files;
    }
    EXPECT_GT(num_files, 100);
}

}  // namespace
}  // namespace noli::test
