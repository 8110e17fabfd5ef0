// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The loops of parity/loops.hpp on a GPU, behind a face that needs no CUDA compiler.

#include "parity/loops.hpp"

namespace noli::test {

std::vector<LoopResult> run_loops_on_cuda(const LoopInput& in);

}  // namespace noli::test
