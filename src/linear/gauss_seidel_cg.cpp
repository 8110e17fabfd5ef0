// SPDX-License-Identifier: Apache-2.0
#include "linear/gauss_seidel_cg.hpp"

#include "linear/wide.hpp"

#include <cmath>

namespace noli {

namespace {

using detail::add_lanes;
using detail::apply_factor;
using detail::wide;
using Double4 = detail::Wide;

std::size_t at(int i) {
    return static_cast<std::size_t>(i);
}

}  // namespace

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
    const detail::RowScaling<Number> scaling{scale_.data(),
                                             lower.col.data() + begin,
                                             op_.upper_place.data(),
                                             to.lower.data(),
                                             to.upper.data()};
    detail::scale_blocks(scaling, row, begin - row, count, blocks);
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
