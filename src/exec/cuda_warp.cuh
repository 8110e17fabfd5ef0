// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The warp of exec/warp.hpp on a GPU. Its `add` is the only one in the program that adds
/// in the order of arrival: for comparison only.

#include "exec/warp.hpp"

#include <cuda_runtime_api.h>

namespace noli {

/// The warp that this thread is in; a register holds this thread's value. All 32 lanes
/// must be present in every call, so threads past the end may not return early.
struct CudaWarp {
    template <class T>
    using Register = T;
    static constexpr unsigned kAllLanes = 0xffffffffU;

    int lane;

    template <class F>
    __device__ auto each(F f) const {
        return f(lane);
    }
    template <class F>
    __device__ void run(F f) const {
        f(lane);
    }
    template <class T>
    __device__ static const T& at(const T& r, int /*lane*/) {
        return r;
    }
    template <class F>
    __device__ std::uint32_t ballot(F f) const {
        return __ballot_sync(kAllLanes, f(lane));
    }
    __device__ static double shuffle_down(double value, int delta) {
        return __shfl_down_sync(kAllLanes, value, static_cast<unsigned>(delta));
    }
    __device__ static void add(double& to, double amount) { atomicAdd(&to, amount); }
};

namespace detail {

inline constexpr int kWarpThreads = 256;  ///< a multiple of 32

/// f(warp, number of its lane 0). No thread returns early: lanes exchange values.
template <class F>
__global__ void __launch_bounds__(kWarpThreads, 1) run_warp_kernel(F f) {
    const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
    const int lane = static_cast<int>(threadIdx.x) % kWarpLanes;
    f(CudaWarp{lane}, i - static_cast<std::uint32_t>(lane));
}

}  // namespace detail

}  // namespace noli
