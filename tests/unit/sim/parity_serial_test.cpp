// SPDX-License-Identifier: Apache-2.0
#include "parity_serial.hpp"

namespace noli::test {

std::vector<LoopResult> run_loops_serially(const LoopInput& in) {
    return run_loops<SerialExec>(in);
}

namespace {

/// Parity of empty lists would prove nothing.
TEST(LoopParityScenes, MeetEveryKindOfPairAndSolveEverySystem) {
    std::vector<double> pairs(6, 0.0);
    for (const Scene& scene : parity_scenes()) {
        const LoopCase at(scene, kStepsToContact);
        const auto all = run_loops_serially(at.input());
        EXPECT_GT(all.size(), 40U);
        for (std::size_t list = 0; list < pairs.size(); ++list)
            pairs[list] += static_cast<double>(all[list].values.size());
        for (const LoopResult& result : all) {
            for (const double value : result.values)
                EXPECT_FALSE(std::isnan(value)) << scene.name << ": " << result.name;
            if (result.name == "solved") {
                EXPECT_EQ(result.values[0], 1.0) << scene.name;
            }
        }
    }
    for (std::size_t list = 0; list < pairs.size(); ++list)
        EXPECT_GT(pairs[list], 0.0) << "list " << list;
}

}  // namespace
}  // namespace noli::test
