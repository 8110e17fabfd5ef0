// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Growable array in memory that the host cannot touch.

#include "core/view.hpp"

#include <cstddef>
#include <utility>

namespace noli {

/// Uninitialised; contents are lost when it grows, and when that fails: then the buffer
/// is empty. Memory has
///
///     static int room_for(int n)                        capacity for n items, >= n
///     static void settle()                              ends all that may use memory
///     static void* take(std::size_t bytes)              throws DeviceFull
///     static void give_back(void* p, std::size_t bytes)
template <class T, class Memory>
class DeviceBuffer {
  public:
    DeviceBuffer() = default;
    ~DeviceBuffer() { release(); }
    DeviceBuffer(const DeviceBuffer&) = delete;
    DeviceBuffer& operator=(const DeviceBuffer&) = delete;
    DeviceBuffer(DeviceBuffer&& other) noexcept
        : data_(std::exchange(other.data_, nullptr)),
          size_(std::exchange(other.size_, 0)),
          capacity_(std::exchange(other.capacity_, 0)) {}
    DeviceBuffer& operator=(DeviceBuffer&& other) noexcept {
        std::swap(data_, other.data_);
        std::swap(size_, other.size_);
        std::swap(capacity_, other.capacity_);
        return *this;
    }

    void resize(int n) {
        if (n > capacity_) {
            if (data_ != nullptr) Memory::settle();
            release();
            const int capacity = Memory::room_for(n);
            data_ = static_cast<T*>(
                Memory::take(sizeof(T) * static_cast<std::size_t>(capacity)));
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
    void release() {
        if (data_ != nullptr) Memory::give_back(data_, bytes());
        data_ = nullptr;
        size_ = capacity_ = 0;
    }

    T* data_ = nullptr;
    int size_ = 0;
    int capacity_ = 0;
};

}  // namespace noli
