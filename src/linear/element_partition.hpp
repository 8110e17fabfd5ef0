// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Elements in blocks that can add to a matrix in parallel without atomics.
///
/// Elements are cut into blocks of consecutive ones along a curve, and blocks are
/// coloured so that no two of a colour share a vertex. Colours run one after the other,
/// blocks of a colour in any order and at the same time, elements of a block in their
/// order: so every sum is added up in an order that the partition alone determines.

#include "core/vec.hpp"

#include <span>
#include <vector>

namespace noli {

struct ElementPartition {
    std::vector<int> element;       ///< all elements, block by block
    std::vector<int> block_begin;   ///< num_blocks + 1: first entry of `element`
    std::vector<int> block_range;   ///< per block: the range that it was cut from
    std::vector<int> colour_begin;  ///< num_colours + 1: first block of each colour

    [[nodiscard]] int num_blocks() const { return static_cast<int>(block_range.size()); }
    [[nodiscard]] int num_colours() const {
        return static_cast<int>(colour_begin.size()) - 1;
    }
};

/// Cuts each range of elements into blocks of `size` (the last of a range may have fewer)
/// and colours them greedily, the least used colour first, so that colours are of about
/// the same size.
///
/// In:   num_vertices
///       elements      four different vertices each, in [0, num_vertices)
///       range_begin   num_ranges + 1, ascending from 0 to the number of elements; blocks
///                     never mix ranges
///       order         all elements along a curve: neighbours should be near, then few
///                     blocks touch each other, and few colours do
///       size          > 0
ElementPartition partition_elements(int num_vertices,
                                    std::span<const Int4> elements,
                                    std::span<const int> range_begin,
                                    std::span<const int> order,
                                    int size);

}  // namespace noli
