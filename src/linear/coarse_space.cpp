// SPDX-License-Identifier: Apache-2.0
/// CoarseSpace during a solve: restriction, coarse solution, new directions.

#include "linear/coarse_space.hpp"

#include "core/index.hpp"
#include "linear/wide.hpp"

namespace noli {

namespace {

constexpr int kModes = CoarseSpace::kModes;
constexpr int kBlock = CoarseSpace::kBlock;

using detail::at;
using detail::load_wide;
using detail::three_lanes;
using detail::Wide;
using detail::wide;

/// Sums of blockᵀ v over blocks, one vector of lanes per mode.
struct ModeSums {
    Wide s[kModes] = {};

    template <class Number>
    inline __attribute__((always_inline)) void add(const Number* block, const Wide& v) {
        for (int m = 0; m < kModes; ++m)
            s[m] += load_wide(block + 3 * m) * v;
    }
    inline __attribute__((always_inline)) void store(double* out) const {
        for (int m = 0; m < kModes; ++m)
            out[m] = detail::add_lanes(s[m]);
    }
};

/// block c; lane 3 is what follows the block.
template <class Number>
inline __attribute__((always_inline)) Wide moved(const Number* block, const double* c) {
    Wide sum{};
    for (int m = 0; m < kModes; ++m)
        sum += load_wide(block + 3 * m) * c[m];
    return sum;
}

/// Adds what the couplings of an aggregate make of the values at their rows.
template <class Value>
inline __attribute__((always_inline)) void add_couplings(const RowCouplings& couplings,
                                                         const float* blocks,
                                                         int aggregate,
                                                         const Value& value,
                                                         ModeSums& sums) {
    const int end = couplings.of_begin[at(aggregate) + 1];
    for (int k = couplings.of_begin[at(aggregate)]; k < end; ++k)
        sums.add(blocks + at(kBlock) * at(k), value(4 * at(couplings.of_row[at(k)])));
}

/// Adds what the motions of an aggregate make of the values at its rows.
template <class Value>
inline __attribute__((always_inline)) void add_own_rows(const CoarsePattern& pattern,
                                                        const float* modes,
                                                        int aggregate,
                                                        const Value& value,
                                                        ModeSums& sums) {
    const int end = pattern.rows_begin[at(aggregate) + 1];
    for (int k = pattern.rows_begin[at(aggregate)]; k < end; ++k) {
        const std::size_t row = at(pattern.rows[at(k)]);
        sums.add(modes + at(kBlock) * row, value(4 * row));
    }
}

}  // namespace

void CoarseSpace::restrict_split(int aggregate, const double* r, const double* y) {
    detail::with_avx2([&] {
        ModeSums sums;
        add_couplings(
            pattern_.upper,
            pull_of_.data(),
            aggregate,
            [=](std::size_t row) { return wide(r + row) - wide(y + row); },
            sums);
        sums.store(&g_[at(kModes * aggregate)]);
    });
}

void CoarseSpace::restrict_start(int aggregate, const double* b) {
    detail::with_avx2([&] {
        ModeSums sums;
        add_own_rows(
            pattern_,
            modes_.data(),
            aggregate,
            [=](std::size_t row) { return wide(b + row); },
            sums);
        sums.store(&g_[at(kModes * aggregate)]);
    });
}

void CoarseSpace::restrict_residual(int aggregate, const double* r, const double* y) {
    detail::with_avx2([&] {
        ModeSums sums;
        add_own_rows(
            pattern_,
            modes_.data(),
            aggregate,
            [=](std::size_t row) { return wide(r + row) - wide(y + row); },
            sums);
        const auto moved_back = [=](std::size_t row) { return -wide(y + row); };
        add_couplings(pattern_.upper, pull_of_.data(), aggregate, moved_back, sums);
        add_couplings(pattern_.lower, push_of_.data(), aggregate, moved_back, sums);
        sums.store(&g_[at(kModes * aggregate)]);
    });
}

double CoarseSpace::solve_coarse() {
    c_ = g_;
    cholesky_.solve(c_);
    double product = 0.0;
    for (std::size_t i = 0; i < c_.size(); ++i)
        product += c_[i] * g_[i];
    return product;
}

void CoarseSpace::renew(
    const double* y, double beta, int begin, int end, double* t) const {
    const float* modes = modes_.data();
    const int* aggregate = pattern_.aggregate.data();
    const double* c = c_.data();
    detail::with_avx2([=] {
        for (int i = begin; i < end; ++i) {
            const std::size_t row = 4 * at(i);
            Wide out = wide(y + row) + beta * wide(t + row);
            if (const int own = aggregate[i]; own >= 0)
                out +=
                    three_lanes(moved(modes + at(kBlock) * at(i), c + at(kModes * own)));
            wide(t + row) = out;
        }
    });
}

void CoarseSpace::renew_split(const double* r,
                              const double* y,
                              double beta,
                              int begin,
                              int end,
                              double* t,
                              double* s) const {
    renew(y, beta, begin, end, t);
    const int* first = pattern_.upper.begin.data();
    const int* aggregate = pattern_.upper.aggregate.data();
    const double* pull = pull_.data();
    const double* c = c_.data();
    detail::with_avx2([=] {
        for (int i = begin; i < end; ++i) {
            const std::size_t row = 4 * at(i);
            Wide pulled{};
            for (int e = first[i]; e < first[i + 1]; ++e)
                pulled += moved(pull + at(kBlock) * at(e), c + at(kModes * aggregate[e]));
            wide(s + row) = wide(r + row) - wide(y + row) + three_lanes(pulled)
                          + beta * wide(s + row);
        }
    });
}

}  // namespace noli
