// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/device.hpp"

#include <type_traits>

namespace noli {

/// Non-owning span that may be captured by value in a kernel. Never allocates.
template <class T>
struct View {
    T* data = nullptr;
    int size = 0;

    NOLI_HD T& operator[](int i) const {
        NOLI_DCHECK(i >= 0 && i < size);
        return data[i];
    }

    [[nodiscard]] NOLI_HD T* begin() const { return data; }
    [[nodiscard]] NOLI_HD T* end() const { return data + size; }

    /// A view of mutable items converts to a view of const items.
    template <class U>
    requires(std::is_same_v<U, const T> && !std::is_const_v<T>) NOLI_HD operator View<U>()
        const {  // NOLINT: implicit on purpose
        return {data, size};
    }
};

}  // namespace noli
