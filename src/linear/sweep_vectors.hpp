// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The vectors of CG on scaled rows (sweep_cg.hpp) and the loops over them: colour after
/// colour, the groups of a colour in parallel. CPU only.
///
/// All are in row order, four numbers per row of which the last stays 0:
///
///     x  the solution (scaled)        t  (I + L'ᵀ)⁻¹ p, the direction of x
///     r  the residual                 w  what makes q = t + w, the product
///     p  the direction                y  (I + L'ᵀ)⁻¹ r, or the factor's solution
///     s  the right-hand side, then p - t where there is a coarse space

#include "linear/coarse_space.hpp"
#include "linear/incomplete_cholesky.hpp"
#include "linear/scaled_operator.hpp"
#include "linear/sweeps.hpp"

#include <algorithm>
#include <vector>

namespace noli {

class SweepVectors {
  public:
    /// Both must outlive it.
    SweepVectors(const ScaledOperator& op, const IncompleteCholesky& factor)
        : op_(op), factor_(factor) {}

    /// To the rows of the operator.
    void resize();

    /// s = C⁻¹ b, all others 0.
    template <class Exec>
    void clear(Exec& exec, View<const Vec3d> b) {
        op_.rows().for_rows(exec, [this, b](int i) { clear_row(i, b); });
    }

    /// x = t, s -= w; t = w = 0.
    template <class Exec>
    void take_start(Exec& exec) {
        op_.rows().for_rows(exec, [this](int i) { take_start_of_row(i); });
    }

    /// r = w and w = s = 0; returns r.r.
    template <class Exec>
    double start_with_w(Exec& exec) {
        return start_with(exec, w_);
    }
    /// r = s and w = s = 0; returns r.r.
    template <class Exec>
    double start_with_s(Exec& exec) {
        return start_with(exec, s_);
    }

    /// x += alpha t, r -= alpha (t + w), p = r + beta p, t = p - L'ᵀ t. Sums r.r.
    template <class Exec>
    void backward(Exec& exec, double alpha, double beta) {
        for_colours_back(exec,
                         [this, alpha, beta](int g) { backward_group(g, alpha, beta); });
    }
    /// w = p - t - L' w. Sums all but r.r.
    template <class Exec>
    void forward(Exec& exec) {
        for_colours(exec, [this](int g) { forward_group(g); });
    }
    /// x += alpha t, r -= alpha (t + w), y = r - L'ᵀ y. Sums r.r.
    template <class Exec>
    void residual(Exec& exec, double alpha) {
        for_colours_back(exec, [this, alpha](int g) { residual_group(g, alpha); });
    }
    /// w = s - L' w. Sums all but r.r.
    template <class Exec>
    void split(Exec& exec) {
        for_colours(exec, [this](int g) { split_group(g); });
    }
    /// w = A' t. Sums p.q and r.p with t for p.
    template <class Exec>
    void multiply(Exec& exec) {
        exec.for_each(
            "linear/sweep_multiply",
            op_.rows().num_groups(),
            [this](int g) { multiply_group(g); },
            1);
    }
    /// x += alpha t, r -= alpha w, y = F⁻¹ r.
    template <class Exec>
    void factor_forward(Exec& exec, double alpha) {
        for_colours(exec, [this, alpha](int g) { factor_forward_group(g, alpha); });
    }
    /// y = F⁻ᵀ y. Sums r.y as r.r.
    template <class Exec>
    void factor_backward(Exec& exec) {
        for_colours_back(exec, [this](int g) { factor_backward_group(g); });
    }

    /// t = y + beta t
    template <class Exec>
    void renew(Exec& exec, double beta) {
        for_parts(exec,
                  [this, beta](int begin, int end) { renew_rows(beta, begin, end); });
    }
    /// t = y + Z' c + beta t
    template <class Exec>
    void renew(Exec& exec, const CoarseSpace& coarse, double beta) {
        for_parts(exec, [this, &coarse, beta](int begin, int end) {
            coarse.renew(y_.data(), beta, begin, end, t_.data());
        });
    }
    /// The same, and s = r - y + H c + beta s.
    template <class Exec>
    void renew_split(Exec& exec, const CoarseSpace& coarse, double beta) {
        for_parts(exec, [this, &coarse, beta](int begin, int end) {
            coarse.renew_split(
                r_.data(), y_.data(), beta, begin, end, t_.data(), s_.data());
        });
    }

    /// out = C⁻ᵀ (x + alpha t) at the vertices of the rows, 0 at all others.
    template <class Exec>
    void finish(Exec& exec, double alpha, View<Vec3d> out) const {
        exec.for_each("linear/sweep_clear", out.size, [out](int v) {
            out[v] = {0, 0, 0};
        });
        op_.rows().for_rows(
            exec, [this, alpha, out](int i) { out[op_.vertex(i)] = result(i, alpha); });
    }

    /// Sums of the last loop, groups added in a fixed order.
    [[nodiscard]] detail::SweepSums total() const;

    [[nodiscard]] const double* r() const { return r_.data(); }
    [[nodiscard]] const double* y() const { return y_.data(); }
    [[nodiscard]] const double* s() const { return s_.data(); }

  private:
    template <class Exec>
    double start_with(Exec& exec, const std::vector<double>& from) {
        return exec.sum("linear/sweep_start",
                        op_.rows().num_rows(),
                        [this, &from](int i) { return start_row(i, from.data()); });
    }

    template <class Exec, class F>
    void for_colours(Exec& exec, const F& f) const {
        exec.for_stages(
            "linear/coloured_groups", op_.rows().groups_of_colours(), false, f);
    }
    template <class Exec, class F>
    void for_colours_back(Exec& exec, const F& f) const {
        exec.for_stages(
            "linear/coloured_groups_back", op_.rows().groups_of_colours(), true, f);
    }
    template <class Exec, class F>
    void for_parts(Exec& exec, const F& f) const {
        constexpr int kRows = 128;
        const int n = op_.rows().num_rows();
        exec.for_each(
            "linear/sweep_direction",
            (n + kRows - 1) / kRows,
            [&f, n](int part) { f(part * kRows, std::min(n, (part + 1) * kRows)); },
            1);
    }

    void clear_row(int row, View<const Vec3d> b);
    void take_start_of_row(int row);
    double start_row(int row, const double* from);
    void backward_group(int group, double alpha, double beta);
    void forward_group(int group);
    void residual_group(int group, double alpha);
    void split_group(int group);
    void multiply_group(int group);
    void factor_forward_group(int group, double alpha);
    void factor_backward_group(int group);
    void renew_rows(double beta, int begin, int end);
    [[nodiscard]] Vec3d result(int row, double alpha) const;
    /// f(arrays, first row, end row) of a group.
    template <class F>
    auto with_arrays(int group, const F& f);

    const ScaledOperator& op_;
    const IncompleteCholesky& factor_;
    std::vector<double> x_, r_, p_, t_, w_, y_, s_;
    std::vector<detail::SweepSums> sums_;  ///< per group
};

}  // namespace noli
