// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Block Jacobi: the inverse of every accumulated 3x3 diagonal block. Kept in double,
/// because the block of a vertex in stiff contact spans more magnitudes than a float
/// inverse can hold.

#include "linear/block_matrix.hpp"
#include "linear/low_rank.hpp"

#include <cmath>
#include <cstdint>

namespace noli {

/// Symmetric 3x3 matrix by its upper triangle.
struct SymMat3d {
    double xx, xy, xz, yy, yz, zz;
};

NOLI_HD inline Vec3d operator*(const SymMat3d& m, const Vec3d& v) {
    return {m.xx * v.x + m.xy * v.y + m.xz * v.z,
            m.xy * v.x + m.yy * v.y + m.yz * v.z,
            m.xz * v.x + m.yz * v.y + m.zz * v.z};
}

/// Inverse of a symmetric 3x3 block through L D Lᵀ, always positive semi-definite.
///
/// In:     m  (3,3) symmetric; only the upper triangle is read
/// Valid:  for any m. Pivots below 1e-14 of the largest diagonal entry are raised to it,
/// so a
///         singular or slightly indefinite block gives a large finite inverse; a block
///         without a positive diagonal entry gives 0 (such an unknown cannot move).
NOLI_HD inline SymMat3d robust_inverse(const Mat3d& m) {
    const double largest = std::fmax(m.a[0], std::fmax(m.a[4], m.a[8]));
    if (largest <= 0.0) return {0, 0, 0, 0, 0, 0};
    const double floor = 1e-14 * largest;

    const double d0 = std::fmax(m.a[0], floor);
    const double l10 = m.a[1] / d0;
    const double l20 = m.a[2] / d0;
    const double d1 = std::fmax(m.a[4] - l10 * m.a[1], floor);
    const double l21 = (m.a[5] - l10 * m.a[2]) / d1;
    const double d2 = std::fmax(m.a[8] - l20 * m.a[2] - l21 * l21 * d1, floor);

    // Rows of the inverse of L: (1 0 0), (-l10 1 0), (k20 -l21 1).
    const double k20 = l10 * l21 - l20;
    const double i0 = 1.0 / d0;
    const double i1 = 1.0 / d1;
    const double i2 = 1.0 / d2;
    return {i0 + i1 * l10 * l10 + i2 * k20 * k20,
            -i1 * l10 - i2 * k20 * l21,
            i2 * k20,
            i1 + i2 * l21 * l21,
            -i2 * l21,
            i2};
}

namespace detail {

template <class Exec>
void invert_blocks(Exec& exec,
                   View<const Mat3d> blocks,
                   View<const std::uint8_t> fixed,
                   View<SymMat3d> inverse) {
    exec.for_each("linear/invert_blocks", blocks.size, [=] NOLI_HD(int i) {
        inverse[i] =
            fixed[i] != 0 ? SymMat3d{0, 0, 0, 0, 0, 0} : robust_inverse(blocks[i]);
    });
}

}  // namespace detail

/// z = P⁻¹ r with P = the diagonal blocks of matrix + terms; z = 0 at fixed vertices.
template <class Exec>
class BlockJacobi {
  public:
    /// In:   fixed  (num_rows): non-zero where the unknown is held at 0
    void build(Exec& exec,
               const BlockMatrix<Exec>& matrix,
               const LowRankTerms<Exec>& terms,
               View<const std::uint8_t> fixed) {
        blocks_.resize(matrix.num_rows());
        inverse_.resize(matrix.num_rows());
        matrix.diagonal_blocks(exec, blocks_.view());
        terms.add_diagonal(exec, blocks_.view());
        detail::invert_blocks(
            exec, View<const Mat3d>(blocks_.view()), fixed, inverse_.view());
    }

    [[nodiscard]] View<const SymMat3d> inverse() const { return inverse_.view(); }

  private:
    typename Exec::template Buffer<Mat3d> blocks_;
    typename Exec::template Buffer<SymMat3d> inverse_;
};

}  // namespace noli
