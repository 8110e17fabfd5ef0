// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>

namespace noli::detail {

/// A number of ours, never negative, as an index of a container of the standard library.
constexpr std::size_t at(int i) {
    return static_cast<std::size_t>(i);
}

}  // namespace noli::detail
