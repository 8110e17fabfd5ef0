// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Vertices that get close to half-spaces. There are few walls, so every vertex looks at
/// all of them.

#include "contact/collision_mesh.hpp"
#include "contact/moving_box.hpp"
#include "contact/tree_search.hpp"
#include "exec/later.hpp"

namespace noli::detail {

/// True if the vertex gets closer to the wall than gap, or behind it, at some time. Its
/// distance is a concave function of time: the least is at an end.
NOLI_HD inline bool wall_in_reach(const Motion& motion,
                                  const Wall& wall,
                                  int vertex,
                                  double gap) {
    if (wall_distance(wall, motion.x[vertex]) < gap) return true;
    return motion.p.size > 0 && wall_distance(wall, motion.end(vertex)) < gap;
}

/// Walls near vertex number i of the surface, ascending.
struct VertexWallSearch {
    CollisionMeshView mesh;
    Motion motion;
    double gap;

    NOLI_HD void operator()(int i, PairSlots& found) const {
        const int vertex = mesh.vertices[i];
        if (mesh.kinematic[vertex]) return;
        for (int k = 0; k < mesh.walls.size; ++k)
            if (mesh.wall_collides(k, vertex)
                && wall_in_reach(motion, mesh.walls[k], vertex, gap))
                found.add(vertex, k);
    }
};

/// counts[i] = walls near surface vertex i.
template <class Exec>
void count_walls(Exec& exec, VertexWallSearch search, View<int> counts) {
    exec.for_each("contact/count_walls", counts.size, [=] NOLI_HD(int i) {
        PairSlots found{nullptr, 0, 0};
        search(i, found);
        counts[i] = found.count;
    });
}

template <class Exec>
void write_walls(Exec& exec,
                 VertexWallSearch search,
                 View<const int> offsets,
                 View<Int2> out) {
    exec.for_each("contact/write_walls", offsets.size - 1, [=] NOLI_HD(int i) {
        PairSlots found{out.data + offsets[i], offsets[i + 1] - offsets[i], 0};
        if (found.capacity > 0) search(i, found);
    });
}

/// Collects what a search finds, and keeps its buffers between searches.
template <class Exec>
class WallPairs {
  public:
    /// Counts the pairs.
    void start(Exec& exec, const VertexWallSearch& search) {
        const int n = search.mesh.walls.size > 0 ? search.mesh.vertices.size : 0;
        counts_.resize(n);
        offsets_.resize(n + 1);
        count_walls(exec, search, counts_.view());
        total_ = exec.scan_later(
            "contact/scan_walls", View<const int>(counts_.view()), offsets_.view());
    }

    /// Writes them; with the arguments of `start`.
    void finish(Exec& exec,
                const VertexWallSearch& search,
                typename Exec::template Buffer<Int2>& out) {
        out.resize(static_cast<int>(exec.value(total_)));
        write_walls(exec, search, View<const int>(offsets_.view()), out.view());
    }

  private:
    typename Exec::template Buffer<int> counts_, offsets_;
    Later total_;
};

}  // namespace noli::detail
