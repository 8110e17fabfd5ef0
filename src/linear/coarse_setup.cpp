// SPDX-License-Identifier: Apache-2.0
/// CoarseSpace before a solve: rigid motions, their couplings, the coarse matrix.

#include "core/index.hpp"
#include "linear/coarse_space.hpp"
#include "linear/wide.hpp"

#include <cmath>
#include <utility>

namespace noli {

namespace {

constexpr int kModes = CoarseSpace::kModes;
constexpr int kBlock = CoarseSpace::kBlock;

using detail::at;
using detail::load_wide;
using detail::Wide;

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

/// Off-diagonal blocks of a row of one triangle.
template <class Number>
struct RowBlocks {
    const int* col;
    int count;
    const Number* block;  ///< column-major 3x3, one after the other
};

/// Sums of block * modes of the block's column, by the aggregate of the column: calls
/// take(k, sums) for each coupling.
template <class Number, class Take>
inline __attribute__((always_inline)) void sum_couplings(const RowBlocks<Number>& row,
                                                         const int* aggregate_of,
                                                         const int* couplings,
                                                         int num_couplings,
                                                         const float* modes,
                                                         const Take& take) {
    for (int k = 0; k < num_couplings; ++k) {
        Wide sum[kModes] = {};
        for (int p = 0; p < row.count; ++p) {
            if (aggregate_of[row.col[p]] != couplings[k]) continue;
            const float* z = modes + kBlock * static_cast<std::ptrdiff_t>(row.col[p]);
            const Number* block = row.block + 9 * static_cast<std::ptrdiff_t>(p);
            const Wide b0 = load_wide(block);
            const Wide b1 = load_wide(block + 3);
            const Wide b2 = load_wide(block + 6);
            for (int m = 0; m < kModes; ++m)
                sum[m] += b0 * static_cast<double>(z[3 * m])
                        + b1 * static_cast<double>(z[3 * m + 1])
                        + b2 * static_cast<double>(z[3 * m + 2]);
        }
        take(k, sum);
    }
}

template <class Number>
inline __attribute__((always_inline)) void store_block(const Wide* columns, Number* out) {
    for (int m = 0; m < kModes; ++m)
        for (int r = 0; r < 3; ++r)
            out[3 * m + r] = static_cast<Number>(columns[m][r]);
    out[3 * kModes] = out[3 * kModes + 1] = Number(0);
}

/// out += (zᵀ w)ᵀ
template <class Number>
inline __attribute__((always_inline)) void add_gram(const float* z,
                                                    const Number* w,
                                                    Block6& out) {
    double by_axis[3][kModes];
    for (int m = 0; m < kModes; ++m)
        for (int r = 0; r < 3; ++r)
            by_axis[r][m] = static_cast<double>(z[3 * m + r]);
    for (int j = 0; j < kModes; ++j)
        for (int i = 0; i < kModes; ++i)
            out.a[kModes * j + i] += by_axis[0][i] * static_cast<double>(w[3 * j])
                                   + by_axis[1][i] * static_cast<double>(w[3 * j + 1])
                                   + by_axis[2][i] * static_cast<double>(w[3 * j + 2]);
}

}  // namespace

void CoarseSpace::set_aggregates(RigidAggregates aggregates) {
    aggregates_ = std::move(aggregates);
}

void CoarseSpace::update_pattern(const ColouredOperator& op, bool for_residuals) {
    pattern_.update(op, aggregates_.of_vertex, num_aggregates(), for_residuals);
    for_residuals_ = for_residuals;
    pattern_.find_matrix(matrix_);
    cholesky_.analyze(matrix_);
    modes_.assign(at(kBlock * op.num_rows()), 0.0f);
    pull_.resize(at(kBlock) * pattern_.upper.size());
    pull_of_.resize(at(kBlock) * pattern_.upper.size());
    push_of_.resize(at(kBlock) * pattern_.lower.size());
    coupling_.resize(pattern_.col.size());
    gram_.resize(at(num_aggregates()));
    g_.assign(at(kModes * num_aggregates()), 0.0);
    c_ = g_;
}

void CoarseSpace::fill_modes(const ColouredOperator& op,
                             const InverseFactor* scale,
                             View<const Vec3d> x,
                             int aggregate) {
    const int begin = pattern_.rows_begin[at(aggregate)];
    const int end = pattern_.rows_begin[at(aggregate) + 1];
    if (begin == end) return;
    const auto position = [&](int k) {
        return x[op.numbering().vertex[at(pattern_.rows[at(k)])]];
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
        const int row = pattern_.rows[at(k)];
        const Vec3d d = per_radius * (position(k) - centre);
        const Vec3d motion[kModes] = {{1, 0, 0},
                                      {0, 1, 0},
                                      {0, 0, 1},
                                      {0, -d.z, d.y},
                                      {d.z, 0, -d.x},
                                      {-d.y, d.x, 0}};
        for (int m = 0; m < kModes; ++m) {
            const Vec3d z = apply_transposed_factor(scale[row], motion[m]);
            for (int c = 0; c < 3; ++c)
                modes_[at(kBlock * row + 3 * m + c)] = static_cast<float>(z[c]);
        }
    }
}

template <class Number>
void CoarseSpace::fill_row(const ColouredOperator& op,
                           const Number* lower,
                           const Number* upper,
                           int row) {
    const std::vector<int>& lower_begin = op.lower().row_begin;
    const int first = lower_begin[at(row)];
    const int next = op.first_upper(row);
    const RowBlocks<Number> after{
        op.upper_col.data() + next, op.end_upper(row) - next, upper + 9 * at(next)};
    const auto fill = [&](const RowBlocks<Number>& blocks,
                          const RowCouplings& couplings,
                          const auto& take) {
        const int begin = couplings.begin[at(row)];
        detail::with_avx2([&] {
            sum_couplings(blocks,
                          pattern_.aggregate.data(),
                          couplings.aggregate.data() + begin,
                          couplings.begin[at(row) + 1] - begin,
                          modes_.data(),
                          [&](int k, const Wide* sum) { take(at(begin + k), sum); });
        });
    };
    fill(after, pattern_.upper, [this](std::size_t e, const Wide* sum) {
        store_block(sum, &pull_[at(kBlock) * e]);
        store_block(sum, &pull_of_[at(kBlock) * at(pattern_.upper.of_place[e])]);
    });
    if (lower == nullptr) return;
    const RowBlocks<Number> before{op.lower().col.data() + first,
                                   lower_begin[at(row) + 1] - 1 - first,
                                   lower + 9 * at(first - row)};
    fill(before, pattern_.lower, [this](std::size_t e, const Wide* sum) {
        store_block(sum, &push_of_[at(kBlock) * at(pattern_.lower.of_place[e])]);
    });
}

template void CoarseSpace::fill_row(const ColouredOperator&,
                                    const float*,
                                    const float*,
                                    int);
template void CoarseSpace::fill_row(const ColouredOperator&,
                                    const double*,
                                    const double*,
                                    int);

void CoarseSpace::fill_coarse_row(int aggregate) {
    for (int p = pattern_.begin[at(aggregate)]; p < pattern_.begin[at(aggregate) + 1];
         ++p)
        coupling_[at(p)] = {};
    gram_[at(aggregate)] = {};
    detail::with_avx2([&] {
        for (int k = pattern_.rows_begin[at(aggregate)];
             k < pattern_.rows_begin[at(aggregate) + 1];
             ++k) {
            const int row = pattern_.rows[at(k)];
            const float* z = modes_.data() + at(kBlock) * at(row);
            add_gram(z, z, gram_[at(aggregate)]);
            for (int e = pattern_.upper.begin[at(row)];
                 e < pattern_.upper.begin[at(row) + 1];
                 ++e)
                add_gram(z,
                         pull_.data() + at(kBlock) * at(e),
                         coupling_[at(pattern_.place[at(e)])]);
        }
    });
}

void CoarseSpace::sum_matrix() {
    for (int a = 0; a < num_aggregates(); ++a)
        for (int p = matrix_.row_begin[at(a)]; p < matrix_.row_begin[at(a) + 1]; ++p) {
            Block6& to = matrix_.value[at(p)];
            const int direct = pattern_.from[at(2 * p)];
            const int mirrored = pattern_.from[at(2 * p + 1)];
            for (int i = 0; i < kModes; ++i)
                for (int j = 0; j < kModes; ++j) {
                    double sum = 0.0;
                    if (direct >= 0) sum += coupling_[at(direct)].a[kModes * j + i];
                    if (mirrored >= 0) sum += coupling_[at(mirrored)].a[kModes * i + j];
                    if (matrix_.col[at(p)] == a) sum += gram_[at(a)].a[kModes * i + j];
                    to.a[kModes * i + j] = sum;
                }
        }
}

}  // namespace noli
