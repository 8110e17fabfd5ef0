// SPDX-License-Identifier: Apache-2.0
#include "linear/incomplete_cholesky.hpp"

#include "exec/lanes.hpp"

#include <vector>

namespace noli {

namespace {

typedef float Float4 __attribute__((vector_size(16), aligned(4), may_alias));
typedef double Double4 __attribute__((vector_size(32), aligned(8), may_alias));

std::size_t at(int i) {
    return static_cast<std::size_t>(i);
}

/// Running sums of B x over column-major 3x3 blocks B, one per column so that they do not
/// wait for each other. Lane 3 is junk.
struct ColumnSums {
    Float4 c0{}, c1{}, c2{};

    void add(const float* block, const float* x) {
        const Float4 v = *reinterpret_cast<const Float4*>(x);
        c0 += *reinterpret_cast<const Float4*>(block) * Float4{v[0], v[0], v[0], v[0]};
        c1 +=
            *reinterpret_cast<const Float4*>(block + 3) * Float4{v[1], v[1], v[1], v[1]};
        c2 +=
            *reinterpret_cast<const Float4*>(block + 6) * Float4{v[2], v[2], v[2], v[2]};
    }
    [[nodiscard]] Float4 total() const { return c0 + c1 + c2; }
};

/// One store of all four lanes: the next row loads them again as one.
void store(float* y, const Vec3d& from, const Float4& minus) {
    *reinterpret_cast<Float4*>(y) = Float4{static_cast<float>(from.x),
                                           static_cast<float>(from.y),
                                           static_cast<float>(from.z),
                                           0}
                                  - minus;
}

/// Row-major 3x3 block whose rows are padded to four doubles; lane 3 is junk.
struct WideBlock {
    Double4 row[3];

    static WideBlock from(const Mat3d& m) {
        return {{Double4{m.a[0], m.a[1], m.a[2], 0},
                 Double4{m.a[3], m.a[4], m.a[5], 0},
                 Double4{m.a[6], m.a[7], m.a[8], 0}}};
    }
    [[nodiscard]] WideBlock transposed() const {
        return {Double4{row[0][0], row[1][0], row[2][0], 0},
                Double4{row[0][1], row[1][1], row[2][1], 0},
                Double4{row[0][2], row[1][2], row[2][2], 0}};
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
    const Double4 b0 =
        __builtin_convertvector(*reinterpret_cast<const Float4*>(b), Double4);
    const Double4 b1 =
        __builtin_convertvector(*reinterpret_cast<const Float4*>(b + 3), Double4);
    const Double4 b2 =
        __builtin_convertvector(*reinterpret_cast<const Float4*>(b + 6), Double4);
    for (int i = 0; i < 3; ++i)
        block.row[i] -= left.row[i][0] * b0 + left.row[i][1] * b1 + left.row[i][2] * b2;
}

/// True when m - theta * reference has positive pivots only.
bool exceeds(const Mat3d& m, double theta, const Mat3d& reference) {
    Mat3d d = m;
    for (int k = 0; k < 9; ++k)
        d.a[k] -= theta * reference.a[k];
    if (!(d.a[0] > 0.0)) return false;
    const double l10 = d.a[3] / d.a[0];
    const double l20 = d.a[6] / d.a[0];
    const double d1 = d.a[4] - l10 * d.a[1];
    if (!(d1 > 0.0)) return false;
    const double u12 = d.a[5] - l10 * d.a[2];
    return d.a[8] - l20 * d.a[2] - u12 * u12 / d1 > 0.0;
}

}  // namespace

void IncompleteCholesky::resize() {
    constexpr std::size_t kPadding = 1;  // loads of four reach one past the last block
    lower_.assign(9 * op_.num_off_diagonal() + kPadding, 0.0f);
    upper_.assign(9 * op_.num_off_diagonal() + kPadding, 0.0f);
    y_.assign(4 * at(op_.num_rows()), 0.0f);
    pivot_inverse_.resize(at(op_.num_rows()));
}

namespace {

/// What a row's factorisation reads and writes.
struct FactorArrays {
    const MergedBlocks& merged;
    float* lower;
    SymMat3d* pivot_inverse;
    double shift;
};

/// Off-diagonal entries of the row that is being factorised.
struct OpenRow {
    std::vector<int> place;  ///< column -> its entry in this row, or -1
    std::vector<WideBlock> entries;

    void open(const MergedBlocks& merged, int row) {
        if (place.size() < at(merged.num_rows())) place.resize(at(merged.num_rows()), -1);
        entries.clear();
        for (int p = merged.row_begin[at(row)]; p < merged.row_begin[at(row) + 1] - 1;
             ++p) {
            place[at(merged.col[at(p)])] = static_cast<int>(entries.size());
            entries.push_back(WideBlock::from(merged.value[at(p)]));
        }
    }
    void close(const MergedBlocks& merged, int row) {
        for (int p = merged.row_begin[at(row)]; p < merged.row_begin[at(row) + 1] - 1;
             ++p)
            place[at(merged.col[at(p)])] = -1;
    }
};

/// Entry p of the open row, less what the columns before it account for: row_p -= row_k
/// M_jkᵀ.
inline __attribute__((always_inline)) void eliminate(const FactorArrays& f,
                                                     OpenRow& open,
                                                     int p,
                                                     int j) {
    const int begin = f.merged.row_begin[at(j)];
    const int end = f.merged.row_begin[at(j) + 1] - 1;
    WideBlock block = open.entries[at(p)];
    for (int q = begin; q < end; ++q) {
        const int k = open.place[at(f.merged.col[at(q)])];
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
    const Double4 scaled[3] = {inverse.xx * column.row[0] + inverse.xy * column.row[1]
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

inline __attribute__((always_inline)) bool factor_row(const FactorArrays& f,
                                                      OpenRow& open,
                                                      int row) {
    const int begin = f.merged.row_begin[at(row)];
    const int count = f.merged.row_begin[at(row) + 1] - begin - 1;
    const Mat3d& original = f.merged.value[at(begin + count)];
    WideBlock pivot = WideBlock::from((1.0 + f.shift) * original);
    open.open(f.merged, row);
    for (int p = 0; p < count; ++p) {
        const int j = f.merged.col[at(begin + p)];
        eliminate(f, open, p, j);
        finish_entry(open.entries[at(p)],
                     f.pivot_inverse[j],
                     f.lower + 9 * at(begin - row + p),
                     pivot);
    }
    open.close(f.merged, row);

    // Far below the original block, a pivot is mostly the error of what was left out.
    constexpr double kSmallestPivot = 1e-3;
    const Mat3d result = pivot.narrow();
    if (!exceeds(result, kSmallestPivot, original)) return false;
    f.pivot_inverse[row] = robust_inverse(result);
    return true;
}

inline __attribute__((always_inline)) bool factor_rows(const FactorArrays& f,
                                                       int begin,
                                                       int end) {
    thread_local OpenRow open;
    for (int i = begin; i < end; ++i)
        if (!factor_row(f, open, i)) return false;
    return true;
}

#if defined(__x86_64__)
__attribute__((target("avx2"), flatten)) bool factor_rows_avx2(const FactorArrays& f,
                                                               int begin,
                                                               int end) {
    return factor_rows(f, begin, end);
}
#endif

}  // namespace

bool IncompleteCholesky::factor(int group, double shift) {
    const FactorArrays f{op_.lower(), lower_.data(), pivot_inverse_.data(), shift};
    const int begin = op_.rows().group_begin[at(group)];
    const int end = op_.rows().group_begin[at(group) + 1];
#if defined(__x86_64__)
    if (lane_dispatch() != LaneDispatch::Width2) return factor_rows_avx2(f, begin, end);
#endif
    return factor_rows(f, begin, end);
}

void IncompleteCholesky::transpose_row(int row) {
    const MergedBlocks& lower = op_.lower();
    for (int p = lower.row_begin[at(row)]; p < lower.row_begin[at(row) + 1] - 1; ++p) {
        const float* from = &lower_[9 * at(p - row)];
        float* to = &upper_[9 * at(op_.upper_place[at(p - row)])];
        for (int k = 0; k < 9; ++k)
            to[k] = from[3 * (k % 3) + k / 3];
    }
}

void IncompleteCholesky::forward(int group, View<const Vec3d> r) {
    const MergedBlocks& lower = op_.lower();
    const int rows_end = op_.rows().group_begin[at(group) + 1];
    for (int i = op_.rows().group_begin[at(group)]; i < rows_end; ++i) {
        ColumnSums sums;
        const int begin = lower.row_begin[at(i)];
        const int end = lower.row_begin[at(i) + 1] - 1;
        const float* m = lower_.data() + 9 * at(begin - i);
        for (int p = begin; p < end; ++p, m += 9)
            sums.add(m, &y_[4 * at(lower.col[at(p)])]);
        store(&y_[4 * at(i)], r[op_.numbering().vertex[at(i)]], sums.total());
    }
}

void IncompleteCholesky::backward(int group) {
    const int rows_begin = op_.rows().group_begin[at(group)];
    for (int i = op_.rows().group_begin[at(group) + 1] - 1; i >= rows_begin; --i) {
        ColumnSums sums;
        const float* m = upper_.data() + 9 * at(op_.upper_begin[at(i)]);
        for (int p = op_.upper_begin[at(i)]; p < op_.upper_begin[at(i) + 1]; ++p, m += 9)
            sums.add(m, &y_[4 * at(op_.upper_col[at(p)])]);
        float* y = &y_[4 * at(i)];
        store(y, pivot_inverse_[at(i)] * Vec3d{y[0], y[1], y[2]}, sums.total());
    }
}

Vec3d IncompleteCholesky::result(int vertex) const {
    const int i = op_.numbering().rank[at(vertex)];
    if (i < 0) return {0, 0, 0};
    const float* y = &y_[4 * at(i)];
    return {y[0], y[1], y[2]};
}

}  // namespace noli
