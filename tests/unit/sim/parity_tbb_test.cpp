// SPDX-License-Identifier: Apache-2.0
#include "parity_serial.hpp"

namespace noli::test {
namespace {

class LoopParityCpuExec : public LoopParity {};
INSTANTIATE_TEST_SUITE_P(Scenes, LoopParityCpuExec, testing::Range(0, kNumParityScenes));

TEST_P(LoopParityCpuExec, MatchesTheSerialReference) {
    expect_parity<CpuExec>();
}

}  // namespace
}  // namespace noli::test
