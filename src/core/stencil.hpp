// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What pair and element kernels exchange: the points of a stencil, a gradient on them,
/// and a positive semi-definite Hessian written as a short sum of outer products.

#include "core/vec.hpp"

namespace noli {

/// S points of a pair or element.
template <int S>
struct Stencil {
    Vec3d x[S];
};

/// Gradient with respect to the S points, 3 S numbers.
template <int S>
struct StencilGradient {
    Vec3d g[S];
};

/// H = sum_k q_k q_k^T with at most R modes q_k in R^{3S}; modes at rank..R-1 are zero.
template <int S, int R>
struct StencilModes {
    int rank;
    Vec3d q[R][S];
};

}  // namespace noli
