// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Vertices that get close to half-spaces. There are few planes, so every vertex looks at
/// all of them.

#include "contact/collision_mesh.hpp"
#include "contact/moving_box.hpp"
#include "contact/tree_search.hpp"
#include "exec/later.hpp"

namespace noli::detail {

/// True if the vertex gets closer to the plane than gap, or behind it, at some time.
NOLI_HD inline bool plane_in_reach(const Motion& motion,
                                   const CollisionMesh::Plane& plane,
                                   int vertex,
                                   double gap) {
    if (plane_distance(plane, motion.x[vertex]) < gap) return true;
    return motion.p.size > 0 && plane_distance(plane, motion.end(vertex)) < gap;
}

/// Planes near vertex number i of the surface, ascending.
struct VertexPlaneSearch {
    CollisionMeshView mesh;
    Motion motion;
    double gap;

    NOLI_HD void operator()(int i, PairSlots& found) const {
        const int vertex = mesh.vertices[i];
        if (mesh.kinematic[vertex]) return;
        for (int k = 0; k < mesh.planes.size; ++k)
            if (mesh.plane_collides(k, vertex)
                && plane_in_reach(motion, mesh.planes[k], vertex, gap))
                found.add(vertex, k);
    }
};

/// counts[i] = planes near surface vertex i.
template <class Exec>
void count_planes(Exec& exec, VertexPlaneSearch search, View<int> counts) {
    exec.for_each("contact/count_planes", counts.size, [=] NOLI_HD(int i) {
        PairSlots found{nullptr, 0, 0};
        search(i, found);
        counts[i] = found.count;
    });
}

template <class Exec>
void write_planes(Exec& exec,
                  VertexPlaneSearch search,
                  View<const int> offsets,
                  View<Int2> out) {
    exec.for_each("contact/write_planes", offsets.size - 1, [=] NOLI_HD(int i) {
        PairSlots found{out.data + offsets[i], offsets[i + 1] - offsets[i], 0};
        if (found.capacity > 0) search(i, found);
    });
}

/// Collects what a search finds, and keeps its buffers between searches.
template <class Exec>
class PlanePairs {
  public:
    /// Counts the pairs.
    void start(Exec& exec, const VertexPlaneSearch& search) {
        const int n = search.mesh.planes.size > 0 ? search.mesh.vertices.size : 0;
        counts_.resize(n);
        offsets_.resize(n + 1);
        count_planes(exec, search, counts_.view());
        total_ = exec.scan_later(
            "contact/scan_planes", View<const int>(counts_.view()), offsets_.view());
    }

    /// Writes them; with the arguments of `start`.
    void finish(Exec& exec,
                const VertexPlaneSearch& search,
                typename Exec::template Buffer<Int2>& out) {
        out.resize(static_cast<int>(exec.value(total_)));
        write_planes(exec, search, View<const int>(offsets_.view()), out.view());
    }

  private:
    typename Exec::template Buffer<int> counts_, offsets_;
    Later total_;
};

}  // namespace noli::detail
