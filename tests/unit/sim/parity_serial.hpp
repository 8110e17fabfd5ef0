// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The reference of loop parity. Each executor's instance of all loops is a file of its
/// own: they take long to compile.

#include "parity/compare.hpp"

namespace noli::test {

/// Defined in parity_serial_test.cpp.
std::vector<LoopResult> run_loops_serially(const LoopInput& in);

class LoopParity : public testing::TestWithParam<int> {
  protected:
    template <class Exec>
    static void expect_parity() {
        const Scene scene = parity_scenes()[static_cast<std::size_t>(GetParam())];
        const LoopCase at(scene, kStepsToContact);
        expect_same_loops(run_loops<Exec>(at.input()), run_loops_serially(at.input()));
    }
};

}  // namespace noli::test
