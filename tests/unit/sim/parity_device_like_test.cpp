// SPDX-License-Identifier: Apache-2.0
#include "parity_serial.hpp"
#include "support/device_like_exec.hpp"

namespace noli::test {
namespace {

class LoopParityDeviceLikeExec : public LoopParity {};
INSTANTIATE_TEST_SUITE_P(Scenes,
                         LoopParityDeviceLikeExec,
                         testing::Range(0, kNumParityScenes));

TEST_P(LoopParityDeviceLikeExec, MatchesTheSerialReference) {
    expect_parity<DeviceLikeExec>();
}

}  // namespace
}  // namespace noli::test
