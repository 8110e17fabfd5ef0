// SPDX-License-Identifier: Apache-2.0
#include "linear/rigid_levels.hpp"

#include "core/index.hpp"

#include <cstddef>

namespace noli {

namespace {

using detail::at;

/// Nodes of `group` consecutive aggregates each.
RigidLevel make_level(const RigidAggregates& aggregates, int group) {
    RigidLevel level;
    const int num_nodes = (aggregates.count + group - 1) / group;
    level.member_begin.assign(at(num_nodes) + 1, 0);
    for (const int a : aggregates.of_vertex) {
        const int node = a < 0 ? -1 : a / group;
        level.node_of_vertex.push_back(node);
        if (node >= 0) ++level.member_begin[at(node) + 1];
    }
    for (int k = 0; k < num_nodes; ++k)
        level.member_begin[at(k) + 1] += level.member_begin[at(k)];
    level.members.resize(at(level.member_begin.back()));
    std::vector<int> next(level.member_begin.begin(), level.member_begin.end() - 1);
    for (std::size_t v = 0; v < level.node_of_vertex.size(); ++v) {
        const int node = level.node_of_vertex[v];
        if (node >= 0) level.members[at(next[at(node)]++)] = static_cast<int>(v);
    }
    return level;
}

}  // namespace

RigidLevels make_rigid_levels(const RigidAggregates& aggregates, int most_dense_nodes) {
    RigidLevels out;
    if (aggregates.empty()) return out;
    out.group = (aggregates.count + most_dense_nodes - 1) / most_dense_nodes;
    if (out.group > 1) {
        out.levels.push_back(make_level(aggregates, 1));
        out.levels.back().nodes_per_block = kNodesPerBlock;
    }
    out.levels.push_back(make_level(aggregates, out.group));
    out.levels.back().nodes_per_block = out.levels.back().num_nodes();
    return out;
}

}  // namespace noli
