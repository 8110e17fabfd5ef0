// SPDX-License-Identifier: Apache-2.0
#include "exec/arena.hpp"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

namespace noli {

struct Arena::Impl {
    int threads;
    // TBB never runs more threads than this limit; it must allow what the arena asks for.
    tbb::global_control limit;
    tbb::task_arena arena;

    explicit Impl(int count)
        : threads(count),
          limit(tbb::global_control::max_allowed_parallelism,
                static_cast<std::size_t>(count)),
          arena(count) {}
};

Arena::Arena(int threads)
    : impl_(std::make_unique<Impl>(threads > 0 ? threads
                                               : tbb::info::default_concurrency())) {}
Arena::~Arena() = default;
Arena::Arena(Arena&&) noexcept = default;
Arena& Arena::operator=(Arena&&) noexcept = default;

void Arena::run(const std::function<void()>& f) {
    impl_->arena.execute(f);
}
int Arena::threads() const {
    return impl_->threads;
}

}  // namespace noli
