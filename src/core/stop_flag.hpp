// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>

namespace noli {

/// A request to stop, set by another thread or a signal handler; null: none ever comes.
/// Host only. Whoever sees it set ends as soon as it can leave things whole.
using StopFlag = const std::atomic<bool>*;

inline bool is_set(StopFlag flag) {
    return flag != nullptr && flag->load(std::memory_order_relaxed);
}

}  // namespace noli
