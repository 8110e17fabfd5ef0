// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How the blocks of an ElementPartition add up to a BlockMatrix.
///
/// A block of elements touches few blocks of the matrix, several times each. It adds them
/// up in sums of its own, which stay in the first-level cache, and only then moves the
/// sums to the matrix:
///
///     elements of a block -> its sums -> upper triangle -> lower triangle
///
/// The first block of elements (in colour order) that touches a block of the matrix
/// stores its sum, the others add; the last one also writes the transposed block to the
/// lower triangle, and the diagonal. So no pass over the matrix precedes or follows.
///
/// A sum has nine numbers: the row-major block, or, on the diagonal, where element blocks
/// are symmetric, their six upper numbers (00 01 02 11 12 22) and a gradient. Eight of
/// them are the sum's head, the ninth its tail.
///
/// CPU only.

#include "linear/block_pattern.hpp"
#include "linear/element_partition.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace noli {

/// Elements that are computed together: the widest pack.
inline constexpr int kElementGroup = 8;

/// Where a sum goes.
struct SumTarget {
    int upper;  ///< block of the matrix
    int other;  ///< block of its transpose; on the diagonal the row
};

/// Kinds of sums, each a loop without branches. A kind is kAdds + kStays + kOffDiagonal.
namespace sum_kind {
inline constexpr int kAdds = 1;   ///< not the first to touch the target
inline constexpr int kStays = 2;  ///< not the last
inline constexpr int kOffDiagonal = 4;
inline constexpr int kCount = 8;
}  // namespace sum_kind

struct ElementSums {
    std::vector<int> group_begin;  ///< num_blocks + 1: first group of each block; groups
                                   ///< have kElementGroup elements, the last of a block
                                   ///< may have fewer
    std::vector<std::uint16_t> slot;  ///< kElementGroup * 10 per group: the sum, counted
                                      ///< in its block, that each of an element's upper
                                      ///< blocks adds to; see Contribution
    std::vector<int>
        kind_begin;  ///< num_blocks * 8 + 1: first target of each kind of each block
    std::vector<SumTarget> target;
    std::vector<int> untouched;  ///< rows without elements

    /// First sum of a block.
    [[nodiscard]] int sum_begin(int block) const {
        return kind_begin[static_cast<std::size_t>(block) * sum_kind::kCount];
    }
};

ElementSums build_element_sums(const ElementPartition& partition,
                               const BlockPattern& pattern);

}  // namespace noli
