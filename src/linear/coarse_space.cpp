// SPDX-License-Identifier: Apache-2.0
#include "linear/coarse_space.hpp"

#include "exec/lanes.hpp"
#include "linear/sweeps.hpp"
#include "linear/wide.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace noli {

namespace {

constexpr int kModes = CoarseSpace::kModes;
constexpr int kModesPerRow = 3 * kModes;

using detail::load_wide;
using detail::wide;
using Double4 = detail::Wide;

std::size_t at(int i) {
    return static_cast<std::size_t>(i);
}

/// sums[m] = sum over the listed entries of column m of w times r at the entry's row,
/// lane by lane.
inline __attribute__((always_inline)) void restrict_entries(
    const CoarseSpace::Entry* entries,
    const int* rows,
    const int* begin,
    const int* end,
    const double* r,
    Double4* sums) {
    Double4 s[kModes] = {};
    for (const int* e = begin; e != end; ++e) {
        const Double4 at_row = wide(r + 4 * static_cast<std::ptrdiff_t>(rows[*e]));
        for (int m = 0; m < kModes; ++m)
            s[m] += load_wide(entries[*e].w + 4 * m) * at_row;
    }
    for (int m = 0; m < kModes; ++m)
        sums[m] = s[m];
}

/// p = r + W c + beta p
inline __attribute__((always_inline)) void renew_rows(const CoarseSpace::Entry* entries,
                                                      const int* entry_begin,
                                                      const double* c,
                                                      const double* r,
                                                      double beta,
                                                      int begin,
                                                      int end,
                                                      double* p) {
    for (int i = begin; i < end; ++i) {
        Double4 sum{};
        for (int e = entry_begin[i]; e < entry_begin[i + 1]; ++e) {
            const double* amount = c + kModes * entries[e].aggregate;
            for (int m = 0; m < kModes; ++m)
                sum += load_wide(entries[e].w + 4 * m) * amount[m];
        }
        const std::ptrdiff_t row = 4 * static_cast<std::ptrdiff_t>(i);
        wide(p + row) = wide(r + row) + sum + beta * wide(p + row);
    }
}

#if defined(__x86_64__)
__attribute__((target("avx2"), flatten)) void restrict_entries_avx2(
    const CoarseSpace::Entry* entries,
    const int* rows,
    const int* begin,
    const int* end,
    const double* r,
    Double4* sums) {
    restrict_entries(entries, rows, begin, end, r, sums);
}
__attribute__((target("avx2"), flatten)) void renew_rows_avx2(
    const CoarseSpace::Entry* entries,
    const int* entry_begin,
    const double* c,
    const double* r,
    double beta,
    int begin,
    int end,
    double* p) {
    renew_rows(entries, entry_begin, c, r, beta, begin, end, p);
}
#endif

/// Cᵀ v, from the inverse of C.
Vec3d apply_transposed_factor(const InverseFactor& f, const Vec3d& v) {
    const double c00 = f.c0[0] > 0.0 ? 1.0 / f.c0[0] : 0.0;
    const double c11 = f.c1[1] > 0.0 ? 1.0 / f.c1[1] : 0.0;
    const double c22 = f.c2[2] > 0.0 ? 1.0 / f.c2[2] : 0.0;
    const double c10 = -c11 * f.c0[1] * c00;
    const double c21 = -c22 * f.c1[2] * c11;
    const double c20 = -(c21 * f.c0[1] + c22 * f.c0[2]) * c00;
    return {c00 * v.x + c10 * v.y + c20 * v.z, c11 * v.y + c21 * v.z, c22 * v.z};
}

/// out += aᵀ b for a (3,6) and b (3,6)
void add_gram(const double* a, const double* b, Block6& out) {
    for (int r = 0; r < 3; ++r)
        for (int i = 0; i < kModes; ++i)
            for (int j = 0; j < kModes; ++j)
                out.a[kModes * i + j] += a[kModes * r + i] * b[kModes * r + j];
}

}  // namespace

void CoarseSpace::set_aggregates(RigidAggregates aggregates) {
    aggregates_ = std::move(aggregates);
}

void CoarseSpace::find_rows(const ColouredOperator& op) {
    const int n = op.num_rows();
    aggregate_.resize(at(n));
    rows_begin_.assign(at(num_aggregates()) + 1, 0);
    for (int i = 0; i < n; ++i) {
        aggregate_[at(i)] = aggregates_.of_vertex[at(op.numbering().vertex[at(i)])];
        if (aggregate_[at(i)] >= 0) ++rows_begin_[at(aggregate_[at(i)]) + 1];
    }
    std::partial_sum(rows_begin_.begin(), rows_begin_.end(), rows_begin_.begin());
    rows_.resize(at(rows_begin_.back()));
    std::vector<int> next(rows_begin_.begin(), rows_begin_.end() - 1);
    for (int i = 0; i < n; ++i)
        if (aggregate_[at(i)] >= 0) rows_[at(next[at(aggregate_[at(i)])]++)] = i;
    modes_.assign(at(kModesPerRow * n), 0.0);
}

void CoarseSpace::find_entries(const ColouredOperator& op) {
    entry_begin_.assign(1, 0);
    entries_.clear();
    entry_row_.clear();
    std::vector<int> found;
    for (int i = 0; i < op.num_rows(); ++i) {
        found.clear();
        for (int p = op.upper_begin[at(i)]; p < op.upper_begin[at(i) + 1]; ++p)
            found.push_back(aggregate_[at(op.upper_col[at(p)])]);
        std::sort(found.begin(), found.end());
        found.erase(std::unique(found.begin(), found.end()), found.end());
        const int own = aggregate_[at(i)];
        if (own >= 0) entries_.push_back({own, -1, {}});
        for (const int a : found)
            if (a >= 0 && a != own) entries_.push_back({a, -1, {}});
        entry_row_.resize(entries_.size(), i);
        entry_begin_.push_back(static_cast<int>(entries_.size()));
    }
    by_aggregate_begin_.assign(at(num_aggregates()) + 1, 0);
    for (const Entry& e : entries_)
        ++by_aggregate_begin_[at(e.aggregate) + 1];
    std::partial_sum(by_aggregate_begin_.begin(),
                     by_aggregate_begin_.end(),
                     by_aggregate_begin_.begin());
    by_aggregate_.resize(entries_.size());
    std::vector<int> next(by_aggregate_begin_.begin(), by_aggregate_begin_.end() - 1);
    for (std::size_t e = 0; e < entries_.size(); ++e)
        by_aggregate_[at(next[at(entries_[e].aggregate)]++)] = static_cast<int>(e);
}

void CoarseSpace::find_coarse_pattern() {
    const int n = num_aggregates();
    coarse_begin_.assign(1, 0);
    coarse_col_.clear();
    std::vector<std::vector<int>> lower(at(n));
    std::vector<int> found;
    for (int a = 0; a < n; ++a) {
        found.assign(1, a);
        for (int r = rows_begin_[at(a)]; r < rows_begin_[at(a) + 1]; ++r)
            for (int e = entry_begin_[at(rows_[at(r)])];
                 e < entry_begin_[at(rows_[at(r)]) + 1];
                 ++e)
                found.push_back(entries_[at(e)].aggregate);
        std::sort(found.begin(), found.end());
        found.erase(std::unique(found.begin(), found.end()), found.end());
        for (int r = rows_begin_[at(a)]; r < rows_begin_[at(a) + 1]; ++r)
            for (int e = entry_begin_[at(rows_[at(r)])];
                 e < entry_begin_[at(rows_[at(r)]) + 1];
                 ++e)
                entries_[at(e)].coarse =
                    coarse_begin_.back()
                    + static_cast<int>(std::lower_bound(found.begin(),
                                                        found.end(),
                                                        entries_[at(e)].aggregate)
                                       - found.begin());
        for (const int b : found)
            lower[at(std::max(a, b))].push_back(std::min(a, b));
        coarse_col_.insert(coarse_col_.end(), found.begin(), found.end());
        coarse_begin_.push_back(static_cast<int>(coarse_col_.size()));
    }
    coarse_rows_.resize(coarse_col_.size());
    gram_.resize(at(n));

    const auto place_of = [this](int a, int b) {
        const auto begin = coarse_col_.begin() + coarse_begin_[at(a)];
        const auto end = coarse_col_.begin() + coarse_begin_[at(a) + 1];
        const auto found_at = std::lower_bound(begin, end, b);
        return found_at != end && *found_at == b
                 ? static_cast<int>(found_at - coarse_col_.begin())
                 : -1;
    };
    matrix_.row_begin.assign(1, 0);
    matrix_.col.clear();
    from_.clear();
    for (int a = 0; a < n; ++a) {
        std::sort(lower[at(a)].begin(), lower[at(a)].end());
        lower[at(a)].erase(std::unique(lower[at(a)].begin(), lower[at(a)].end()),
                           lower[at(a)].end());
        for (const int b : lower[at(a)]) {
            matrix_.col.push_back(b);
            from_.push_back(place_of(a, b));
            from_.push_back(place_of(b, a));
        }
        matrix_.row_begin.push_back(static_cast<int>(matrix_.col.size()));
    }
    matrix_.value.resize(matrix_.col.size());
}

void CoarseSpace::update_pattern(const ColouredOperator& op) {
    find_rows(op);
    find_entries(op);
    find_coarse_pattern();
    cholesky_.analyze(matrix_);
    g_.assign(at(kModes * num_aggregates()), 0.0);
    c_ = g_;
}

void CoarseSpace::fill_modes(const ColouredOperator& op,
                             const InverseFactor* scale,
                             View<const Vec3d> x,
                             int aggregate) {
    const int begin = rows_begin_[at(aggregate)];
    const int end = rows_begin_[at(aggregate) + 1];
    if (begin == end) return;
    const auto position = [&](int k) {
        return x[op.numbering().vertex[at(rows_[at(k)])]];
    };
    Vec3d centre{0, 0, 0};
    for (int k = begin; k < end; ++k)
        centre += position(k);
    centre = (1.0 / (end - begin)) * centre;
    double radius_sq = 0.0;
    for (int k = begin; k < end; ++k)
        radius_sq += dot(position(k) - centre, position(k) - centre);
    const double per_radius =
        radius_sq > 0.0 ? std::sqrt((end - begin) / radius_sq) : 0.0;
    for (int k = begin; k < end; ++k) {
        const int row = rows_[at(k)];
        const Vec3d d = per_radius * (position(k) - centre);
        const Vec3d motion[kModes] = {{1, 0, 0},
                                      {0, 1, 0},
                                      {0, 0, 1},
                                      {0, -d.z, d.y},
                                      {d.z, 0, -d.x},
                                      {-d.y, d.x, 0}};
        for (int m = 0; m < kModes; ++m) {
            const Vec3d z = apply_transposed_factor(scale[at(row)], motion[m]);
            for (int c = 0; c < 3; ++c)
                modes_[at(kModesPerRow * row + kModes * c + m)] = z[c];
        }
    }
}

template <class Number>
void CoarseSpace::fill_row(const ColouredOperator& op, const Number* upper, int row) {
    thread_local std::vector<double> sums;
    const int begin = entry_begin_[at(row)];
    const int count = entry_begin_[at(row) + 1] - begin;
    sums.assign(at(kModesPerRow * count), 0.0);
    const int own = aggregate_[at(row)];
    if (own >= 0)
        std::copy_n(&modes_[at(kModesPerRow * row)], kModesPerRow, sums.begin());
    for (int p = op.upper_begin[at(row)]; p < op.upper_begin[at(row) + 1]; ++p) {
        const int other = op.upper_col[at(p)];
        const int aggregate = aggregate_[at(other)];
        if (aggregate < 0) continue;
        int k = 0;
        while (entries_[at(begin + k)].aggregate != aggregate)
            ++k;
        double* to = sums.data() + kModesPerRow * k;
        const Number* block = upper + 9 * at(p);
        const double* z = &modes_[at(kModesPerRow * other)];
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) {
                const double b = static_cast<double>(block[3 * c + r]);
                for (int m = 0; m < kModes; ++m)
                    to[kModes * r + m] += b * z[kModes * c + m];
            }
    }
    for (int k = 0; k < count; ++k)
        for (int m = 0; m < kModes; ++m)
            for (int c = 0; c < 3; ++c)
                entries_[at(begin + k)].w[4 * m + c] =
                    static_cast<float>(sums[at(kModesPerRow * k + kModes * c + m)]);
}

template void CoarseSpace::fill_row(const ColouredOperator&, const float*, int);
template void CoarseSpace::fill_row(const ColouredOperator&, const double*, int);

void CoarseSpace::fill_coarse_row(int aggregate) {
    for (int p = coarse_begin_[at(aggregate)]; p < coarse_begin_[at(aggregate) + 1]; ++p)
        coarse_rows_[at(p)] = {};
    gram_[at(aggregate)] = {};
    for (int k = rows_begin_[at(aggregate)]; k < rows_begin_[at(aggregate) + 1]; ++k) {
        const int row = rows_[at(k)];
        const double* z = &modes_[at(kModesPerRow * row)];
        add_gram(z, z, gram_[at(aggregate)]);
        for (int e = entry_begin_[at(row)]; e < entry_begin_[at(row) + 1]; ++e) {
            double w[kModesPerRow];
            for (int c = 0; c < 3; ++c)
                for (int m = 0; m < kModes; ++m)
                    w[kModes * c + m] = static_cast<double>(entries_[at(e)].w[4 * m + c]);
            add_gram(z, w, coarse_rows_[at(entries_[at(e)].coarse)]);
        }
    }
}

bool CoarseSpace::factorize() {
    for (int a = 0; a < num_aggregates(); ++a)
        for (int p = matrix_.row_begin[at(a)]; p < matrix_.row_begin[at(a) + 1]; ++p) {
            Block6& to = matrix_.value[at(p)];
            const int direct = from_[at(2 * p)];
            const int mirrored = from_[at(2 * p + 1)];
            for (int i = 0; i < kModes; ++i)
                for (int j = 0; j < kModes; ++j) {
                    double sum = 0.0;
                    if (direct >= 0) sum += coarse_rows_[at(direct)].a[kModes * i + j];
                    if (mirrored >= 0)
                        sum += coarse_rows_[at(mirrored)].a[kModes * j + i];
                    if (matrix_.col[at(p)] == a) sum -= gram_[at(a)].a[kModes * i + j];
                    to.a[kModes * i + j] = sum;
                }
        }
    return cholesky_.factorize(matrix_);
}

void CoarseSpace::restrict_to(int aggregate, const double* r) {
    const int* begin = by_aggregate_.data() + by_aggregate_begin_[at(aggregate)];
    const int* end = by_aggregate_.data() + by_aggregate_begin_[at(aggregate) + 1];
    Double4 sums[kModes];
#if defined(__x86_64__)
    if (lane_dispatch() != LaneDispatch::Width2)
        restrict_entries_avx2(entries_.data(), entry_row_.data(), begin, end, r, sums);
    else
#endif
        restrict_entries(entries_.data(), entry_row_.data(), begin, end, r, sums);
    for (int m = 0; m < kModes; ++m)
        g_[at(kModes * aggregate + m)] = sums[m][0] + sums[m][1] + sums[m][2];
}

double CoarseSpace::solve_coarse() {
    c_ = g_;
    cholesky_.solve(c_);
    double product = 0.0;
    for (std::size_t i = 0; i < c_.size(); ++i)
        product += c_[i] * g_[i];
    return product;
}

void CoarseSpace::renew_direction(
    const double* r, double beta, int begin, int end, double* p) const {
#if defined(__x86_64__)
    if (lane_dispatch() != LaneDispatch::Width2)
        return renew_rows_avx2(
            entries_.data(), entry_begin_.data(), c_.data(), r, beta, begin, end, p);
#endif
    renew_rows(entries_.data(), entry_begin_.data(), c_.data(), r, beta, begin, end, p);
}

}  // namespace noli
