// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Broad phase: every pair of primitives that may come close during a motion.
///
/// Candidates depend on mesh, positions and motion alone: not on the order of the trees,
/// hence not on when they were last sorted. A tree search finds pairs whose boxes
/// overlap; what it finds is tested along the line through the centres and the common
/// normal too (moving_box.hpp), and whether the motion is long enough to bring it close
/// (reach.hpp): that leaves out most neighbours on a smooth surface, and saves more time
/// downstream than it costs. Most queries need no tree search: see candidate_pool.hpp.
///
/// Source: MATH 9 (which pairs), moving_box.hpp and reach.hpp (which are far).

#include "contact/bvh.hpp"
#include "contact/candidate_pool.hpp"
#include "contact/collision_mesh.hpp"
#include "contact/moving_box.hpp"
#include "contact/pool_query.hpp"
#include "contact/tree_search.hpp"

#include <tuple>

namespace noli {

/// Pairs of primitives that may get close, each list ascending.
template <class Exec>
struct Candidates {
    template <class T>
    using Buffer = typename Exec::template Buffer<T>;

    Buffer<Int2> vertex_triangle;  ///< vertex id, triangle index
    Buffer<Int2> edge_edge;        ///< edge indices, first < second
    Buffer<Int2> vertex_plane;     ///< vertex id, plane index

    [[nodiscard]] int size() const {
        return vertex_triangle.size() + edge_edge.size() + vertex_plane.size();
    }
};

namespace detail {

/// pairs[i][0] = ids[pairs[i][0]]
template <class Exec>
void name_first(Exec& exec, View<const int> ids, View<Int2> pairs) {
    exec.for_each("contact/name_first", pairs.size, [=] NOLI_HD(int i) {
        pairs[i][0] = ids[pairs[i][0]];
    });
}

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

}  // namespace detail

/// The trees over a mesh, the pool and the buffers of the search, kept between queries.
template <class Exec>
class BroadPhase {
  public:
    /// Sorts the trees anew at the next search. Results never depend on when this was
    /// called, but searches slow down when much has moved since: once per time step is
    /// enough.
    void sort_at_next_search() { sorted_ = false; }

    /// The same at once, by positions x.
    void sort(Exec& exec, const CollisionMeshView& m, View<const Vec3d> x) {
        const MortonGrid grid = detail::grid_around(exec, m.vertices, x);
        vertices_.sort(exec, m.vertices, grid, x);
        triangles_.sort(exec, m.triangles, grid, x);
        edges_.sort(exec, m.edges, grid, x);
        sorted_ = true;
    }

    /// Call when the mesh has changed.
    void forget() {
        sorted_ = false;
        pooled_ = false;
        edge_length_ = -1.0;
    }

    /// See find_candidates.
    void find(Exec& exec,
              const DeviceCollisionMesh<Exec>& mesh,
              const Motion& motion,
              double gap,
              Candidates<Exec>& out) {
        const CollisionMeshView m = mesh.view();
        if (motion.p.size > 0)
            find_pairs_of<MovingBox>(exec, m, motion, gap, out);
        else
            find_pairs_of<StaticBox>(exec, m, motion, gap, out);
        find_planes(exec, m, motion, gap, out);
    }

  private:
    template <class Box>
    struct Trees {
        BvhBoxes<Exec, Box, int> vertices;
        BvhBoxes<Exec, Box, Int3> triangles;
        BvhBoxes<Exec, Box, Int2> edges;
    };

    template <class Box>
    void find_pairs_of(Exec& exec,
                       const CollisionMeshView& m,
                       const Motion& motion,
                       double gap,
                       Candidates<Exec>& out) {
        bool pooled = covers(exec, m, motion, gap);
        if (pooled) policy_.used();
        if (!pooled && renew_pool(exec, m, motion, gap))
            pooled = covers(exec, m, motion, gap);
        if (pooled)
            keep_close<Box>(exec, {m, motion, gap, reaches_.view()}, out);
        else
            search<Box>(exec,
                        m,
                        motion,
                        gap,
                        detail::VertexTriangleTest{m, motion, gap},
                        detail::EdgeEdgeTest{m, motion, gap},
                        out);
    }

    /// A pool for this motion and what comes after it, if that seems worth it.
    bool renew_pool(Exec& exec,
                    const CollisionMeshView& m,
                    const Motion& motion,
                    double gap) {
        if (pooled_) policy_.missed();
        pooled_ = false;
        if (edge_length_ < 0.0)
            edge_length_ = detail::mean_edge_length(exec, m.edge_rest_sq);
        const double travel = detail::largest_travel(exec, m.vertices, motion);
        const double margin = policy_.margin_for(travel, gap, edge_length_);
        if (!(margin > travel)) return false;
        fill_pool(exec, m, motion.x, gap, margin);
        return true;
    }

    /// Whether the pool holds all pairs of that query.
    bool covers(Exec& exec,
                const CollisionMeshView& m,
                const Motion& motion,
                double gap) {
        if (!pooled_ || gap != range_.gap || m.vertices.size == 0) return false;
        reaches_.resize(motion.x.size);
        detail::vertex_reaches(exec,
                               m.vertices,
                               View<const Vec3d>(reference_.view()),
                               motion,
                               reaches_.view());
        return detail::largest_reach(
                   exec, m.vertices, View<const VertexReach>(reaches_.view()))
            <= range_.margin;
    }

    /// A pool around x.
    void fill_pool(Exec& exec,
                   const CollisionMeshView& m,
                   View<const Vec3d> x,
                   double gap,
                   double margin) {
        reference_.resize(x.size);
        exec.copy(x, reference_.view());
        const View<const Vec3d> reference = reference_.view();
        constexpr double kRounding = 1e-5;  // above those of reach.hpp and of floats
        const double extent = detail::largest_coordinate(exec, m.vertices, reference);
        range_ = {margin, gap, kRounding * (2.0 * extent + gap + margin)};
        const Motion still{reference, {}, 0.0};
        const double near = range_.distance();
        search<StaticBox>(exec,
                          m,
                          still,
                          near,
                          detail::VertexTriangleTest{m, still, near},
                          detail::EdgeEdgeTest{m, still, near},
                          pool_);
        measure_pool(exec, m, reference);
        pooled_ = true;
        policy_.built(pool_.size(), m.edges.size);
    }

    void measure_pool(Exec& exec, const CollisionMeshView& m, View<const Vec3d> x) {
        vertex_triangle_distance_.resize(pool_.vertex_triangle.size());
        edge_edge_distance_.resize(pool_.edge_edge.size());
        detail::pool_distances(exec,
                               View<const Int2>(pool_.vertex_triangle.view()),
                               m.triangles,
                               x,
                               vertex_triangle_distance_.view());
        detail::pool_distances(exec,
                               View<const Int2>(pool_.edge_edge.view()),
                               m.edges,
                               x,
                               edge_edge_distance_.view());
    }

    /// The pairs of the pool that the motion brings close.
    template <class Box>
    void keep_close(Exec& exec, const detail::PoolQuery& query, Candidates<Exec>& out) {
        detail::keep_pairs(exec,
                           View<const Int2>(pool_.vertex_triangle.view()),
                           View<const float>(vertex_triangle_distance_.view()),
                           detail::PooledVertexTriangle<Box>{query},
                           keep_work_,
                           out.vertex_triangle);
        detail::keep_pairs(exec,
                           View<const Int2>(pool_.edge_edge.view()),
                           View<const float>(edge_edge_distance_.view()),
                           detail::PooledEdgeEdge<Box>{query},
                           keep_work_,
                           out.edge_edge);
    }

    /// All pairs whose boxes, grown by box_gap, overlap and which the tests accept.
    template <class Box, class VertexTriangle, class EdgeEdge>
    void search(Exec& exec,
                const CollisionMeshView& m,
                const Motion& motion,
                double box_gap,
                const VertexTriangle& vertex_triangle,
                const EdgeEdge& edge_edge,
                Candidates<Exec>& out) {
        if (!sorted_) sort(exec, m, motion.x);
        Trees<Box>& trees = std::get<Trees<Box>>(trees_);
        trees.vertices.refit(exec, vertices_, motion, box_gap);
        trees.triangles.refit(exec, triangles_, motion, 0.0);
        // Both edges of a pair grow by half of the gap: the tree is searched with itself.
        trees.edges.refit(exec, edges_, motion, 0.5 * box_gap);

        const auto vertices = trees.vertices.view(vertices_);
        const auto triangles = trees.triangles.view(triangles_);
        const auto edges = trees.edges.view(edges_);
        detail::find_tree_pairs(
            exec, vertices, triangles, vertex_triangle, work_, out.vertex_triangle);
        detail::name_first(exec, m.vertices, out.vertex_triangle.view());
        detail::find_tree_pairs(exec, edges, edges, edge_edge, work_, out.edge_edge);
    }

    void find_planes(Exec& exec,
                     const CollisionMeshView& m,
                     const Motion& motion,
                     double gap,
                     Candidates<Exec>& out) {
        const int n = m.planes.size > 0 ? m.vertices.size : 0;
        const detail::VertexPlaneSearch planes{m, motion, gap};
        work_.counts.resize(n);
        work_.offsets.resize(n + 1);
        detail::count_planes(exec, planes, work_.counts.view());
        out.vertex_plane.resize(
            exec.scan("contact/scan_planes", work_.counts.view(), work_.offsets.view()));
        detail::write_planes(
            exec, planes, View<const int>(work_.offsets.view()), out.vertex_plane.view());
    }

    BvhOrder<Exec, int> vertices_;
    BvhOrder<Exec, Int3> triangles_;
    BvhOrder<Exec, Int2> edges_;
    std::tuple<Trees<StaticBox>, Trees<MovingBox>> trees_;
    detail::PairWork<Exec> work_;
    bool sorted_ = false;

    Candidates<Exec> pool_;  ///< its planes stay empty
    PoolRange range_{};
    typename Exec::template Buffer<Vec3d> reference_;
    typename Exec::template Buffer<VertexReach> reaches_;
    typename Exec::template Buffer<float> vertex_triangle_distance_, edge_edge_distance_;
    bool pooled_ = false;
    PoolPolicy policy_;
    double edge_length_ = -1.0;  ///< mean, m; negative: not known yet
    detail::KeepWork<Exec> keep_work_;
};

/// Every pair of primitives whose distance gets below `inflation` at some time of the
/// motion x + t p, t in [0, alpha], and some that stay a little farther: those whose
/// boxes do not. Left out: pairs that share a vertex, pairs of kinematic vertices alone,
/// disabled body pairs.
///
/// In:   x (num_vertices) m, p (num_vertices) m or empty for a static query, inflation >=
/// 0 in m Out:  sorted lists, equal for every executor, thread count and age of the trees
template <class Exec>
void find_candidates(Exec& exec,
                     const DeviceCollisionMesh<Exec>& mesh,
                     BroadPhase<Exec>& broad_phase,
                     View<const Vec3d> x,
                     View<const Vec3d> p,
                     double alpha,
                     double inflation,
                     Candidates<Exec>& out) {
    // Room for the rounding of x + alpha p and of differences of coordinates.
    const double gap = inflation * (1.0 + 1e-6);
    broad_phase.find(exec, mesh, Motion{x, p, alpha}, gap, out);
}

}  // namespace noli
