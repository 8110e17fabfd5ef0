// SPDX-License-Identifier: Apache-2.0
#include "linear/coarse_cholesky.hpp"

#include "core/index.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace noli {

namespace {

constexpr int kSize = 6;

using detail::at;

#if defined(__x86_64__) && defined(__linux__)
#define NOLI_WITH_AVX2 __attribute__((target_clones("avx2", "default")))
#else
#define NOLI_WITH_AVX2
#endif

/// c[q] -= a[q] bᵀ for the blocks at a and the places of their results.
NOLI_WITH_AVX2 void subtract_products(
    const Block6* a, const int* places, int count, const Block6& b, Block6* c) {
    double bt[36];
    for (int i = 0; i < kSize; ++i)
        for (int k = 0; k < kSize; ++k)
            bt[kSize * k + i] = b.a[kSize * i + k];
    for (int q = 0; q < count; ++q) {
        double* to = c[places[q]].a;
        for (int i = 0; i < kSize; ++i) {
            double sum[kSize];
            for (int j = 0; j < kSize; ++j)
                sum[j] = to[kSize * i + j];
            for (int k = 0; k < kSize; ++k)
                for (int j = 0; j < kSize; ++j)
                    sum[j] -= a[q].a[kSize * i + k] * bt[kSize * k + j];
            for (int j = 0; j < kSize; ++j)
                to[kSize * i + j] = sum[j];
        }
    }
}

/// m := inverse of its Cholesky factor, lower triangular, with zero columns where there
/// is no pivot. `scale` holds the diagonal before elimination. False for NaN.
bool invert_factor(const double* scale, Block6& m) {
    constexpr double kNoPivot = 1e-11;
    double l[36] = {};
    double inverse[36] = {};
    for (int j = 0; j < kSize; ++j) {
        double pivot = m.a[kSize * j + j];
        for (int k = 0; k < j; ++k)
            pivot -= l[kSize * j + k] * l[kSize * j + k];
        if (!(std::fabs(pivot) < HUGE_VAL)) return false;
        if (pivot <= kNoPivot * scale[j]) continue;
        const double root = std::sqrt(pivot);
        l[kSize * j + j] = root;
        for (int i = j + 1; i < kSize; ++i) {
            double sum = m.a[kSize * i + j];
            for (int k = 0; k < j; ++k)
                sum -= l[kSize * i + k] * l[kSize * j + k];
            l[kSize * i + j] = sum / root;
        }
    }
    for (int j = 0; j < kSize; ++j) {
        if (l[kSize * j + j] == 0.0) continue;
        inverse[kSize * j + j] = 1.0 / l[kSize * j + j];
        for (int i = j + 1; i < kSize; ++i) {
            if (l[kSize * i + i] == 0.0) continue;
            double sum = 0.0;
            for (int k = j; k < i; ++k)
                sum -= l[kSize * i + k] * inverse[kSize * k + j];
            inverse[kSize * i + j] = sum / l[kSize * i + i];
        }
    }
    std::copy(inverse, inverse + 36, m.a);
    return true;
}

/// m := m wᵀ
void multiply_transposed(const Block6& w, Block6& m) {
    double out[36] = {};
    for (int i = 0; i < kSize; ++i)
        for (int j = 0; j < kSize; ++j)
            for (int k = 0; k < kSize; ++k)
                out[kSize * i + j] += m.a[kSize * i + k] * w.a[kSize * j + k];
    std::copy(out, out + 36, m.a);
}

}  // namespace

void CoarseCholesky::find_order(const CoarseMatrix& matrix) {
    const int n = matrix.num_rows();
    std::vector<std::set<int>> neighbours(at(n));
    for (int i = 0; i < n; ++i)
        for (int p = matrix.row_begin[at(i)]; p < matrix.row_begin[at(i) + 1] - 1; ++p) {
            neighbours[at(i)].insert(matrix.col[at(p)]);
            neighbours[at(matrix.col[at(p)])].insert(i);
        }
    std::set<std::pair<std::size_t, int>> queue;  // (degree, row)
    for (int i = 0; i < n; ++i)
        queue.emplace(neighbours[at(i)].size(), i);

    order_.clear();
    while (!queue.empty()) {
        const int row = queue.begin()->second;
        queue.erase(queue.begin());
        order_.push_back(row);
        const std::set<int> rest = std::move(neighbours[at(row)]);
        for (const int a : rest) {
            std::set<int>& of_a = neighbours[at(a)];
            queue.erase({of_a.size(), a});
            of_a.erase(row);
            of_a.insert(rest.begin(), rest.end());
            of_a.erase(a);
            queue.emplace(of_a.size(), a);
        }
    }
    place_.assign(at(n), 0);
    for (int k = 0; k < n; ++k)
        place_[at(order_[at(k)])] = k;
}

/// A column of the factor has the rows of the matrix's column and those of the columns
/// whose first row below the diagonal it is.
void CoarseCholesky::find_pattern(const CoarseMatrix& matrix) {
    const int n = matrix.num_rows();
    std::vector<std::vector<int>> columns(at(n));
    for (int i = 0; i < n; ++i)
        for (int p = matrix.row_begin[at(i)]; p < matrix.row_begin[at(i) + 1]; ++p) {
            const auto [first, last] =
                std::minmax(place_[at(i)], place_[at(matrix.col[at(p)])]);
            columns[at(first)].push_back(last);
        }
    col_begin_.assign(1, 0);
    row_.clear();
    for (int k = 0; k < n; ++k) {
        std::vector<int>& rows = columns[at(k)];
        std::sort(rows.begin(), rows.end());
        rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
        row_.insert(row_.end(), rows.begin(), rows.end());
        col_begin_.push_back(static_cast<int>(row_.size()));
        if (rows.size() < 2) continue;
        std::vector<int>& parent = columns[at(rows[1])];
        parent.insert(parent.end(), rows.begin() + 1, rows.end());
    }
}

void CoarseCholesky::analyze(const CoarseMatrix& matrix) {
    constexpr double kPoor = 1.5;
    const bool same_size = order_.size() == at(matrix.num_rows());
    if (same_size) find_pattern(matrix);
    if (!same_size
        || static_cast<double>(row_.size())
               > kPoor * static_cast<double>(blocks_of_order_)) {
        find_order(matrix);
        find_pattern(matrix);
        blocks_of_order_ = row_.size();
    }
    value_.resize(row_.size());
    work_.resize(at(kSize * matrix.num_rows()));
}

void CoarseCholesky::scatter(const CoarseMatrix& matrix) {
    std::fill(value_.begin(), value_.end(), Block6{});
    for (int i = 0; i < matrix.num_rows(); ++i)
        for (int p = matrix.row_begin[at(i)]; p < matrix.row_begin[at(i) + 1]; ++p) {
            const int a = place_[at(i)];
            const int b = place_[at(matrix.col[at(p)])];
            const int column = std::min(a, b);
            const auto begin = row_.begin() + col_begin_[at(column)];
            const auto end = row_.begin() + col_begin_[at(column) + 1];
            Block6& to = value_[at(static_cast<int>(
                std::lower_bound(begin, end, std::max(a, b)) - row_.begin()))];
            const Block6& from = matrix.value[at(p)];
            for (int r = 0; r < kSize; ++r)
                for (int c = 0; c < kSize; ++c)
                    to.a[kSize * r + c] =
                        a >= b ? from.a[kSize * r + c] : from.a[kSize * c + r];
        }
}

int CoarseCholesky::num_below(int column) const {
    return col_begin_[at(column) + 1] - col_begin_[at(column)] - 1;
}

/// Pivot of a column that all before it are eliminated from, and the blocks below it.
bool CoarseCholesky::finish_column(const CoarseMatrix& matrix, int column) {
    const Block6& original =
        matrix.value[at(matrix.row_begin[at(order_[at(column)]) + 1] - 1)];
    double scale[kSize];
    for (int i = 0; i < kSize; ++i)
        scale[i] = original.a[(kSize + 1) * i];
    const int diagonal = col_begin_[at(column)];
    if (!invert_factor(scale, value_[at(diagonal)])) return false;
    for (int p = diagonal + 1; p < col_begin_[at(column) + 1]; ++p)
        multiply_transposed(value_[at(diagonal)], value_[at(p)]);
    return true;
}

/// What a finished column takes off the column of its `target`-th row.
void CoarseCholesky::eliminate(int column, int target) {
    const int first = col_begin_[at(column)] + 1 + target;
    const int end = col_begin_[at(column) + 1];
    thread_local std::vector<int> places;
    places.clear();
    int to = col_begin_[at(row_[at(first)])];
    for (int q = first; q < end; ++q) {
        while (row_[at(to)] != row_[at(q)])
            ++to;
        places.push_back(to);
    }
    subtract_products(
        &value_[at(first)], places.data(), end - first, value_[at(first)], value_.data());
}

NOLI_WITH_AVX2 void CoarseCholesky::solve(std::span<double> x) const {
    const int n = static_cast<int>(order_.size());
    double* y = work_.data();
    for (int k = 0; k < n; ++k)
        std::copy_n(x.data() + kSize * order_[at(k)], kSize, y + kSize * k);
    for (int k = 0; k < n; ++k) {
        double v[kSize] = {};
        const double* inverse = value_[at(col_begin_[at(k)])].a;
        for (int i = 0; i < kSize; ++i)
            for (int j = 0; j <= i; ++j)
                v[i] += inverse[kSize * i + j] * y[kSize * k + j];
        std::copy_n(v, kSize, y + kSize * k);
        for (int p = col_begin_[at(k)] + 1; p < col_begin_[at(k) + 1]; ++p) {
            const double* block = value_[at(p)].a;
            double* to = y + kSize * row_[at(p)];
            for (int i = 0; i < kSize; ++i)
                for (int j = 0; j < kSize; ++j)
                    to[i] -= block[kSize * i + j] * v[j];
        }
    }
    for (int k = n - 1; k >= 0; --k) {
        double v[kSize];
        std::copy_n(y + kSize * k, kSize, v);
        for (int p = col_begin_[at(k)] + 1; p < col_begin_[at(k) + 1]; ++p) {
            const double* block = value_[at(p)].a;
            const double* from = y + kSize * row_[at(p)];
            for (int i = 0; i < kSize; ++i)
                for (int j = 0; j < kSize; ++j)
                    v[j] -= block[kSize * i + j] * from[i];
        }
        const double* inverse = value_[at(col_begin_[at(k)])].a;
        for (int j = 0; j < kSize; ++j) {
            double sum = 0.0;
            for (int i = j; i < kSize; ++i)
                sum += inverse[kSize * i + j] * v[i];
            y[kSize * k + j] = sum;
        }
    }
    for (int k = 0; k < n; ++k)
        std::copy_n(y + kSize * k, kSize, x.data() + kSize * order_[at(k)]);
}

}  // namespace noli
