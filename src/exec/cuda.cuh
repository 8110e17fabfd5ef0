// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The CUDA executor: the same interface as exec/cpu.hpp on one GPU. All kernels of
/// the simulator are launched here (linear/warp_product.cuh launches its own, for
/// comparison). Reductions use a fixed partition, so results repeat bitwise on one
/// kind of device.

#include "core/view.hpp"
#include "exec/lanes.hpp"

#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>
#include <cuda_runtime_api.h>

#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace noli {

/// Throws std::runtime_error naming the kernel or call that failed.
inline void check_cuda(cudaError_t status, const char* what) {
    if (status == cudaSuccess) return;
    cudaGetLastError();  // forget it, or the next launch would report it again
    throw std::runtime_error(std::string(what) + ": " + cudaGetErrorString(status));
}

/// Growable device array; contents are lost when it grows.
template <class T>
class CudaBuffer {
  public:
    CudaBuffer() = default;
    ~CudaBuffer() { cudaFree(data_); }
    CudaBuffer(const CudaBuffer&) = delete;
    CudaBuffer& operator=(const CudaBuffer&) = delete;
    CudaBuffer(CudaBuffer&& other) noexcept
        : data_(std::exchange(other.data_, nullptr)),
          size_(std::exchange(other.size_, 0)),
          capacity_(std::exchange(other.capacity_, 0)) {}
    CudaBuffer& operator=(CudaBuffer&& other) noexcept {
        std::swap(data_, other.data_);
        std::swap(size_, other.size_);
        std::swap(capacity_, other.capacity_);
        return *this;
    }

    void resize(int n) {
        if (n > capacity_) {
            check_cuda(cudaFree(data_), "free device memory");
            data_ = nullptr;
            const int capacity = n + n / 4 + 64;
            check_cuda(cudaMalloc(reinterpret_cast<void**>(&data_),
                                  sizeof(T) * static_cast<std::size_t>(capacity)),
                       "allocate device memory");
            capacity_ = capacity;
        }
        size_ = n;
    }
    [[nodiscard]] int size() const { return size_; }
    [[nodiscard]] std::size_t bytes() const {
        return sizeof(T) * static_cast<std::size_t>(capacity_);
    }
    View<T> view() { return {data_, size_}; }
    [[nodiscard]] View<const T> view() const { return {data_, size_}; }

  private:
    T* data_ = nullptr;
    int size_ = 0;
    int capacity_ = 0;
};

namespace detail {

inline constexpr int kReduceThreads = 256;
inline constexpr int kReduceChunk =
    1024;  ///< items per block: fixed, so sums do not depend on the device

template <class F>
__global__ void run_kernel(int n, F f) {
    const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
    if (i < n) f(i);
}

template <class F>
__global__ void run_lane_kernel(int n, F f) {
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

/// partial[block] = combination of the block's items, in a fixed tree order.
template <class Combine, class F>
__global__ void reduce_kernel(
    int n, double start, Combine combine, F f, double* partial) {
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
    if (threadIdx.x == 0) partial[blockIdx.x] = shared[0];
}

struct ReadItem {
    const double* items;
    __device__ double operator()(int i) const { return items[i]; }
};

}  // namespace detail

/// Runs kernels on one CUDA stream.
class CudaExec {
  public:
    template <class T>
    using Buffer = CudaBuffer<T>;
    static constexpr bool kIsDevice = true;

    template <class F>
    void for_each(const char* name, int n, F f, int /*grain*/ = 0) {
        if (n == 0) return;
        constexpr int kBlock = 256;
        detail::run_kernel<<<(n + kBlock - 1) / kBlock, kBlock, 0, stream_>>>(n, f);
        check_cuda(cudaGetLastError(), name);
    }

    template <class F>
    void for_lanes(const char* name, int n, F f) {
        if (n == 0) return;
        constexpr int kBlock = 128;
        detail::run_lane_kernel<<<(n + kBlock - 1) / kBlock, kBlock, 0, stream_>>>(n, f);
        check_cuda(cudaGetLastError(), name);
    }

    template <class F>
    double sum(const char* name, int n, F f) {
        return reduce(name, n, 0.0, detail::Add{}, f);
    }

    template <class F>
    double min(const char* name, int n, F f) {
        return reduce(
            name, n, std::numeric_limits<double>::infinity(), detail::Smaller{}, f);
    }

    int scan(const char* name, View<const int> counts, View<int> offsets) {
        const int n = counts.size;
        int total = 0;
        if (n > 0) {
            std::size_t bytes = 0;
            check_cuda(cub::DeviceScan::InclusiveSum(
                           nullptr, bytes, counts.data, offsets.data + 1, n, stream_),
                       name);
            temp_.resize(static_cast<int>(bytes));
            check_cuda(
                cub::DeviceScan::InclusiveSum(
                    temp_.view().data, bytes, counts.data, offsets.data + 1, n, stream_),
                name);
            total = read(View<const int>{offsets.data, n + 1}, n);
        }
        check_cuda(cudaMemsetAsync(offsets.data, 0, sizeof(int), stream_), name);
        return total;
    }

    template <class Key>
    void sort_by_key(const char* name, View<Key> keys, View<int> values) {
        const int n = keys.size;
        if (n < 2) return;
        CudaBuffer<Key> sorted_keys;
        CudaBuffer<int> sorted_values;
        sorted_keys.resize(n);
        sorted_values.resize(n);
        std::size_t bytes = 0;
        const auto sort = [&](void* temp) {
            check_cuda(cub::DeviceRadixSort::SortPairs(temp,
                                                       bytes,
                                                       keys.data,
                                                       sorted_keys.view().data,
                                                       values.data,
                                                       sorted_values.view().data,
                                                       n,
                                                       0,
                                                       static_cast<int>(8 * sizeof(Key)),
                                                       stream_),
                       name);
        };
        sort(nullptr);
        temp_.resize(static_cast<int>(bytes));
        sort(temp_.view().data);
        copy(View<const Key>(sorted_keys.view()), keys);
        copy(View<const int>(sorted_values.view()), values);
        synchronize(name);
    }

    template <class T>
    void upload(const std::vector<T>& from, CudaBuffer<T>& to) {
        to.resize(static_cast<int>(from.size()));
        if (from.empty()) return;
        check_cuda(cudaMemcpyAsync(to.view().data,
                                   from.data(),
                                   sizeof(T) * from.size(),
                                   cudaMemcpyHostToDevice,
                                   stream_),
                   "upload");
        synchronize("upload");
    }
    template <class T>
    void download(View<const T> from, std::vector<T>& to) {
        to.resize(static_cast<std::size_t>(from.size));
        if (to.empty()) return;
        check_cuda(cudaMemcpyAsync(to.data(),
                                   from.data,
                                   sizeof(T) * to.size(),
                                   cudaMemcpyDeviceToHost,
                                   stream_),
                   "download");
        synchronize("download");
    }
    template <class T>
    void copy(View<const T> from, View<T> to) {
        if (from.size == 0) return;
        check_cuda(cudaMemcpyAsync(to.data,
                                   from.data,
                                   sizeof(T) * static_cast<std::size_t>(from.size),
                                   cudaMemcpyDeviceToDevice,
                                   stream_),
                   "copy");
    }
    template <class T>
    T read(View<const T> from, int i) {
        T host;
        check_cuda(cudaMemcpyAsync(
                       &host, from.data + i, sizeof(T), cudaMemcpyDeviceToHost, stream_),
                   "read");
        synchronize("read");
        return host;
    }

  private:
    template <class Combine, class F>
    double reduce(const char* name, int n, double start, Combine combine, F f) {
        if (n == 0) return start;
        int blocks = (n + detail::kReduceChunk - 1) / detail::kReduceChunk;
        partial_.resize(blocks);
        detail::reduce_kernel<<<blocks, detail::kReduceThreads, 0, stream_>>>(
            n, start, combine, f, partial_.view().data);
        check_cuda(cudaGetLastError(), name);
        while (blocks > 1) {
            const int count = blocks;
            blocks = (count + detail::kReduceChunk - 1) / detail::kReduceChunk;
            other_partial_.resize(blocks);
            detail::reduce_kernel<<<blocks, detail::kReduceThreads, 0, stream_>>>(
                count,
                start,
                combine,
                detail::ReadItem{partial_.view().data},
                other_partial_.view().data);
            check_cuda(cudaGetLastError(), name);
            std::swap(partial_, other_partial_);
        }
        return read(View<const double>{partial_.view().data, 1}, 0);
    }

    void synchronize(const char* name) {
        check_cuda(cudaStreamSynchronize(stream_), name);
    }

    cudaStream_t stream_ = nullptr;
    CudaBuffer<double> partial_, other_partial_;
    CudaBuffer<char> temp_;
};

}  // namespace noli
