// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Memory of a CUDA device: growable arrays, and copies that arrive on the host while the
/// device goes on.

#include "core/view.hpp"
#include "exec/device_full.hpp"

#include <cuda_runtime_api.h>

#include <cstddef>
#include <cstring>
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

/// Memory of the device, uninitialised. Throws DeviceFull with the numbers.
inline void* allocate_on_device(std::size_t bytes) {
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

    /// After a failure the buffer is empty.
    void resize(int n) {
        if (n > capacity_) {
            // Kernels that use the old memory may still run.
            if (data_ != nullptr)
                check_cuda(cudaDeviceSynchronize(), "wait before growing");
            check_cuda(cudaFree(data_), "free device memory");
            data_ = nullptr;
            size_ = capacity_ = 0;
            const int capacity = n + n / 4 + 64;
            data_ = static_cast<T*>(
                allocate_on_device(sizeof(T) * static_cast<std::size_t>(capacity)));
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
