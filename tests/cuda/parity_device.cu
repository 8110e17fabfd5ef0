// SPDX-License-Identifier: Apache-2.0
#include "exec/cuda.cuh"
#include "parity_device.hpp"

namespace noli::test {

std::vector<LoopResult> run_loops_on_cuda(const LoopInput& in) {
    return run_loops<CudaExec>(in);
}

}  // namespace noli::test
