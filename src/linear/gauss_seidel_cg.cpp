// SPDX-License-Identifier: Apache-2.0
#include "linear/gauss_seidel_cg.hpp"

#include "exec/lanes.hpp"

#include <cmath>

namespace noli {

namespace {

typedef double Double4 __attribute__((vector_size(32), aligned(8), may_alias));

std::size_t at(int i) {
    return static_cast<std::size_t>(i);
}

Double4& wide(double* v) {
    return *reinterpret_cast<Double4*>(v);
}
const Double4& wide(const double* v) {
    return *reinterpret_cast<const Double4*>(v);
}

/// Running sums of B x over column-major 3x3 blocks B, one per column so that they do not
/// wait for each other. Loads of four reach one number past each column; total() drops
/// that lane.
struct ColumnSums {
    Double4 c0{}, c1{}, c2{};

    void add(const double* block, const double* x) {
        c0 += wide(block) * x[0];
        c1 += wide(block + 3) * x[1];
        c2 += wide(block + 6) * x[2];
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

inline __attribute__((always_inline)) double backward_rows(
    const detail::SweepArrays& s, double alpha, double beta, int begin, int end) {
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

inline __attribute__((always_inline)) void forward_rows(const detail::SweepArrays& s,
                                                        int begin,
                                                        int end,
                                                        detail::SweepSums& out) {
    Double4 pq{};
    Double4 rq{};
    Double4 qq{};
    for (int i = begin; i < end; ++i) {
        ColumnSums sums;
        const int first = s.lower_begin.data[i];
        const int last = s.lower_begin.data[i + 1] - 1;
        const double* block = s.lower + 9 * at(first - i);
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
inline __attribute__((always_inline)) void scale_block(const InverseFactor& fi,
                                                       const Mat3d& m,
                                                       const InverseFactor& fj,
                                                       double* columns,
                                                       double* rows) {
    Double4 half[3];  // rows of m C_j⁻ᵀ
    for (int r = 0; r < 3; ++r)
        half[r] = apply_factor(fj, m.row(r));
    const Double4 out[3] = {fi.c0[0] * half[0],
                            fi.c0[1] * half[0] + fi.c1[1] * half[1],
                            fi.c0[2] * half[0] + fi.c1[2] * half[1] + fi.c2[2] * half[2]};
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
            rows[at(3 * r + c)] = out[r][c];
            columns[at(3 * c + r)] = out[r][c];
        }
}

/// What filling a row of the scaled triangles needs.
struct RowScaling {
    const InverseFactor* scale;
    const int* col;
    const int* upper_place;
    double* lower;
    double* upper;
};

/// Scales the `count` off-diagonal blocks of a row whose first one has number `first`.
inline __attribute__((always_inline)) void scale_blocks(
    const RowScaling& s, int row, int first, int count, const Mat3d* blocks) {
    for (int p = 0; p < count; ++p)
        scale_block(s.scale[row],
                    blocks[p],
                    s.scale[s.col[p]],
                    s.lower + 9 * at(first + p),
                    s.upper + 9 * at(s.upper_place[first + p]));
}

#if defined(__x86_64__)
__attribute__((target("avx2"), flatten)) double backward_rows_avx2(
    const detail::SweepArrays& s, double alpha, double beta, int begin, int end) {
    return backward_rows(s, alpha, beta, begin, end);
}
__attribute__((target("avx2"), flatten)) void forward_rows_avx2(
    const detail::SweepArrays& s, int begin, int end, detail::SweepSums& out) {
    forward_rows(s, begin, end, out);
}
__attribute__((target("avx2"), flatten)) void scale_blocks_avx2(
    const RowScaling& s, int row, int first, int count, const Mat3d* blocks) {
    scale_blocks(s, row, first, count, blocks);
}
bool has_avx2() {
    return lane_dispatch() != LaneDispatch::Width2;
}
#endif

}  // namespace

namespace detail {

double sweep_backward(
    const SweepArrays& s, double alpha, double beta, int begin, int end) {
#if defined(__x86_64__)
    if (has_avx2()) return backward_rows_avx2(s, alpha, beta, begin, end);
#endif
    return backward_rows(s, alpha, beta, begin, end);
}

void sweep_forward(const SweepArrays& s, int begin, int end, SweepSums& sums) {
#if defined(__x86_64__)
    if (has_avx2()) return forward_rows_avx2(s, begin, end, sums);
#endif
    forward_rows(s, begin, end, sums);
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
    constexpr std::size_t kPadding = 1;  // loads of four reach one past the last block
    lower_.resize(9 * op_.num_off_diagonal() + kPadding);
    upper_.resize(9 * op_.num_off_diagonal() + kPadding);
    scale_.resize(n);
    for (std::vector<double>* v : {&x_, &r_, &p_, &t_, &w_})
        v->resize(4 * n);
    sums_.assign(at(op_.num_groups()), {});
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
    const RowScaling scaling{scale_.data(),
                             lower.col.data() + begin,
                             op_.upper_place.data(),
                             lower_.data(),
                             upper_.data()};
#if defined(__x86_64__)
    if (has_avx2())
        return scale_blocks_avx2(scaling, row, begin - row, count - 1, blocks.data());
#endif
    scale_blocks(scaling, row, begin - row, count - 1, blocks.data());
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

detail::SweepArrays GaussSeidelCg::arrays() {
    return {detail::const_view(op_.lower().row_begin),
            detail::const_view(op_.lower().col),
            detail::const_view(op_.upper_begin),
            detail::const_view(op_.upper_col),
            lower_.data(),
            upper_.data(),
            x_.data(),
            r_.data(),
            p_.data(),
            t_.data(),
            w_.data()};
}

void GaussSeidelCg::backward(int group, double alpha, double beta) {
    const std::vector<int>& begin = op_.rows().group_begin;
    sums_[at(group)].rr = detail::sweep_backward(
        arrays(), alpha, beta, begin[at(group)], begin[at(group) + 1]);
}

void GaussSeidelCg::forward(int group) {
    const std::vector<int>& begin = op_.rows().group_begin;
    detail::sweep_forward(
        arrays(), begin[at(group)], begin[at(group) + 1], sums_[at(group)]);
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
