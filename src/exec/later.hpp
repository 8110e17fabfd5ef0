// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Numbers that loops leave where they ran.
///
/// A device does not stop at a sum whose value nobody has asked for yet: the value lies
/// in a ring in its memory, later loops may read it there, and the first question brings
/// all that have been left since the last one to the host, in one transfer that the host
/// waits for once. So: start all loops that can be started, then ask.

#include "core/view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace noli {

/// Names such a number. Good for the next kNumLater / 2 numbers of its executor.
struct Later {
    std::int64_t serial = -1;  ///< negative: the value is `known`
    double known = 0.0;
};

inline constexpr int kNumLater = 256;

/// A sum adds a few numbers per item.
inline constexpr int kSumGrain = 1024;

namespace detail {

struct StoreNumber {
    double* to;
    NOLI_HD void operator()(double value) const { *to = value; }
};
struct StoreNegated {
    double* to;
    NOLI_HD void operator()(double value) const { *to = -value; }
};
template <class F>
struct Negated {
    F f;
    NOLI_HD double operator()(int i) const { return -f(i); }
};
/// The one item of a loop that leaves several numbers.
template <class F>
struct StoreNumbers {
    F f;
    double* to;
    NOLI_HD void operator()(int /*only*/) const { f(to); }
};

}  // namespace detail

/// What every executor has on top of its own sum_then, min_then and scan_then.
template <class Exec, class NumberBuffer>
class LaterNumbers {
  public:
    /// f(0) + ... + f(n-1), added in an order that only n determines.
    /// `grain` is the least number of items worth a task.
    template <class F>
    Later sum_later(const char* name, int n, F f, int grain = kSumGrain) {
        if (n == 0) return {};
        const Later out = next(1);
        self().sum_then(name, n, f, detail::StoreNumber{place(out)}, grain);
        return out;
    }
    /// Smallest f(i); +infinity when n is 0. A NaN anywhere gives NaN.
    template <class F>
    Later min_later(const char* name, int n, F f) {
        if (n == 0) return {-1, HUGE_VAL};
        const Later out = next(1);
        self().min_then(name, n, f, detail::StoreNumber{place(out)});
        return out;
    }
    /// Largest f(i); -infinity when n is 0. A NaN anywhere gives NaN.
    template <class F>
    Later max_later(const char* name, int n, F f) {
        if (n == 0) return {-1, -HUGE_VAL};
        const Later out = next(1);
        self().min_then(name, n, detail::Negated<F>{f}, detail::StoreNegated{place(out)});
        return out;
    }
    /// offsets[i] = counts[0] + ... + counts[i-1]; offsets has one item more than counts
    /// and may not alias it. The number is the total.
    Later scan_later(const char* name, View<const int> counts, View<int> offsets) {
        const Later out = counts.size == 0 ? Later{} : next(1);
        self().scan_then(name, counts, offsets, counts.size == 0 ? nullptr : place(out));
        return out;
    }
    /// N numbers at once: f(to) sets to[0] ... to[N - 1].
    template <int N, class F>
    std::array<Later, N> numbers_later(const char* name, F f) {
        std::array<Later, N> out;
        out[0] = next(N);
        for (int k = 1; k < N; ++k)
            out[static_cast<std::size_t>(k)] = {out[0].serial + k, 0.0};
        self().for_each(name, 1, detail::StoreNumbers<F>{f, place(out[0])});
        return out;
    }

    /// Where a number will lie, for loops that are started after the one that leaves it.
    /// Not for a number that is known from the start.
    double* place(const Later& number) {
        NOLI_DCHECK(number.serial >= 0);
        if (numbers_.size() == 0) numbers_.resize(kNumLater);
        return numbers_.view().data + number.serial % kNumLater;
    }

    /// On a device the host waits, unless a question since then has brought the number.
    double value(const Later& number) {
        if (number.serial < 0) return number.known;
        NOLI_DCHECK(number.serial >= next_ - kNumLater);
        if constexpr (!Exec::kIsDevice) {
            return *place(number);
        } else {
            if (number.serial >= fetched_) fetch();
            return here_[static_cast<std::size_t>(number.serial % kNumLater)];
        }
    }

    template <class F>
    double sum(const char* name, int n, F f) {
        return value(sum_later(name, n, f));
    }
    template <class F>
    double min(const char* name, int n, F f) {
        return value(min_later(name, n, f));
    }
    template <class F>
    double max(const char* name, int n, F f) {
        return value(max_later(name, n, f));
    }
    int scan(const char* name, View<const int> counts, View<int> offsets) {
        return static_cast<int>(value(scan_later(name, counts, offsets)));
    }

  private:
    Exec& self() { return static_cast<Exec&>(*this); }

    /// The first of n numbers that lie side by side.
    Later next(int n) {
        const auto at = static_cast<int>(next_ % kNumLater);
        if (at + n > kNumLater) next_ += kNumLater - at;
        next_ += n;
        return {next_ - n, 0.0};
    }

    void fetch() {
        const std::int64_t first = std::max(fetched_, next_ - kNumLater);
        const auto begin = static_cast<int>(first % kNumLater);
        const auto count = static_cast<int>(next_ - first);
        const bool wraps = begin + count > kNumLater;
        const View<const double> ring = numbers_.view();
        const int from = wraps ? 0 : begin;
        self().download(View<const double>{ring.data + from, wraps ? kNumLater : count},
                        arriving_);
        std::copy(arriving_.begin(), arriving_.end(), here_.begin() + from);
        // Begins anew at the front in time, so that what comes next lies in one piece.
        if (next_ % kNumLater > kNumLater / 2) next_ += kNumLater - next_ % kNumLater;
        fetched_ = next_;
    }

    NumberBuffer numbers_;  ///< a ring: number s lies at s % kNumLater
    std::array<double, kNumLater> here_{};
    std::vector<double> arriving_;
    std::int64_t next_ = 0;     ///< serial of the next number
    std::int64_t fetched_ = 0;  ///< numbers before this one are in here_
};

}  // namespace noli
