// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Growable host array whose items are left uninitialised: what a CPU executor calls a
/// buffer; and an array on its way to the host, which there has arrived at once.

#include "core/view.hpp"

#include <cstddef>
#include <memory>
#include <vector>

namespace noli {

template <class T>
class HostBuffer {
  public:
    /// Sets the size; keeps nothing when it has to grow. Capacity never shrinks.
    void resize(int n) {
        if (n > capacity_) {
            capacity_ = n + n / 4 + 16;
            data_ =
                std::make_unique_for_overwrite<T[]>(static_cast<std::size_t>(capacity_));
        }
        size_ = n;
    }
    [[nodiscard]] int size() const { return size_; }
    [[nodiscard]] std::size_t bytes() const {
        return sizeof(T) * static_cast<std::size_t>(capacity_);
    }
    View<T> view() { return {data_.get(), size_}; }
    [[nodiscard]] View<const T> view() const { return {data_.get(), size_}; }

  private:
    std::unique_ptr<T[]> data_;
    int size_ = 0;
    int capacity_ = 0;
};

template <class T>
class HostArrival {
  public:
    void start(View<const T> from) { items_.assign(from.begin(), from.end()); }
    void take(std::vector<T>& to) { to.swap(items_); }

  private:
    std::vector<T> items_;
};

}  // namespace noli
