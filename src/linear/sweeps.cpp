// SPDX-License-Identifier: Apache-2.0
#include "linear/sweeps.hpp"

#include "core/index.hpp"
#include "linear/column_sums.hpp"

namespace noli {

namespace {

using detail::add_lanes;
using detail::apply_factor;
using detail::at;
using detail::ColumnSums;
using detail::Wide;
using detail::wide;

/// L'ᵀ v at row i.
template <class Number>
inline __attribute__((always_inline)) void add_upper(detail::SweepArrays<Number> s,
                                                     const double* v,
                                                     int i,
                                                     ColumnSums& sums) {
    const int* begin = s.upper_begin.data + (s.upper_begin.size - 2 - i);
    const Number* block = s.upper + 9 * at(begin[0]);
    for (int k = begin[0]; k < begin[1]; ++k, block += 9)
        sums.add(block, v + 4 * at(s.upper_col.data[k]));
}

template <class Number>
inline __attribute__((always_inline)) double backward_rows(
    detail::SweepArrays<Number> s, double alpha, double beta, int begin, int end) {
    Wide rr{};
    for (int i = end - 1; i >= begin; --i) {
        ColumnSums sums;
        add_upper(s, s.t, i, sums);
        const std::size_t row = 4 * at(i);
        const Wide t = wide(s.t + row);
        wide(s.x + row) += alpha * t;
        const Wide r = wide(s.r + row) - alpha * (t + wide(s.w + row));
        const Wide p = r + beta * wide(s.p + row);
        wide(s.r + row) = r;
        wide(s.p + row) = p;
        wide(s.t + row) = p - sums.total();
        rr += r * r;
    }
    return add_lanes(rr);
}

template <class Number>
inline __attribute__((always_inline)) double residual_rows(detail::SweepArrays<Number> s,
                                                           double alpha,
                                                           int begin,
                                                           int end) {
    Wide rr{};
    for (int i = end - 1; i >= begin; --i) {
        ColumnSums sums;
        add_upper(s, s.y, i, sums);
        const std::size_t row = 4 * at(i);
        const Wide t = wide(s.t + row);
        wide(s.x + row) += alpha * t;
        const Wide r = wide(s.r + row) - alpha * (t + wide(s.w + row));
        wide(s.r + row) = r;
        wide(s.y + row) = r - sums.total();
        rr += r * r;
    }
    return add_lanes(rr);
}

/// L' v at row i.
template <class Number>
inline __attribute__((always_inline)) void add_lower(detail::SweepArrays<Number> s,
                                                     const double* v,
                                                     int i,
                                                     ColumnSums& sums) {
    const int first = s.lower_begin.data[i];
    const int last = s.lower_begin.data[i + 1] - 1;
    const Number* block = s.lower + 9 * at(first - i);
    for (int k = first; k < last; ++k, block += 9)
        sums.add(block, v + 4 * at(s.lower_col.data[k]));
}

template <class Number>
inline __attribute__((always_inline)) void product_rows(detail::SweepArrays<Number> s,
                                                        int begin,
                                                        int end,
                                                        detail::SweepSums& out) {
    Wide pq{};
    Wide rp{};
    for (int i = begin; i < end; ++i) {
        ColumnSums sums;
        add_lower(s, s.t, i, sums);
        add_upper(s, s.t, i, sums);
        const std::size_t row = 4 * at(i);
        const Wide t = wide(s.t + row);
        const Wide w = t + sums.total();
        wide(s.w + row) = w;
        pq += t * w;
        rp += wide(s.r + row) * t;
    }
    out.pq = add_lanes(pq);
    out.rp = add_lanes(rp);
}

/// w = (p - t) - L' w for rows in order, and the sums over q = t + w. parts(row, t) gives
/// {p, p - t} at place `row` of the arrays.
template <class Number, class Parts>
inline __attribute__((always_inline)) void forward_rows(detail::SweepArrays<Number> s,
                                                        int begin,
                                                        int end,
                                                        const Parts& parts,
                                                        detail::SweepSums& out) {
    Wide pq{};
    Wide rp{};
    Wide rq{};
    Wide qq{};
    for (int i = begin; i < end; ++i) {
        ColumnSums sums;
        add_lower(s, s.w, i, sums);
        const std::size_t row = 4 * at(i);
        const Wide t = wide(s.t + row);
        const Wide r = wide(s.r + row);
        const auto [p, apart] = parts(row, t);
        const Wide w = apart - sums.total();
        const Wide q = t + w;
        wide(s.w + row) = w;
        pq += p * q;
        rp += r * p;
        rq += r * q;
        qq += q * q;
    }
    out.pq = add_lanes(pq);
    out.rp = add_lanes(rp);
    out.rq = add_lanes(rq);
    out.qq = add_lanes(qq);
}

struct Parts {
    Wide p, apart;  ///< p, p - t
};

/// s holds p - t.
template <class Number>
inline __attribute__((always_inline)) void split_rows(detail::SweepArrays<Number> s,
                                                      int begin,
                                                      int end,
                                                      detail::SweepSums& out) {
    const auto parts = [&s](std::size_t row, const Wide& t) {
        const Wide apart = wide(s.s + row);
        return Parts{apart + t, apart};
    };
    forward_rows(s, begin, end, parts, out);
}

template <class Number>
inline __attribute__((always_inline)) void direction_rows(detail::SweepArrays<Number> s,
                                                          int begin,
                                                          int end,
                                                          detail::SweepSums& out) {
    const auto parts = [&s](std::size_t row, const Wide& t) {
        const Wide p = wide(s.p + row);
        return Parts{p, p - t};
    };
    forward_rows(s, begin, end, parts, out);
}

/// A 3x3 block from its rows, row by row and column by column.
inline __attribute__((always_inline)) void store_both(const Wide (&m)[3],
                                                      double* rows,
                                                      double* columns) {
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
            rows[at(3 * r + c)] = m[r][c];
            columns[at(3 * c + r)] = m[r][c];
        }
}

typedef float Float4 __attribute__((vector_size(16), aligned(4), may_alias));

/// Nine numbers from three times three: lane 3 is overwritten by what follows.
inline __attribute__((always_inline)) void store_threes(const Float4& a,
                                                        const Float4& b,
                                                        const Float4& c,
                                                        float* out) {
    typedef float Float2 __attribute__((vector_size(8), aligned(4), may_alias));
    *reinterpret_cast<Float4*>(out) = a;
    *reinterpret_cast<Float4*>(out + 3) = b;
    *reinterpret_cast<Float2*>(out + 6) = __builtin_shufflevector(c, c, 0, 1);
    out[8] = c[2];
}

inline __attribute__((always_inline)) void store_both(const Wide (&m)[3],
                                                      float* rows,
                                                      float* columns) {
    const Float4 a = __builtin_convertvector(m[0], Float4);
    const Float4 b = __builtin_convertvector(m[1], Float4);
    const Float4 c = __builtin_convertvector(m[2], Float4);
    store_threes(a, b, c, rows);
    const Float4 first = __builtin_shufflevector(a, b, 0, 4, 1, 5);
    const Float4 last = __builtin_shufflevector(a, b, 2, 6, 2, 6);
    store_threes(__builtin_shufflevector(first, c, 0, 1, 4, 4),
                 __builtin_shufflevector(first, c, 2, 3, 5, 5),
                 __builtin_shufflevector(last, c, 0, 1, 6, 6),
                 columns);
}

/// L' = C_i⁻¹ m C_j⁻ᵀ, written column by column and transposed.
template <class Number>
inline __attribute__((always_inline)) void scale_block(const InverseFactor& fi,
                                                       const Mat3d& m,
                                                       const InverseFactor& fj,
                                                       Number* columns,
                                                       Number* rows) {
    Wide half[3];  // rows of m C_j⁻ᵀ
    for (int r = 0; r < 3; ++r)
        half[r] = apply_factor(fj, m.row(r));
    const Wide out[3] = {fi.c0[0] * half[0],
                         fi.c0[1] * half[0] + fi.c1[1] * half[1],
                         fi.c0[2] * half[0] + fi.c1[2] * half[1] + fi.c2[2] * half[2]};
    store_both(out, rows, columns);
}

using detail::RowScaling;

/// Scales the `count` off-diagonal blocks of a row whose first one has number `first`.
template <class Number>
inline __attribute__((always_inline)) void scale_row_blocks(
    const RowScaling<Number>& s, int row, int first, int count, const Mat3d* blocks) {
    for (int p = 0; p < count; ++p)
        scale_block(s.scale[row],
                    blocks[p],
                    s.scale[s.col[p]],
                    s.lower + 9 * at(first + p),
                    s.upper + 9 * at(s.upper_place[first + p]));
}

}  // namespace

namespace detail {

template <class Number>
void scale_blocks(
    const RowScaling<Number>& s, int row, int first, int count, const Mat3d* blocks) {
    with_avx2([&] { scale_row_blocks(s, row, first, count, blocks); });
}

template <class Number>
double sweep_backward(
    const SweepArrays<Number>& s, double alpha, double beta, int begin, int end) {
    return with_avx2([&] { return backward_rows(s, alpha, beta, begin, end); });
}

template <class Number>
double sweep_residual(const SweepArrays<Number>& s, double alpha, int begin, int end) {
    return with_avx2([&] { return residual_rows(s, alpha, begin, end); });
}

template <class Number>
void sweep_forward(const SweepArrays<Number>& s, int begin, int end, SweepSums& sums) {
    with_avx2([&] { direction_rows(s, begin, end, sums); });
}

template <class Number>
void sweep_split(const SweepArrays<Number>& s, int begin, int end, SweepSums& sums) {
    with_avx2([&] { split_rows(s, begin, end, sums); });
}

template <class Number>
void multiply_rows(const SweepArrays<Number>& s, int begin, int end, SweepSums& sums) {
    with_avx2([&] { product_rows(s, begin, end, sums); });
}

template void scale_blocks(const RowScaling<double>&, int, int, int, const Mat3d*);
template double sweep_backward(const SweepArrays<double>&, double, double, int, int);
template double sweep_residual(const SweepArrays<double>&, double, int, int);
template void sweep_forward(const SweepArrays<double>&, int, int, SweepSums&);
template void sweep_split(const SweepArrays<double>&, int, int, SweepSums&);
template void multiply_rows(const SweepArrays<double>&, int, int, SweepSums&);

template void scale_blocks(const RowScaling<float>&, int, int, int, const Mat3d*);
template double sweep_backward(const SweepArrays<float>&, double, double, int, int);
template double sweep_residual(const SweepArrays<float>&, double, int, int);
template void sweep_forward(const SweepArrays<float>&, int, int, SweepSums&);
template void sweep_split(const SweepArrays<float>&, int, int, SweepSums&);
template void multiply_rows(const SweepArrays<float>&, int, int, SweepSums&);

}  // namespace detail

}  // namespace noli
