// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Which vertices move together on the coarse levels of a device's preconditioner. Made
/// once per scene, on the host.

#include "linear/rigid_aggregates.hpp"

#include <vector>

namespace noli {

/// One level: sets of vertices ("nodes"), in blocks that are solved exactly.
struct RigidLevel {
    std::vector<int> node_of_vertex;  ///< -1: none
    std::vector<int> member_begin;    ///< num_nodes + 1
    std::vector<int> members;         ///< vertices by node, ascending
    int nodes_per_block = 0;

    [[nodiscard]] int num_nodes() const {
        return static_cast<int>(member_begin.size()) - 1;
    }
    [[nodiscard]] int num_blocks() const {
        return (num_nodes() + nodes_per_block - 1) / nodes_per_block;
    }
};

/// At most two levels. The last one is a single block; the first, if there are two, has
/// one node per aggregate, and `group` consecutive ones make a node of the last.
struct RigidLevels {
    std::vector<RigidLevel> levels;  ///< empty without aggregates
    int group = 1;
};

/// The dense inverse of a level takes time with the cube of its nodes, so there may be
/// only so many.
inline constexpr int kMostDenseNodes = 128;
inline constexpr int kDeviceAggregate = 32;  ///< vertices of an aggregate, about
inline constexpr int kNodesPerBlock = 16;  ///< of a level in several blocks: 96 unknowns

RigidLevels make_rigid_levels(const RigidAggregates& aggregates,
                              int most_dense_nodes = kMostDenseNodes);

}  // namespace noli
