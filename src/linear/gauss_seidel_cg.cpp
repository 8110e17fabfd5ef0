// SPDX-License-Identifier: Apache-2.0
#include "linear/gauss_seidel_cg.hpp"

#include "exec/lanes.hpp"
#include "linear/wide.hpp"

#include <cmath>

namespace noli {

namespace {

using detail::load_wide;
using detail::wide;
using Double4 = detail::Wide;

std::size_t at(int i) {
    return static_cast<std::size_t>(i);
}

/// Running sums of B x over column-major 3x3 blocks B, one per column so that they do not
/// wait for each other. Loads of four reach one number past each column; total() drops
/// that lane.
struct ColumnSums {
    Double4 c0{}, c1{}, c2{};

    template <class Number>
    void add(const Number* block, const double* x) {
        c0 += load_wide(block) * x[0];
        c1 += load_wide(block + 3) * x[1];
        c2 += load_wide(block + 6) * x[2];
    }
    [[nodiscard]] Double4 total() const {
        const Double4 sum = c0 + c1 + c2;
        return Double4{sum[0], sum[1], sum[2], 0.0};
    }
};

/// Lanes added in a fixed order; lane 3 is 0.
double add_lanes(const Double4& v) {
    return v[0] + v[1] + v[2];
}

template <class Number>
inline __attribute__((always_inline)) double backward_rows(
    const detail::SweepArrays<Number>& s, double alpha, double beta, int begin, int end) {
    Double4 rr{};
    for (int i = end - 1; i >= begin; --i) {
        ColumnSums sums;
        for (int k = s.upper_begin.data[i]; k < s.upper_begin.data[i + 1]; ++k)
            sums.add(s.upper + 9 * at(k), s.t + 4 * at(s.upper_col.data[k]));
        const std::size_t row = 4 * at(i);
        const Double4 t = wide(s.t + row);
        wide(s.x + row) += alpha * t;
        const Double4 r = wide(s.r + row) - alpha * (t + wide(s.w + row));
        const Double4 p = r + beta * wide(s.p + row);
        wide(s.r + row) = r;
        wide(s.p + row) = p;
        wide(s.t + row) = p - sums.total();
        rr += r * r;
    }
    return add_lanes(rr);
}

template <class Number>
inline __attribute__((always_inline)) void backward_rows_alone(
    const detail::SweepArrays<Number>& s, int begin, int end) {
    for (int i = end - 1; i >= begin; --i) {
        ColumnSums sums;
        for (int k = s.upper_begin.data[i]; k < s.upper_begin.data[i + 1]; ++k)
            sums.add(s.upper + 9 * at(k), s.t + 4 * at(s.upper_col.data[k]));
        const std::size_t row = 4 * at(i);
        wide(s.t + row) = wide(s.p + row) - sums.total();
    }
}

template <class Number>
inline __attribute__((always_inline)) void forward_rows(
    const detail::SweepArrays<Number>& s, int begin, int end, detail::SweepSums& out) {
    Double4 pq{};
    Double4 rq{};
    Double4 qq{};
    for (int i = begin; i < end; ++i) {
        ColumnSums sums;
        const int first = s.lower_begin.data[i];
        const int last = s.lower_begin.data[i + 1] - 1;
        const Number* block = s.lower + 9 * at(first - i);
        for (int k = first; k < last; ++k, block += 9)
            sums.add(block, s.w + 4 * at(s.lower_col.data[k]));
        const std::size_t row = 4 * at(i);
        const Double4 p = wide(s.p + row);
        const Double4 t = wide(s.t + row);
        const Double4 w = p - t - sums.total();
        const Double4 q = t + w;
        wide(s.w + row) = w;
        pq += p * q;
        rq += wide(s.r + row) * q;
        qq += q * q;
    }
    out.pq = add_lanes(pq);
    out.rq = add_lanes(rq);
    out.qq = add_lanes(qq);
}

/// C⁻¹ v, lane 3 is 0
inline __attribute__((always_inline)) Double4 apply_factor(const InverseFactor& f,
                                                           const Vec3d& v) {
    return v.x * wide(f.c0) + v.y * wide(f.c1) + v.z * wide(f.c2);
}

/// L' = C_i⁻¹ m C_j⁻ᵀ, written column by column and transposed.
template <class Number>
inline __attribute__((always_inline)) void scale_block(const InverseFactor& fi,
                                                       const Mat3d& m,
                                                       const InverseFactor& fj,
                                                       Number* columns,
                                                       Number* rows) {
    Double4 half[3];  // rows of m C_j⁻ᵀ
    for (int r = 0; r < 3; ++r)
        half[r] = apply_factor(fj, m.row(r));
    const Double4 out[3] = {fi.c0[0] * half[0],
                            fi.c0[1] * half[0] + fi.c1[1] * half[1],
                            fi.c0[2] * half[0] + fi.c1[2] * half[1] + fi.c2[2] * half[2]};
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
            rows[at(3 * r + c)] = static_cast<Number>(out[r][c]);
            columns[at(3 * c + r)] = static_cast<Number>(out[r][c]);
        }
}

/// What filling a row of the scaled triangles needs.
template <class Number>
struct RowScaling {
    const InverseFactor* scale;
    const int* col;
    const int* upper_place;
    Number* lower;
    Number* upper;
};

/// Scales the `count` off-diagonal blocks of a row whose first one has number `first`.
template <class Number>
inline __attribute__((always_inline)) void scale_blocks(
    const RowScaling<Number>& s, int row, int first, int count, const Mat3d* blocks) {
    for (int p = 0; p < count; ++p)
        scale_block(s.scale[row],
                    blocks[p],
                    s.scale[s.col[p]],
                    s.lower + 9 * at(first + p),
                    s.upper + 9 * at(s.upper_place[first + p]));
}

#if defined(__x86_64__)
template <class Number>
__attribute__((target("avx2"), flatten)) double backward_rows_avx2(
    const detail::SweepArrays<Number>& s, double alpha, double beta, int begin, int end) {
    return backward_rows(s, alpha, beta, begin, end);
}
template <class Number>
__attribute__((target("avx2"), flatten)) void backward_rows_alone_avx2(
    const detail::SweepArrays<Number>& s, int begin, int end) {
    backward_rows_alone(s, begin, end);
}
template <class Number>
__attribute__((target("avx2"), flatten)) void forward_rows_avx2(
    const detail::SweepArrays<Number>& s, int begin, int end, detail::SweepSums& out) {
    forward_rows(s, begin, end, out);
}
template <class Number>
__attribute__((target("avx2"), flatten)) void scale_blocks_avx2(
    const RowScaling<Number>& s, int row, int first, int count, const Mat3d* blocks) {
    scale_blocks(s, row, first, count, blocks);
}
bool has_avx2() {
    return lane_dispatch() != LaneDispatch::Width2;
}
#endif

template <class Number>
double sweep_rows_backward(
    const detail::SweepArrays<Number>& s, double alpha, double beta, int begin, int end) {
#if defined(__x86_64__)
    if (has_avx2()) return backward_rows_avx2(s, alpha, beta, begin, end);
#endif
    return backward_rows(s, alpha, beta, begin, end);
}

template <class Number>
void sweep_rows_backward_alone(const detail::SweepArrays<Number>& s, int begin, int end) {
#if defined(__x86_64__)
    if (has_avx2()) return backward_rows_alone_avx2(s, begin, end);
#endif
    backward_rows_alone(s, begin, end);
}

template <class Number>
void sweep_rows_forward(const detail::SweepArrays<Number>& s,
                        int begin,
                        int end,
                        detail::SweepSums& sums) {
#if defined(__x86_64__)
    if (has_avx2()) return forward_rows_avx2(s, begin, end, sums);
#endif
    forward_rows(s, begin, end, sums);
}

}  // namespace

namespace detail {

double sweep_backward(
    const SweepArrays<double>& s, double alpha, double beta, int begin, int end) {
    return sweep_rows_backward(s, alpha, beta, begin, end);
}
double sweep_backward(
    const SweepArrays<float>& s, double alpha, double beta, int begin, int end) {
    return sweep_rows_backward(s, alpha, beta, begin, end);
}
void sweep_backward_alone(const SweepArrays<double>& s, int begin, int end) {
    sweep_rows_backward_alone(s, begin, end);
}
void sweep_backward_alone(const SweepArrays<float>& s, int begin, int end) {
    sweep_rows_backward_alone(s, begin, end);
}
void sweep_forward(const SweepArrays<double>& s, int begin, int end, SweepSums& sums) {
    sweep_rows_forward(s, begin, end, sums);
}
void sweep_forward(const SweepArrays<float>& s, int begin, int end, SweepSums& sums) {
    sweep_rows_forward(s, begin, end, sums);
}

}  // namespace detail

bool invert_factor(const Mat3d& m, InverseFactor& out) {
    const double largest = std::fmax(m.a[0], std::fmax(m.a[4], m.a[8]));
    out = {};
    if (largest <= 0.0) return m.a[0] == 0.0 && m.a[4] == 0.0 && m.a[8] == 0.0;
    const double rounding = 1e-14 * largest;
    bool positive = true;
    const auto root = [&](double pivot) {
        positive = positive && pivot > -100.0 * rounding;
        return std::sqrt(std::fmax(pivot, rounding));
    };
    const double c00 = root(m.a[0]);
    const double c10 = m.a[3] / c00;
    const double c20 = m.a[6] / c00;
    const double c11 = root(m.a[4] - c10 * c10);
    const double c21 = (m.a[7] - c20 * c10) / c11;
    const double c22 = root(m.a[8] - c20 * c20 - c21 * c21);
    out.c0[0] = 1.0 / c00;
    out.c1[1] = 1.0 / c11;
    out.c2[2] = 1.0 / c22;
    out.c0[1] = -c10 * out.c0[0] * out.c1[1];
    out.c1[2] = -c21 * out.c1[1] * out.c2[2];
    out.c0[2] = -(c20 * out.c0[0] + c21 * out.c0[1]) * out.c2[2];
    return positive;
}

void GaussSeidelCg::resize() {
    const std::size_t n = at(op_.num_rows());
    scale_.resize(n);
    for (std::vector<double>* v : {&x_, &r_, &p_, &t_, &w_})
        v->resize(4 * n);
    sums_.assign(at(op_.num_groups()), {});
}

double GaussSeidelCg::inertia_share(int row,
                                    View<const Mat3d> diagonal,
                                    View<const double> inertia) const {
    if (inertia.size == 0) return 0.0;
    const int v = op_.numbering().vertex[at(row)];
    const Mat3d& d = diagonal[v];
    return inertia[v] / std::fmax(d.a[0], std::fmax(d.a[4], d.a[8]));
}

void GaussSeidelCg::choose_precision(double least_inertia) {
    constexpr std::size_t kPadding = 1;  // loads of four reach one past the last block
    const std::size_t size = 9 * op_.num_off_diagonal() + kPadding;
    single_ = least_inertia >= kSinglePrecisionInertia;
    if (single_) {
        single_blocks_.lower.resize(size);
        single_blocks_.upper.resize(size);
    } else {
        double_blocks_.lower.resize(size);
        double_blocks_.upper.resize(size);
    }
}

bool GaussSeidelCg::scale_row(int row, View<const Mat3d> diagonal) {
    return invert_factor(diagonal[op_.numbering().vertex[at(row)]], scale_[at(row)]);
}

void GaussSeidelCg::fill_row(const OperatorView& op, int row) {
    thread_local std::vector<Mat3d> blocks;
    const MergedBlocks& lower = op_.lower();
    const int begin = lower.row_begin[at(row)];
    const int count = lower.row_begin[at(row) + 1] - begin;
    if (blocks.size() < at(count)) blocks.resize(at(count));
    detail::merged_row_values(op,
                              op_.touched(),
                              detail::const_view(op_.numbering().rank),
                              op_.numbering().vertex[at(row)],
                              {lower.col.data() + begin, at(count)},
                              {lower.source.data() + begin, at(count)},
                              blocks.data());
    if (single_)
        scale_row_blocks(single_blocks_, row, blocks.data());
    else
        scale_row_blocks(double_blocks_, row, blocks.data());
}

template <class Number>
void GaussSeidelCg::scale_row_blocks(Triangles<Number>& to,
                                     int row,
                                     const Mat3d* blocks) {
    const MergedBlocks& lower = op_.lower();
    const int begin = lower.row_begin[at(row)];
    const int count = lower.row_begin[at(row) + 1] - begin - 1;
    const RowScaling<Number> scaling{scale_.data(),
                                     lower.col.data() + begin,
                                     op_.upper_place.data(),
                                     to.lower.data(),
                                     to.upper.data()};
#if defined(__x86_64__)
    if (has_avx2()) return scale_blocks_avx2(scaling, row, begin - row, count, blocks);
#endif
    scale_blocks(scaling, row, begin - row, count, blocks);
}

void GaussSeidelCg::start_row(int row, View<const Vec3d> b) {
    // The forward sweep solves (I + L') w = p - t: with t = 0, w becomes the first
    // residual.
    const std::size_t k = 4 * at(row);
    wide(&p_[k]) = apply_factor(scale_[at(row)], b[op_.numbering().vertex[at(row)]]);
    wide(&t_[k]) = wide(&x_[k]) = wide(&r_[k]) = Double4{};
}

double GaussSeidelCg::start_result(int row) {
    const std::size_t k = 4 * at(row);
    const Double4 w = wide(&w_[k]);
    wide(&r_[k]) = w;
    wide(&p_[k]) = wide(&w_[k]) = Double4{};
    return add_lanes(w * w);
}

template <class Number>
detail::SweepArrays<Number> GaussSeidelCg::arrays(const Triangles<Number>& blocks) {
    return {detail::const_view(op_.lower().row_begin),
            detail::const_view(op_.lower().col),
            detail::const_view(op_.upper_begin),
            detail::const_view(op_.upper_col),
            blocks.lower.data(),
            blocks.upper.data(),
            x_.data(),
            r_.data(),
            p_.data(),
            t_.data(),
            w_.data()};
}

void GaussSeidelCg::backward(int group, double alpha, double beta) {
    const int begin = op_.rows().group_begin[at(group)];
    const int end = op_.rows().group_begin[at(group) + 1];
    sums_[at(group)].rr =
        single_ ? detail::sweep_backward(arrays(single_blocks_), alpha, beta, begin, end)
                : detail::sweep_backward(arrays(double_blocks_), alpha, beta, begin, end);
}

void GaussSeidelCg::backward_alone(int group) {
    const int begin = op_.rows().group_begin[at(group)];
    const int end = op_.rows().group_begin[at(group) + 1];
    if (single_)
        detail::sweep_backward_alone(arrays(single_blocks_), begin, end);
    else
        detail::sweep_backward_alone(arrays(double_blocks_), begin, end);
}

double GaussSeidelCg::advance(int row, double alpha) {
    const std::size_t k = 4 * at(row);
    const Double4 t = wide(&t_[k]);
    const Double4 r = wide(&r_[k]) - alpha * (t + wide(&w_[k]));
    wide(&x_[k]) += alpha * t;
    wide(&r_[k]) = r;
    return add_lanes(r * r);
}

void GaussSeidelCg::forward(int group) {
    const int begin = op_.rows().group_begin[at(group)];
    const int end = op_.rows().group_begin[at(group) + 1];
    if (single_)
        detail::sweep_forward(arrays(single_blocks_), begin, end, sums_[at(group)]);
    else
        detail::sweep_forward(arrays(double_blocks_), begin, end, sums_[at(group)]);
}

detail::SweepSums GaussSeidelCg::total() const {
    detail::SweepSums total;
    for (const detail::SweepSums& s : sums_) {
        total.rr += s.rr;
        total.pq += s.pq;
        total.rq += s.rq;
        total.qq += s.qq;
    }
    return total;
}

Vec3d GaussSeidelCg::result(int vertex, double alpha) const {
    const int i = op_.numbering().rank[at(vertex)];
    if (i < 0) return {0, 0, 0};
    const Double4 x = wide(&x_[4 * at(i)]) + alpha * wide(&t_[4 * at(i)]);
    const InverseFactor& f = scale_[at(i)];
    return {f.c0[0] * x[0] + f.c0[1] * x[1] + f.c0[2] * x[2],
            f.c1[1] * x[1] + f.c1[2] * x[2],
            f.c2[2] * x[2]};
}

}  // namespace noli
