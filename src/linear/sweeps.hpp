// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The triangular sweeps and the product of sweep_cg.hpp over a range of rows, and the
/// scaling of the blocks that they read. Templates are instantiated for Number = double
/// and float in sweeps.cpp.

#include "core/vec.hpp"
#include "core/view.hpp"
#include "linear/inverse_factor.hpp"

#include <cmath>
#include <cstddef>

namespace noli {

namespace detail {

/// Vectors in row order, four doubles per row of which the last stays 0. `Number` is what
/// blocks are stored in, double or float; arithmetic is in double.
template <class Number>
struct SweepArrays {
    View<const int> lower_begin, lower_col;  ///< with diagonal entries, which are skipped
    View<const int> upper_begin, upper_col;  ///< the last row first
    const Number* lower;                     ///< L', column-major 3x3 blocks
    const Number* upper;                     ///< L'ᵀ, column-major 3x3 blocks
    double *x, *r, *p, *t, *w;
    double* y = nullptr;  ///< these two with a coarse space or a product only
    double* s = nullptr;
};

/// Dot products over the rows of one group.
struct SweepSums {
    double rr =
        0.0;  ///< r.r, from the backward sweep; the others are from the forward sweep
    double pq = 0.0, rp = 0.0, rq = 0.0, qq = 0.0;

    /// r.r after the step r -= alpha q.
    [[nodiscard]] double square_after(double alpha) const {
        return std::fmax(0.0, rr + alpha * (alpha * qq - 2.0 * rq));
    }
};

/// For rows end-1 down to begin: x += alpha t, r -= alpha (t + w), p = r + beta p and
/// t = p - L'ᵀ t. Returns r.r.
template <class Number>
double sweep_backward(
    const SweepArrays<Number>& s, double alpha, double beta, int begin, int end);

/// For rows end-1 down to begin: x += alpha t, r -= alpha (t + w) and y = r - L'ᵀ y.
/// Returns r.r.
template <class Number>
double sweep_residual(const SweepArrays<Number>& s, double alpha, int begin, int end);

/// w = s - L' w for rows begin to end-1. Sets the sums over q = t + w and p = s + t.
template <class Number>
void sweep_split(const SweepArrays<Number>& s, int begin, int end, SweepSums& sums);

/// w = t + L' t + L'ᵀ t for rows begin to end-1. Sets pq = t.w and rp = r.t.
template <class Number>
void multiply_rows(const SweepArrays<Number>& s, int begin, int end, SweepSums& sums);

/// w = p - t - L' w for rows begin to end-1. Sets the sums over q = t + w.
template <class Number>
void sweep_forward(const SweepArrays<Number>& s, int begin, int end, SweepSums& sums);

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
void scale_blocks(
    const RowScaling<Number>& s, int row, int first, int count, const Mat3d* blocks);

}  // namespace detail

}  // namespace noli
