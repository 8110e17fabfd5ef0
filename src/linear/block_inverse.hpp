// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Inverses of many dense symmetric positive semi-definite matrices of one size, all at
/// once: the blocks of a Schwarz preconditioner, or one coarse matrix.
///
/// Gauss-Jordan in place, six unknowns at a time. A step takes two loops: the first saves
/// the six columns and computes the six new rows, the second updates every number, so
/// none reads what another one writes. A number is a thread: short loops with much to do
/// in parallel, in any order, and the same bits everywhere.
///
/// A direction without stiffness is left out: its row and column of the inverse are 0.
///
/// Source: block Gauss-Jordan elimination, [Golub2013] 3.2; the rule for what is left out
/// is ours.

#include "core/vec.hpp"
#include "core/view.hpp"

#include <cmath>

namespace noli {

inline constexpr int kPivotSize = 6;

/// Pivots at most this share of the diagonal before elimination count as none.
inline constexpr double kLeastPivot = 1e-13;

/// Generalised inverse of a 6x6 pivot, through L D Lᵀ without the pivots that are too
/// small.
///
/// In:   a      (6,6) row-major, row stride `stride`, symmetric
///       scale  (6) diagonal of the matrix before elimination, >= 0
/// Out:  inverse (6,6) row-major, symmetric positive semi-definite
NOLI_HD inline void pivot_inverse(const double* a,
                                  int stride,
                                  const double* scale,
                                  double* inverse) {
    constexpr int kN = kPivotSize;
    double l[kN][kN] = {};
    double inverse_d[kN];
    double d[kN];
    for (int k = 0; k < kN; ++k) {
        d[k] = a[k * stride + k];
        for (int m = 0; m < k; ++m)
            d[k] -= l[k][m] * l[k][m] * d[m];
        const bool used = d[k] > kLeastPivot * scale[k];
        if (!used) d[k] = 0.0;
        inverse_d[k] = used ? 1.0 / d[k] : 0.0;
        l[k][k] = 1.0;
        for (int i = k + 1; i < kN; ++i) {
            double sum = a[i * stride + k];
            for (int m = 0; m < k; ++m)
                sum -= l[i][m] * l[k][m] * d[m];
            l[i][k] = sum * inverse_d[k];
        }
    }
    // Column j: L D Lᵀ x = unit vector j.
    for (int j = 0; j < kN; ++j) {
        double x[kN];
        for (int i = 0; i < kN; ++i) {
            x[i] = i == j ? 1.0 : 0.0;
            for (int m = 0; m < i; ++m)
                x[i] -= l[i][m] * x[m];
        }
        for (int i = kN - 1; i >= 0; --i) {
            x[i] *= inverse_d[i];
            for (int m = i + 1; m < kN; ++m)
                x[i] -= l[m][i] * x[m];
            inverse[i * kN + j] = x[i];
        }
    }
}

/// Square matrices, row-major, one after the other.
struct DenseMatrices {
    View<double> values;
    int size;   ///< rows of one; a multiple of kPivotSize
    int count;  ///< of matrices

    [[nodiscard]] NOLI_HD double& at(int matrix, int row, int col) const {
        return values[(matrix * size + row) * size + col];
    }
};

namespace detail {

template <class Exec>
void save_diagonals(Exec& exec, DenseMatrices a, View<double> scale) {
    exec.for_each("linear/save_diagonals", scale.size, [=] NOLI_HD(int r) {
        scale[r] = a.at(r / a.size, r % a.size, r % a.size);
    });
}

/// For pivot rows K = first ... first + 5 of each matrix: columns[r] = A_rK and
/// rows_K = P⁻¹ A_K, where the pivot's own columns of `rows` become P⁻¹.
template <class Exec>
void pivot_panels(Exec& exec,
                  DenseMatrices a,
                  int first,
                  View<const double> scale,
                  View<double> columns,
                  View<double> rows) {
    exec.for_each(
        "linear/pivot_panels",
        a.count * a.size,
        [=] NOLI_HD(int r) {
            constexpr int kN = kPivotSize;
            const int matrix = r / a.size;
            const int j = r % a.size;
            double inverse[kN * kN];
            pivot_inverse(&a.at(matrix, first, first),
                          a.size,
                          &scale[matrix * a.size + first],
                          inverse);
            double column[kN];
            for (int m = 0; m < kN; ++m) {
                column[m] = a.at(matrix, first + m, j);
                columns[r * kN + m] = a.at(matrix, j, first + m);
            }
            const bool own = j >= first && j < first + kN;
            for (int m = 0; m < kN; ++m) {
                double sum = 0.0;
                for (int k = 0; k < kN; ++k)
                    sum += inverse[kN * m + k] * column[k];
                rows[(matrix * kN + m) * a.size + j] =
                    own ? inverse[kN * m + j - first] : sum;
            }
        },
        16);
}

template <class Exec>
void eliminate_pivot(Exec& exec,
                     DenseMatrices a,
                     int first,
                     View<const double> columns,
                     View<const double> rows) {
    exec.for_each(
        "linear/eliminate_pivot",
        a.values.size,
        [=] NOLI_HD(int e) {
            constexpr int kN = kPivotSize;
            const int r = e / a.size;
            const int j = e % a.size;
            const int matrix = r / a.size;
            const int i = r % a.size;
            if (i >= first && i < first + kN) {
                a.values[e] = rows[(matrix * kN + i - first) * a.size + j];
                return;
            }
            double sum = 0.0;
            for (int m = 0; m < kN; ++m)
                sum += columns[r * kN + m] * rows[(matrix * kN + m) * a.size + j];
            const bool own = j >= first && j < first + kN;
            a.values[e] = own ? -sum : a.values[e] - sum;
        },
        1024);
}

}  // namespace detail

/// Keeps the buffers of the inversion.
template <class Exec>
class BlockInverse {
  public:
    template <class T>
    using Buffer = typename Exec::template Buffer<T>;

    /// `size` rows each, a multiple of kPivotSize.
    void resize(int count, int size) {
        count_ = count;
        size_ = size;
        values_.resize(count * size * size);
        scale_.resize(count * size);
        columns_.resize(count * size * kPivotSize);
        rows_.resize(count * size * kPivotSize);
    }

    /// The matrices before invert, their inverses after it.
    [[nodiscard]] DenseMatrices matrices() { return {values_.view(), size_, count_}; }

    void invert(Exec& exec) {
        const DenseMatrices a = matrices();
        detail::save_diagonals(exec, a, scale_.view());
        for (int first = 0; first < size_; first += kPivotSize) {
            detail::pivot_panels(
                exec, a, first, scale_.view(), columns_.view(), rows_.view());
            detail::eliminate_pivot(exec, a, first, columns_.view(), rows_.view());
        }
    }

  private:
    int count_ = 0;
    int size_ = 0;
    Buffer<double> values_, scale_, columns_, rows_;
};

}  // namespace noli
