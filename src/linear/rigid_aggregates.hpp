// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Pieces of elastic bodies that move rigidly in the coarse space of the solver.

#include "core/vec.hpp"

#include <span>
#include <vector>

namespace noli {

/// Per vertex its aggregate, or -1 (no tetrahedron).
struct RigidAggregates {
    std::vector<int> of_vertex;
    int count = 0;

    [[nodiscard]] bool empty() const { return count == 0; }
};

/// Cuts every connected piece of the mesh into runs of about `size` vertices along a
/// Morton curve of the rest shape: `order` lists the vertices along it.
RigidAggregates cut_aggregates(std::span<const Int4> tets,
                               std::span<const int> order,
                               int size);

/// How large aggregates should be: small ones help more, many make a large coarse matrix.
int aggregate_size(int num_vertices);

}  // namespace noli
