// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Broad phase: every pair of primitives that may come close during a motion.
///
/// Candidates depend on mesh, positions and motion alone: not on the order of the trees,
/// hence not on when they were last sorted. A tree search finds pairs whose boxes
/// overlap; what it finds is tested along the line through the centres and the common
/// normal too (moving_box.hpp), which leaves out most neighbours on a smooth surface, and
/// that saves more time downstream than it costs.
///
/// Source: MATH 9 (which pairs), moving_box.hpp (which are far).

#include "contact/bvh.hpp"
#include "contact/collision_mesh.hpp"
#include "contact/moving_box.hpp"
#include "contact/tree_search.hpp"

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

/// Accepts vertex-triangle pairs that may get closer than gap.
struct VertexTriangleTest {
    static constexpr bool kSelf = false;
    static constexpr bool kSkipShared = true;
    CollisionMeshView mesh;
    Motion motion;
    double gap;

    NOLI_HD bool operator()(int query, int triangle) const {
        const int vertex = mesh.vertices[query];
        const Int3& corners = mesh.triangles[triangle];
        return !stay_apart(motion, vertex, corners, gap)
            && mesh.may_collide(vertex, corners);
    }
};

/// Accepts edge pairs that may get closer than gap.
struct EdgeEdgeTest {
    static constexpr bool kSelf = true;
    static constexpr bool kSkipShared = true;
    CollisionMeshView mesh;
    Motion motion;
    double gap;

    NOLI_HD bool operator()(int edge_a, int edge_b) const {
        const Int2& a = mesh.edges[edge_a];
        const Int2& b = mesh.edges[edge_b];
        return !stay_apart(motion, a, b, gap) && mesh.may_collide(a, b);
    }
};

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

/// The trees over a mesh and the buffers of the search, kept between queries.
template <class Exec>
class BroadPhase {
  public:
    /// Sorts the trees by present positions x. Results never depend on when this was
    /// called, but queries slow down when much has moved since: once per time step is
    /// enough.
    void sort(Exec& exec, const DeviceCollisionMesh<Exec>& mesh, View<const Vec3d> x) {
        const CollisionMeshView m = mesh.view();
        const MortonGrid grid = detail::grid_around(exec, m.vertices, x);
        vertices_.sort(exec, m.vertices, grid, x);
        triangles_.sort(exec, m.triangles, grid, x);
        edges_.sort(exec, m.edges, grid, x);
    }

    /// See find_candidates.
    void find(Exec& exec,
              const DeviceCollisionMesh<Exec>& mesh,
              const Motion& motion,
              double gap,
              Candidates<Exec>& out) {
        const CollisionMeshView m = mesh.view();
        if (vertices_.order().size != m.vertices.size
            || edges_.order().size != m.edges.size
            || triangles_.order().size != m.triangles.size)
            sort(exec, mesh, motion.x);
        if (motion.p.size > 0)
            find_pairs_of(exec, m, motion, gap, moving_, out);
        else
            find_pairs_of(exec, m, motion, gap, still_, out);
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
                       Trees<Box>& trees,
                       Candidates<Exec>& out) {
        trees.vertices.refit(exec, vertices_, motion, gap);
        trees.triangles.refit(exec, triangles_, motion, 0.0);
        // Both edges of a pair grow by half of the gap: the tree is searched with itself.
        trees.edges.refit(exec, edges_, motion, 0.5 * gap);

        const auto vertices = trees.vertices.view(vertices_);
        const auto triangles = trees.triangles.view(triangles_);
        const auto edges = trees.edges.view(edges_);
        const detail::VertexTriangleTest vertex_triangle{m, motion, gap};
        detail::find_tree_pairs(
            exec, vertices, triangles, vertex_triangle, work_, out.vertex_triangle);
        detail::name_first(exec, m.vertices, out.vertex_triangle.view());
        const detail::EdgeEdgeTest edge_edge{m, motion, gap};
        detail::find_tree_pairs(exec, edges, edges, edge_edge, work_, out.edge_edge);
    }

    void find_planes(Exec& exec,
                     const CollisionMeshView& m,
                     const Motion& motion,
                     double gap,
                     Candidates<Exec>& out) {
        const int n = m.planes.size > 0 ? m.vertices.size : 0;
        const detail::VertexPlaneSearch search{m, motion, gap};
        work_.counts.resize(n);
        work_.offsets.resize(n + 1);
        detail::count_planes(exec, search, work_.counts.view());
        out.vertex_plane.resize(
            exec.scan("contact/scan_planes", work_.counts.view(), work_.offsets.view()));
        detail::write_planes(
            exec, search, View<const int>(work_.offsets.view()), out.vertex_plane.view());
    }

    BvhOrder<Exec, int> vertices_;
    BvhOrder<Exec, Int3> triangles_;
    BvhOrder<Exec, Int2> edges_;
    Trees<StaticBox> still_;
    Trees<MovingBox> moving_;
    detail::PairWork<Exec> work_;
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
