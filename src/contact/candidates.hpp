// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the broad phase (broad_phase.hpp) finds for a collision mesh.

#include "contact/collision_mesh.hpp"

namespace noli {

/// Pairs of primitives that may get close, each list ascending.
template <class Exec>
struct Candidates {
    template <class T>
    using Buffer = typename Exec::template Buffer<T>;

    Buffer<Int2> vertex_triangle;  ///< vertex id, triangle index
    Buffer<Int2> edge_edge;        ///< edge indices, first < second
    Buffer<Int2> vertex_wall;      ///< vertex id, wall index

    [[nodiscard]] int size() const {
        return vertex_triangle.size() + edge_edge.size() + vertex_wall.size();
    }
};

}  // namespace noli
