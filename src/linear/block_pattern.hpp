// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Which 3x3 blocks of the elastic operator can be non-zero, and where each of them comes
/// from. Built once per scene: tetrahedra never change their vertices.
///
/// Assembly is a gather: every block of the upper triangle knows the element blocks that
/// add up to it, in ascending order of the element, so the sum does not depend on who
/// computes it.

#include "core/vec.hpp"

#include <span>
#include <vector>

namespace noli {

inline constexpr int kBlocksPerElement = 10;   ///< upper triangle of 4x4 blocks
inline constexpr int kDoublesPerElement = 90;  ///< 10 row-major 3x3 blocks

/// One element block that adds to an upper block of the matrix, packed into an int:
/// element * 32 + slot * 2 + transposed. Slots count the upper triangle of the element's
/// 4x4 blocks by rows: (0,0) (0,1) (0,2) (0,3) (1,1) (1,2) (1,3) (2,2) (2,3) (3,3).
struct Contribution {
    int element;
    int slot;         ///< 0..9
    bool transposed;  ///< the element has the block's two vertices in the opposite order

    [[nodiscard]] NOLI_HD int packed() const {
        return element * 32 + slot * 2 + (transposed ? 1 : 0);
    }
    NOLI_HD static Contribution unpack(int packed) {
        return {packed >> 5, (packed >> 1) & 15, (packed & 1) != 0};
    }
};

/// Block-sparse symmetric pattern, both triangles stored by rows.
struct BlockPattern {
    int num_rows = 0;
    std::vector<int> row_begin;  ///< num_rows + 1: first block of each row
    std::vector<int> col;  ///< block columns, ascending in each row, diagonal included
    std::vector<int> diagonal;  ///< num_rows: block index of each row's diagonal block

    std::vector<int> upper;  ///< block index of upper block u (col >= row), by rows
    std::vector<int> lower;  ///< block index of its transpose; the same on the diagonal
    std::vector<int>
        gather_begin;         ///< num_upper + 1: first contribution of upper block u
    std::vector<int> gather;  ///< packed contributions, ascending element in each block

    [[nodiscard]] int num_blocks() const { return static_cast<int>(col.size()); }
    [[nodiscard]] int num_upper() const { return static_cast<int>(upper.size()); }
};

/// Pattern of a tetrahedral mesh. Every vertex has a diagonal block, also without
/// elements.
///
/// In:   num_vertices  number of block rows
///       elements      four different vertices each, in [0, num_vertices)
BlockPattern build_block_pattern(int num_vertices, std::span<const Int4> elements);

/// Pattern with the given coupled pairs of rows (any order, repeats allowed) and empty
/// gather lists: for matrices whose values are set directly, see BlockMatrix::set_upper.
BlockPattern build_block_pattern(int num_rows, std::span<const Int2> couplings);

}  // namespace noli
