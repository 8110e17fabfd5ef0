// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The product of linear/warp_product.hpp on a GPU: one thread per scalar entry.

#include "exec/cuda.cuh"
#include "linear/warp_product.hpp"

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

/// y += H c for the four buffers of a WarpProduct, one launch each.
inline void launch_warp_product(const WarpProduct<CudaExec>& product,
                                View<const Vec3d> c,
                                View<Vec3d> y) {
    constexpr int kThreads = 256;
    const auto launch = [&](const auto& blocks) {
        launch_warp_product(
            blocks, {0, blocks.num_entries()}, kThreads, components(c), components(y));
    };
    launch(product.point_point.view());
    launch(product.point_edge.view());
    launch(product.point_triangle.view());
    launch(product.edge_edge.view());
}

}  // namespace noli
