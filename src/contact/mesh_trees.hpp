// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The trees over the vertices, edges and triangles of a collision mesh, and the search
/// of all pairs that may get close. Which ones they are does not depend on the trees, see
/// broad_phase.hpp.

#include "contact/bvh.hpp"
#include "contact/candidates.hpp"
#include "contact/collision_mesh.hpp"
#include "contact/far_search.hpp"
#include "contact/moving_box.hpp"
#include "contact/pool_query.hpp"
#include "contact/tree_search.hpp"
#include "contact/vertex_boxes.hpp"

#include <tuple>

namespace noli {

namespace detail {

/// pairs[i][0] = ids[pairs[i][0]]
template <class Exec>
void name_first(Exec& exec, View<const int> ids, View<Int2> pairs) {
    exec.for_each("contact/name_first", pairs.size, [=] NOLI_HD(int i) {
        pairs[i][0] = ids[pairs[i][0]];
    });
}

}  // namespace detail

template <class Exec>
class MeshTrees {
  public:
    /// Sorts the primitives anew at the next search.
    void sort_at_next_search() { sorted_ = false; }

    /// The same at once, by positions x.
    void sort(Exec& exec, const CollisionMeshView& m, View<const Vec3d> x) {
        const MortonGrid grid = detail::grid_around(exec, m.vertices, x);
        vertices_.sort(exec, m.vertices, grid, x);
        triangles_.sort(exec, m.triangles, grid, x);
        edges_.sort(exec, m.edges, grid, x);
        sorted_ = true;
    }

    /// All pairs that may get closer than gap, from the trees.
    template <class Box>
    void search(Exec& exec,
                const CollisionMeshView& m,
                const Motion& motion,
                double gap,
                Candidates<Exec>& out) {
        if (!sorted_) sort(exec, m, motion.x);
        Boxes<Box>& trees = std::get<Boxes<Box>>(boxes_);
        refit(exec, m, motion, gap, trees);
        const auto edges = trees.edges.view(edges_);
        const auto near_triangles =
            detail::tree_search(exec,
                                trees.vertices.view(vertices_),
                                trees.triangles.view(triangles_),
                                detail::VertexTriangleTest{m, motion, gap});
        const auto near_edges =
            detail::tree_search(exec, edges, edges, detail::EdgeEdgeTest{m, motion, gap});
        vertex_triangle_pairs_.start(exec, near_triangles, out.vertex_triangle.size());
        edge_edge_pairs_.start(exec, near_edges, out.edge_edge.size());
        vertex_triangle_pairs_.finish(exec, near_triangles, out.vertex_triangle);
        detail::name_first(exec, m.vertices, out.vertex_triangle.view());
        edge_edge_pairs_.finish(exec, near_edges, out.edge_edge);
    }

    /// Starts to look for all pairs of a pool's query with a primitive that goes farther
    /// than the pool's margin. The last search of standing boxes was the pool's, with gap
    /// `pool_gap` (m).
    template <class Box>
    void start_far(Exec& exec, const detail::PoolQuery& query, double pool_gap) {
        Boxes<StaticBox>& trees = std::get<Boxes<StaticBox>>(boxes_);
        const auto grow = [&](auto& boxes, const auto& order, double gap) {
            detail::grow_far_boxes(exec, order.ids(), query, gap, boxes.leaves());
            boxes.merge_levels(exec);
        };
        grow(trees.vertices, vertices_, pool_gap);
        grow(trees.triangles, triangles_, 0.0);
        grow(trees.edges, edges_, 0.5 * pool_gap);
        vertex_triangle_pairs_.start(exec, far_triangles<Box>(query, pool_gap), 0);
        edge_edge_pairs_.start(exec, far_edges<Box>(query, pool_gap), 0);
    }

    /// out = those pairs, as `search` lists them. Waits.
    template <class Box>
    void finish_far(Exec& exec,
                    const detail::PoolQuery& query,
                    double pool_gap,
                    Candidates<Exec>& out) {
        vertex_triangle_pairs_.finish(
            exec, far_triangles<Box>(query, pool_gap), out.vertex_triangle);
        detail::name_first(exec, query.mesh.vertices, out.vertex_triangle.view());
        edge_edge_pairs_.finish(exec, far_edges<Box>(query, pool_gap), out.edge_edge);
    }

  private:
    template <class T>
    using Buffer = typename Exec::template Buffer<T>;

    /// Of one kind: moving points have a box at the start and one at the end.
    template <class Box>
    struct Boxes {
        BvhBoxes<Exec, Box, int> vertices;
        BvhBoxes<Exec, Box, Int3> triangles;
        BvhBoxes<Exec, Box, Int2> edges;
        Buffer<Box> corners, grown;  ///< of the vertices, as they are and grown
    };

    /// New boxes. Most vertices belong to several edges and triangles, so theirs are
    /// computed once.
    template <class Box>
    void refit(Exec& exec,
               const CollisionMeshView& m,
               const Motion& motion,
               double gap,
               Boxes<Box>& trees) {
        trees.corners.resize(motion.x.size);
        trees.grown.resize(motion.x.size);
        // Both edges of a pair grow by half of the gap: the tree is searched with itself.
        detail::vertex_boxes(exec,
                             m.vertices,
                             motion,
                             0.5 * gap,
                             trees.corners.view(),
                             trees.grown.view());
        trees.vertices.refit(exec, vertices_, detail::MotionBoxes<Box>{motion, gap});
        trees.triangles.refit(
            exec, triangles_, detail::KnownBoxes<Box>{trees.corners.view()});
        trees.edges.refit(exec, edges_, detail::KnownBoxes<Box>{trees.grown.view()});
    }

    template <class Box>
    detail::FarVertexTriangle<Exec::kIsDevice, Box> far_triangles(
        const detail::PoolQuery& query, double pool_gap) const {
        const auto& trees = std::get<Boxes<StaticBox>>(boxes_);
        return {trees.vertices.view(vertices_),
                trees.triangles.view(triangles_),
                {query},
                pool_gap};
    }
    template <class Box>
    detail::FarEdgeEdge<Exec::kIsDevice, Box> far_edges(const detail::PoolQuery& query,
                                                        double pool_gap) const {
        const auto& trees = std::get<Boxes<StaticBox>>(boxes_);
        return {trees.edges.view(edges_), {query}, 0.5 * pool_gap};
    }

    BvhOrder<Exec, int> vertices_;
    BvhOrder<Exec, Int3> triangles_;
    BvhOrder<Exec, Int2> edges_;
    std::tuple<Boxes<StaticBox>, Boxes<MovingBox>> boxes_;
    detail::TreePairs<Exec> vertex_triangle_pairs_, edge_edge_pairs_;
    bool sorted_ = false;
};

}  // namespace noli
