// SPDX-License-Identifier: Apache-2.0
#pragma once
/// An order of the unknowns that a triangular sweep can run through in parallel. CPU
/// only.
///
/// Unknowns are cut into blocks of consecutive ones; blocks are coloured so that coupled
/// blocks differ; rows are sorted by colour. A sweep visits the colours one after the
/// other. Within a colour, up to four blocks form a group, the unit of parallel work,
/// and their rows are interleaved (first row of each block, then the second rows ...), so
/// that neighbouring rows do not wait for each other's result:
///
///     colour 0                                     colour 1
///     group 0            group 1                   group 2
///     a0 b0 c0 d0 a1 ..  e0 f0 g0 h0 e1 ..         ...
///
/// Rows that follow each other lie far apart in the mesh, because a colour takes blocks
/// from all over it. In a large system what a row reads of its neighbours has left the
/// caches until they are visited. There a group is a **region**: a few consecutive
/// blocks. Regions are coloured so that coupled ones differ, blocks so that coupled ones
/// of a region differ, and the rows of a region are sorted by the colours of its blocks,
/// those of one colour interleaved. A row then finds most of its neighbours in its
/// region.
///
/// Nothing depends on the number of threads.
///
/// Source: block multicolour ordering, [Iwashita2012]; the interleaving and the regions
/// are ours.

#include "linear/assemble.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace noli {

/// How unknowns are cut up.
struct RowCut {
    int rows_per_block;
    int blocks_per_region = 8;
    int region_rows = 10000;  ///< systems of as many rows and more are cut into regions
};

/// Rows in colour order and the groups of rows that run in parallel.
struct ColouredRows {
    Numbering numbering;
    std::vector<int> group_begin;   ///< num_groups + 1: first row of each group
    std::vector<int> colour_begin;  ///< num_colours + 1: first group of each colour
    std::vector<int> nearby;  ///< all rows, in the order that the blocks were cut in
};

/// The free vertices, in the given order of all vertices (empty: their own), cut into
/// blocks, and the blocks that the block matrix couples.
struct RowBlocksOfMatrix {
    Numbering free;
    RowCut cut;
    std::vector<int> begin;      ///< num_blocks + 1
    std::vector<int> neighbour;  ///< blocks before it that a block is coupled to

    [[nodiscard]] int num_rows() const { return static_cast<int>(free.vertex.size()); }
    [[nodiscard]] int num_blocks() const { return static_cast<int>(begin.size()) - 1; }
    [[nodiscard]] bool in_regions() const { return num_rows() >= cut.region_rows; }
    /// Of a vertex, or -1.
    [[nodiscard]] int block_of(int vertex) const {
        const int rank = free.rank[static_cast<std::size_t>(vertex)];
        return rank < 0 ? -1 : rank / cut.rows_per_block;
    }
};

RowBlocksOfMatrix cut_rows(const OperatorView& op,
                           View<const std::uint8_t> fixed,
                           std::span<const int> order,
                           const RowCut& cut);

/// Colours the blocks greedily, couplings by terms included.
ColouredRows colour_rows(const OperatorView& op, const RowBlocksOfMatrix& blocks);

}  // namespace noli
