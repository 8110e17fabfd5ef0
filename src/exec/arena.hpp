// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How many threads CPU kernels may use.

#include <functional>
#include <memory>

namespace noli {

class Arena {
  public:
    /// 0 = all cores.
    explicit Arena(int threads);
    ~Arena();
    Arena(Arena&&) noexcept;
    Arena& operator=(Arena&&) noexcept;

    /// Runs f on this thread with at most `threads()` threads for the kernels in it.
    void run(const std::function<void()>& f);
    [[nodiscard]] int threads() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace noli
