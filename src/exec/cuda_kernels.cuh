// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The kernels that every loop of the CUDA executor becomes.

#include "core/view.hpp"
#include "exec/lanes.hpp"

#include <cuda_runtime_api.h>

namespace noli::detail {

inline constexpr int kLoopThreads = 256;
inline constexpr int kLaneThreads = 128;
inline constexpr int kReduceThreads = 256;
inline constexpr int kReduceChunk =
    1024;  ///< items per block: fixed, so sums do not depend on the device

template <class F>
__global__ void __launch_bounds__(kLoopThreads, 1) run_kernel(int n, F f) {
    const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
    if (i < n) f(i);
}

template <class F>
__global__ void __launch_bounds__(kLaneThreads, 1) run_lane_kernel(int n, F f) {
    const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
    if (i < n) f(Lane<double>{i});
}

struct Add {
    __device__ double operator()(double a, double b) const { return a + b; }
};
struct Smaller {
    __device__ double operator()(double a, double b) const {
        return (b < a || b != b) ? b : a;
    }
};

/// finish(block, combination of the block's items), in a fixed tree order.
template <class Combine, class F, class Finish>
__global__ void __launch_bounds__(kReduceThreads, 1)
    reduce_kernel(int n, double start, Combine combine, F f, Finish finish) {
    __shared__ double shared[kReduceThreads];
    const int begin = static_cast<int>(blockIdx.x) * kReduceChunk;
    const int end = min(n, begin + kReduceChunk);
    double acc = start;
    for (int i = begin + static_cast<int>(threadIdx.x); i < end; i += kReduceThreads)
        acc = combine(acc, f(i));
    shared[threadIdx.x] = acc;
    __syncthreads();
    for (int half = kReduceThreads / 2; half > 0; half /= 2) {
        if (static_cast<int>(threadIdx.x) < half)
            shared[threadIdx.x] =
                combine(shared[threadIdx.x], shared[threadIdx.x + half]);
        __syncthreads();
    }
    if (threadIdx.x == 0) finish(static_cast<int>(blockIdx.x), shared[0]);
}

struct ReadItem {
    const double* items;
    __device__ double operator()(int i) const { return items[i]; }
};
/// Keeps the block's result for the next level of a reduction.
struct StoreItem {
    double* items;
    __device__ void operator()(int block, double value) const { items[block] = value; }
};
/// Hands the result of the only block on.
template <class G>
struct CallWith {
    G g;
    __device__ void operator()(int /*block*/, double value) const { g(value); }
};

/// The two ends of a scan: offsets[0], and offsets[n] as a number.
struct CloseScan {
    int* offsets;
    int n;
    double* total;
    __device__ void operator()(int /*only*/) const {
        offsets[0] = 0;
        if (total != nullptr) *total = offsets[n];
    }
};

/// Blocks of a reduction of n items; at least one.
inline int reduce_blocks(int n) {
    return n <= kReduceChunk ? 1 : (n + kReduceChunk - 1) / kReduceChunk;
}

}  // namespace noli::detail
