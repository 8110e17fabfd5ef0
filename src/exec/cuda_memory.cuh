// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Memory of a CUDA device: growable arrays, and copies that arrive on the host while the
/// device goes on.

#include "core/view.hpp"
#include "exec/device_buffer.hpp"
#include "exec/device_full.hpp"

#include <cuda_runtime_api.h>

#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

namespace noli {

/// Throws std::runtime_error naming the kernel or call that failed.
inline void check_cuda(cudaError_t status, const char* what) {
    if (status == cudaSuccess) return;
    cudaGetLastError();  // forget it, or the next launch would report it again
    throw std::runtime_error(std::string(what) + ": " + cudaGetErrorString(status));
}

/// Memory of the device, see DeviceBuffer.
struct CudaMemory {
    static int room_for(int n) { return n + n / 4 + 64; }
    static void settle() { check_cuda(cudaDeviceSynchronize(), "wait before growing"); }
    static void* take(std::size_t bytes) {
        void* out = nullptr;
        const cudaError_t status = cudaMalloc(&out, bytes);
        if (status == cudaErrorMemoryAllocation) {
            cudaGetLastError();
            std::size_t free = 0;
            std::size_t total = 0;
            check_cuda(cudaMemGetInfo(&free, &total), "ask for free device memory");
            throw DeviceFull(bytes, free, total);
        }
        check_cuda(status, "allocate device memory");
        return out;
    }
    static void give_back(void* p, std::size_t /*bytes*/) { cudaFree(p); }
};

template <class T>
using CudaBuffer = DeviceBuffer<T, CudaMemory>;

/// Page-locked host memory: the device copies into it by itself.
class CudaPinned {
  public:
    CudaPinned() = default;
    ~CudaPinned() { cudaFreeHost(data_); }
    CudaPinned(const CudaPinned&) = delete;
    CudaPinned& operator=(const CudaPinned&) = delete;

    void* resize(std::size_t bytes) {
        if (bytes > capacity_) {
            check_cuda(cudaFreeHost(data_), "free pinned memory");
            data_ = nullptr;
            capacity_ = 0;
            check_cuda(cudaMallocHost(&data_, bytes), "allocate pinned memory");
            capacity_ = bytes;
        }
        return data_;
    }
    [[nodiscard]] const void* data() const { return data_; }

  private:
    void* data_ = nullptr;
    std::size_t capacity_ = 0;
};

/// An array on its way to the host.
template <class T>
class CudaArrival {
  public:
    CudaArrival() = default;
    ~CudaArrival() {
        if (arrived_ != nullptr) cudaEventDestroy(arrived_);
    }
    CudaArrival(const CudaArrival&) = delete;
    CudaArrival& operator=(const CudaArrival&) = delete;

    /// Queues the copy behind what the stream has to do.
    void start(View<const T> from, cudaStream_t stream) {
        if (arrived_ == nullptr)
            check_cuda(cudaEventCreateWithFlags(&arrived_, cudaEventDisableTiming),
                       "create event");
        size_ = static_cast<std::size_t>(from.size);
        void* to = pinned_.resize(sizeof(T) * size_);
        if (size_ > 0)
            check_cuda(
                cudaMemcpyAsync(
                    to, from.data, sizeof(T) * size_, cudaMemcpyDeviceToHost, stream),
                "start download");
        check_cuda(cudaEventRecord(arrived_, stream), "record event");
    }

    /// Waits for the copy alone, not for what was queued behind it.
    void take(std::vector<T>& to) {
        check_cuda(cudaEventSynchronize(arrived_), "wait for download");
        to.resize(size_);
        if (size_ > 0) std::memcpy(to.data(), pinned_.data(), sizeof(T) * size_);
    }

  private:
    CudaPinned pinned_;
    cudaEvent_t arrived_ = nullptr;
    std::size_t size_ = 0;
};

}  // namespace noli
