// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The product of linear/warp_product.hpp on a GPU, for any range of entries and any size
/// of thread blocks: for its tests. The engine launches it through CudaExec::for_warps.

#include "exec/cuda.cuh"
#include "linear/warp_product.hpp"

namespace noli {

namespace detail {

template <int kSize, int kDim>
__global__ void warp_product_kernel(DenseBlockView<kSize, kDim> blocks,
                                    EntryRange range,
                                    View<const double> c,
                                    View<double> y) {
    const int lane = static_cast<int>(threadIdx.x) % kWarpLanes;
    const std::uint32_t index = range.begin + blockIdx.x * blockDim.x + threadIdx.x;
    warp_multiply_add(CudaWarp{lane},
                      index - static_cast<std::uint32_t>(lane),
                      range.end,
                      blocks,
                      c,
                      y);
}

}  // namespace detail

/// y += H c over the entries of `range`, in device memory. threads_per_block must be a
/// multiple of 32. Returns at once; throws if the launch fails.
template <int kSize, int kDim>
void launch_warp_product(const DenseBlockView<kSize, kDim>& blocks,
                         EntryRange range,
                         int threads_per_block,
                         View<const double> c,
                         View<double> y) {
    NOLI_DCHECK(threads_per_block > 0 && threads_per_block % kWarpLanes == 0);
    if (range.begin == range.end) return;
    const auto threads = static_cast<unsigned>(threads_per_block);
    const unsigned grid = (range.end - range.begin + threads - 1) / threads;
    detail::warp_product_kernel<<<grid, threads>>>(blocks, range, c, y);
    check_cuda(cudaGetLastError(), "linear/warp_product");
}

}  // namespace noli
