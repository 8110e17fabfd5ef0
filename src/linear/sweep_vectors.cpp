// SPDX-License-Identifier: Apache-2.0
#include "linear/sweep_vectors.hpp"

#include "core/index.hpp"
#include "linear/wide.hpp"

namespace noli {

namespace {

using detail::add_lanes;
using detail::apply_factor;
using detail::at;
using detail::Wide;
using detail::wide;

}  // namespace

void SweepVectors::resize() {
    const std::size_t n = 4 * at(op_.rows().num_rows());
    for (std::vector<double>* v : {&x_, &r_, &p_, &t_, &w_, &y_, &s_})
        v->resize(n);
    sums_.assign(at(op_.rows().num_groups()), {});
}

void SweepVectors::clear_row(int row, View<const Vec3d> b) {
    const std::size_t k = 4 * at(row);
    wide(&s_[k]) = apply_factor(op_.scale()[row], b[op_.vertex(row)]);
    for (std::vector<double>* v : {&x_, &r_, &p_, &t_, &w_, &y_})
        wide(&(*v)[k]) = Wide{};
}

void SweepVectors::take_start_of_row(int row) {
    const std::size_t k = 4 * at(row);
    wide(&x_[k]) = wide(&t_[k]);
    wide(&s_[k]) -= wide(&w_[k]);
    wide(&t_[k]) = wide(&w_[k]) = Wide{};
}

double SweepVectors::start_row(int row, const double* from) {
    const std::size_t k = 4 * at(row);
    const Wide r = wide(from + k);
    wide(&r_[k]) = r;
    wide(&w_[k]) = wide(&s_[k]) = Wide{};
    return add_lanes(r * r);
}

template <class F>
auto SweepVectors::with_arrays(int group, const F& f) {
    const ColouredOperator& rows = op_.rows();
    const int begin = rows.rows().group_begin[at(group)];
    const int end = rows.rows().group_begin[at(group) + 1];
    return op_.with_triangles([&]<class Number>(const Triangles<Number>& triangles) {
        const detail::SweepArrays<Number> arrays{
            detail::const_view(rows.lower().row_begin),
            detail::const_view(rows.lower().col),
            detail::const_view(rows.upper_begin),
            detail::const_view(rows.upper_col),
            triangles.lower.view().data,
            triangles.upper.view().data,
            x_.data(),
            r_.data(),
            p_.data(),
            t_.data(),
            w_.data(),
            y_.data(),
            s_.data()};
        return f(arrays, begin, end);
    });
}

void SweepVectors::backward_group(int group, double alpha, double beta) {
    sums_[at(group)].rr = with_arrays(group, [=](const auto& arrays, int begin, int end) {
        return detail::sweep_backward(arrays, alpha, beta, begin, end);
    });
}

void SweepVectors::forward_group(int group) {
    with_arrays(group, [&](const auto& arrays, int begin, int end) {
        detail::sweep_forward(arrays, begin, end, sums_[at(group)]);
    });
}

void SweepVectors::residual_group(int group, double alpha) {
    sums_[at(group)].rr = with_arrays(group, [=](const auto& arrays, int begin, int end) {
        return detail::sweep_residual(arrays, alpha, begin, end);
    });
}

void SweepVectors::split_group(int group) {
    with_arrays(group, [&](const auto& arrays, int begin, int end) {
        detail::sweep_split(arrays, begin, end, sums_[at(group)]);
    });
}

void SweepVectors::multiply_group(int group) {
    with_arrays(group, [&](const auto& arrays, int begin, int end) {
        detail::multiply_rows(arrays, begin, end, sums_[at(group)]);
    });
}

void SweepVectors::factor_forward_group(int group, double alpha) {
    const int end = op_.rows().rows().group_begin[at(group) + 1];
    for (int i = op_.rows().rows().group_begin[at(group)]; i < end; ++i) {
        const std::size_t k = 4 * at(i);
        wide(&x_[k]) += alpha * wide(&t_[k]);
        wide(&r_[k]) -= alpha * wide(&w_[k]);
    }
    factor_.forward(op_.rows(), group, r_.data(), y_.data());
}

void SweepVectors::factor_backward_group(int group) {
    sums_[at(group)].rr = factor_.backward(op_.rows(), group, r_.data(), y_.data());
}

void SweepVectors::renew_rows(double beta, int begin, int end) {
    for (std::size_t k = 4 * at(begin); k < 4 * at(end); k += 4)
        wide(&t_[k]) = wide(&y_[k]) + beta * wide(&t_[k]);
}

detail::SweepSums SweepVectors::total() const {
    detail::SweepSums total;
    for (const detail::SweepSums& s : sums_) {
        total.rr += s.rr;
        total.pq += s.pq;
        total.rq += s.rq;
        total.qq += s.qq;
        total.rp += s.rp;
    }
    return total;
}

Vec3d SweepVectors::result(int row, double alpha) const {
    const Wide x = wide(&x_[4 * at(row)]) + alpha * wide(&t_[4 * at(row)]);
    const InverseFactor& f = op_.scale()[row];
    return {f.c0[0] * x[0] + f.c0[1] * x[1] + f.c0[2] * x[2],
            f.c1[1] * x[1] + f.c1[2] * x[2],
            f.c2[2] * x[2]};
}

}  // namespace noli
