// SPDX-License-Identifier: Apache-2.0
#include "linear/incomplete_cholesky.hpp"

#include "core/index.hpp"
#include "exec/lanes.hpp"
#include "linear/column_sums.hpp"

namespace noli {

namespace {

using detail::add_lanes;
using detail::at;
using detail::ColumnSums;
using detail::load_wide;
using detail::Wide;
using detail::wide;

/// Row-major 3x3 block whose rows are padded to four doubles; lane 3 is junk.
struct WideBlock {
    Wide row[3];

    /// From a column-major block.
    template <class Number>
    static WideBlock from(const Number* b) {
        const auto row = [b](int r) {
            return Wide{static_cast<double>(b[r]),
                        static_cast<double>(b[3 + r]),
                        static_cast<double>(b[6 + r]),
                        0};
        };
        return {{row(0), row(1), row(2)}};
    }
    static WideBlock identity(double scale) {
        return {{Wide{scale, 0, 0, 0}, Wide{0, scale, 0, 0}, Wide{0, 0, scale, 0}}};
    }
    [[nodiscard]] WideBlock transposed() const {
        return {Wide{row[0][0], row[1][0], row[2][0], 0},
                Wide{row[0][1], row[1][1], row[2][1], 0},
                Wide{row[0][2], row[1][2], row[2][2], 0}};
    }
    [[nodiscard]] Mat3d narrow() const {
        return {row[0][0],
                row[0][1],
                row[0][2],
                row[1][0],
                row[1][1],
                row[1][2],
                row[2][0],
                row[2][1],
                row[2][2]};
    }
};

/// block -= left * Bᵀ for a column-major float block B.
inline __attribute__((always_inline)) void subtract_product(WideBlock& block,
                                                            const WideBlock& left,
                                                            const float* b) {
    const Wide b0 = load_wide(b);
    const Wide b1 = load_wide(b + 3);
    const Wide b2 = load_wide(b + 6);
    for (int i = 0; i < 3; ++i)
        block.row[i] -= left.row[i][0] * b0 + left.row[i][1] * b1 + left.row[i][2] * b2;
}

/// True when m - theta I has positive pivots only.
bool exceeds(const Mat3d& m, double theta) {
    const Mat3d d = m + (-theta) * identity3();
    if (!(d.a[0] > 0.0)) return false;
    const double l10 = d.a[3] / d.a[0];
    const double l20 = d.a[6] / d.a[0];
    const double d1 = d.a[4] - l10 * d.a[1];
    if (!(d1 > 0.0)) return false;
    const double u12 = d.a[5] - l10 * d.a[2];
    return d.a[8] - l20 * d.a[2] - u12 * u12 / d1 > 0.0;
}

/// What a row's factorisation reads and writes.
template <class Number>
struct FactorArrays {
    const MergedBlocks& rows;
    const Number* blocks;  ///< L'
    float* lower;
    SymMat3d* pivot_inverse;
    double shift;
};

/// Off-diagonal entries of the row that is being factorised.
struct OpenRow {
    std::vector<int> place;  ///< column -> its entry in this row, or -1
    std::vector<WideBlock> entries;

    template <class Number>
    void open(const FactorArrays<Number>& f, int row) {
        const int begin = f.rows.row_begin[at(row)];
        const int count = f.rows.row_begin[at(row) + 1] - 1 - begin;
        if (place.size() < at(f.rows.num_rows())) place.resize(at(f.rows.num_rows()), -1);
        entries.clear();
        for (int p = 0; p < count; ++p) {
            place[at(f.rows.col[at(begin + p)])] = p;
            entries.push_back(WideBlock::from(f.blocks + 9 * at(begin - row + p)));
        }
    }
    void close(const MergedBlocks& rows, int row) {
        for (int p = rows.row_begin[at(row)]; p < rows.row_begin[at(row) + 1] - 1; ++p)
            place[at(rows.col[at(p)])] = -1;
    }
};

/// Entry p of the open row, less what the columns before it account for: row_p -= row_k
/// M_jkᵀ.
template <class Number>
inline __attribute__((always_inline)) void eliminate(const FactorArrays<Number>& f,
                                                     OpenRow& open,
                                                     int p,
                                                     int j) {
    const int begin = f.rows.row_begin[at(j)];
    const int end = f.rows.row_begin[at(j) + 1] - 1;
    WideBlock block = open.entries[at(p)];
    for (int q = begin; q < end; ++q) {
        const int k = open.place[at(f.rows.col[at(q)])];
        if (k >= 0) subtract_product(block, open.entries[at(k)], f.lower + 9 * at(q - j));
    }
    open.entries[at(p)] = block;
}

/// Stores M_ij = entry * D_j⁻¹ and takes entry * M_ijᵀ off the pivot.
inline __attribute__((always_inline)) void finish_entry(const WideBlock& entry,
                                                        const SymMat3d& inverse,
                                                        float* out,
                                                        WideBlock& pivot) {
    const WideBlock column = entry.transposed();
    const Wide scaled[3] = {inverse.xx * column.row[0] + inverse.xy * column.row[1]
                                + inverse.xz * column.row[2],
                            inverse.xy * column.row[0] + inverse.yy * column.row[1]
                                + inverse.yz * column.row[2],
                            inverse.xz * column.row[0] + inverse.yz * column.row[1]
                                + inverse.zz * column.row[2]};
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
            out[3 * c + r] = static_cast<float>(scaled[c][r]);
    for (int r = 0; r < 3; ++r)
        pivot.row[r] -= entry.row[r][0] * scaled[0] + entry.row[r][1] * scaled[1]
                      + entry.row[r][2] * scaled[2];
}

template <class Number>
inline __attribute__((always_inline)) bool factor_row(const FactorArrays<Number>& f,
                                                      OpenRow& open,
                                                      int row) {
    const int begin = f.rows.row_begin[at(row)];
    const int count = f.rows.row_begin[at(row) + 1] - begin - 1;
    WideBlock pivot = WideBlock::identity(1.0 + f.shift);
    open.open(f, row);
    for (int p = 0; p < count; ++p) {
        const int j = f.rows.col[at(begin + p)];
        eliminate(f, open, p, j);
        finish_entry(open.entries[at(p)],
                     f.pivot_inverse[j],
                     f.lower + 9 * at(begin - row + p),
                     pivot);
    }
    open.close(f.rows, row);

    // Far below the original block, a pivot is mostly the error of what was left out.
    constexpr double kSmallestPivot = 1e-3;
    const Mat3d result = pivot.narrow();
    if (!exceeds(result, kSmallestPivot)) return false;
    f.pivot_inverse[row] = robust_inverse(result);
    return true;
}

template <class Number>
inline __attribute__((always_inline)) bool factor_rows(const FactorArrays<Number>& f,
                                                       int begin,
                                                       int end) {
    thread_local OpenRow open;
    for (int i = begin; i < end; ++i)
        if (!factor_row(f, open, i)) return false;
    return true;
}

/// y_i = r_i - sum of M_ij y_j
inline __attribute__((always_inline)) void forward_rows(const MergedBlocks& rows,
                                                        const float* lower,
                                                        int begin,
                                                        int end,
                                                        const double* r,
                                                        double* y) {
    const int* row_begin = rows.row_begin.data();
    const int* col = rows.col.data();
    for (int i = begin; i < end; ++i) {
        ColumnSums sums;
        const int first = row_begin[i];
        const int last = row_begin[i + 1] - 1;
        const float* m = lower + 9 * at(first - i);
        for (int p = first; p < last; ++p, m += 9)
            sums.add(m, y + 4 * at(col[p]));
        wide(y + 4 * at(i)) = wide(r + 4 * at(i)) - sums.total();
    }
}

/// y_i = D_i⁻¹ y_i - sum of M_jiᵀ y_j; returns r.y.
inline __attribute__((always_inline)) double backward_rows(const ColouredOperator& rows,
                                                           const float* upper,
                                                           const SymMat3d* pivot_inverse,
                                                           int begin,
                                                           int end,
                                                           const double* r,
                                                           double* y) {
    Wide ry{};
    const int num_rows = rows.num_rows();
    const int* upper_begin = rows.upper_begin.data();
    const int* col = rows.upper_col.data();
    for (int i = end - 1; i >= begin; --i) {
        ColumnSums sums;
        const int place = num_rows - 1 - i;  // the last row comes first
        const float* m = upper + 9 * at(upper_begin[place]);
        for (int p = upper_begin[place]; p < upper_begin[place + 1]; ++p, m += 9)
            sums.add(m, y + 4 * at(col[p]));
        double* row = y + 4 * at(i);
        const Vec3d d = pivot_inverse[i] * Vec3d{row[0], row[1], row[2]};
        const Wide out = Wide{d.x, d.y, d.z, 0.0} - sums.total();
        wide(row) = out;
        ry += wide(r + 4 * at(i)) * out;
    }
    return add_lanes(ry);
}

}  // namespace

void IncompleteCholesky::resize(const ColouredOperator& rows) {
    constexpr std::size_t kPadding = 1;  // loads of four reach one past the last block
    lower_.resize(9 * rows.num_off_diagonal() + kPadding);
    upper_.resize(9 * rows.num_off_diagonal() + kPadding);
    pivot_inverse_.resize(at(rows.num_rows()));
}

bool IncompleteCholesky::factor(const ScaledOperator& op, int group, double shift) {
    const int begin = op.rows().rows().group_begin[at(group)];
    const int end = op.rows().rows().group_begin[at(group) + 1];
    return op.with_triangles([&](const auto& triangles) {
        const FactorArrays f{op.rows().lower(),
                             triangles.lower.view().data,
                             lower_.data(),
                             pivot_inverse_.data(),
                             shift};
        return detail::with_avx2([&] { return factor_rows(f, begin, end); });
    });
}

void IncompleteCholesky::transpose_row(const ColouredOperator& rows, int row) {
    const MergedBlocks& lower = rows.lower();
    for (int p = lower.row_begin[at(row)]; p < lower.row_begin[at(row) + 1] - 1; ++p) {
        const float* from = &lower_[9 * at(p - row)];
        float* to = &upper_[9 * at(rows.upper_place[at(p - row)])];
        for (int k = 0; k < 9; ++k)
            to[k] = from[3 * (k % 3) + k / 3];
    }
}

void IncompleteCholesky::forward(const ColouredOperator& rows,
                                 int group,
                                 const double* r,
                                 double* y) const {
    const int begin = rows.rows().group_begin[at(group)];
    const int end = rows.rows().group_begin[at(group) + 1];
    detail::with_avx2(
        [&] { forward_rows(rows.lower(), lower_.data(), begin, end, r, y); });
}

double IncompleteCholesky::backward(const ColouredOperator& rows,
                                    int group,
                                    const double* r,
                                    double* y) const {
    const int begin = rows.rows().group_begin[at(group)];
    const int end = rows.rows().group_begin[at(group) + 1];
    return detail::with_avx2([&] {
        return backward_rows(
            rows, upper_.data(), pivot_inverse_.data(), begin, end, r, y);
    });
}

}  // namespace noli
