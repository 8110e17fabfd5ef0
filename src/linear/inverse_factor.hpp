// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Inverses of Cholesky factors of 3x3 blocks, which scale the rows of an operator.

#include "core/vec.hpp"

namespace noli {

/// Inverse of the Cholesky factor of a 3x3 block, lower triangular, by columns padded to
/// four.
struct alignas(32) InverseFactor {
    double c0[4];  ///< (i00, i10, i20, 0)
    double c1[4];  ///< (0, i11, i21, 0)
    double c2[4];  ///< (0, 0, i22, 0)
};

/// In:   m  (3,3) symmetric
/// Out:  C⁻¹ with C Cᵀ = m; zero where m has no positive diagonal entry (an unknown that
///       cannot move). Pivots within rounding of 0 are raised; false when one is below
///       that or NaN.
bool invert_factor(const Mat3d& m, InverseFactor& out);

}  // namespace noli
