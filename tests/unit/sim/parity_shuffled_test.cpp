// SPDX-License-Identifier: Apache-2.0
#include "parity_serial.hpp"

namespace noli::test {
namespace {

class LoopParityShuffledExec : public LoopParity {};
INSTANTIATE_TEST_SUITE_P(Scenes,
                         LoopParityShuffledExec,
                         testing::Range(0, kNumParityScenes));

TEST_P(LoopParityShuffledExec, MatchesTheSerialReference) {
    expect_parity<ShuffledExec>();
}

}  // namespace
}  // namespace noli::test
