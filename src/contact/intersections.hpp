// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Independent exact check of a state: is anything intersecting, touching, behind a
/// wall, or inverted? Shares no code with the barrier's distances nor with the step
/// bound; the tree only proposes pairs whose boxes overlap, and exact predicates decide,
/// without a tolerance.
///
/// An edge and a triangle that share one vertex meet there inevitably and are tested for
/// a second meeting point; an edge of the triangle itself is skipped. Pairs of kinematic
/// vertices alone and disabled body pairs are skipped.

#include "contact/bvh.hpp"
#include "contact/collision_mesh.hpp"
#include "contact/tree_search.hpp"
#include "geometry/exact.hpp"
#include "geometry/wall_side.hpp"

#include <cmath>
#include <cstddef>
#include <vector>

namespace noli {

struct EdgeTriangleIntersection {
    Int2 edge;      ///< vertex ids
    Int3 triangle;  ///< vertex ids
    Vec3d place;    ///< about where, m
};
struct VertexOnTriangle {
    int vertex;
    Int3 triangle;  ///< vertex ids
    Vec3d place;    ///< m
};
struct VertexBehindWall {
    int vertex;
    int wall;
    double distance;  ///< signed, m; <= 0
};

/// Everything wrong with a state; each list ascending.
struct Intersections {
    std::vector<EdgeTriangleIntersection> edge_triangle;
    std::vector<VertexOnTriangle>
        vertex_triangle;  ///< of vertices without edges (obstacle points)
    std::vector<VertexBehindWall> vertex_wall;
    std::vector<int> not_finite;  ///< surface vertices with a NaN or infinity: nothing is
                                  ///< known of them

    [[nodiscard]] std::size_t size() const {
        return edge_triangle.size() + vertex_triangle.size() + vertex_wall.size()
             + not_finite.size();
    }
};

namespace detail {

/// Edge v w and triangle v b c, which share v: have they another common point? A second
/// point makes w lie in the plane, and then either w is in the triangle or the edge
/// leaves it through b c.
NOLI_HD inline bool meets_beyond_vertex(const Vec3d& v,
                                        const Vec3d& w,
                                        const Vec3d& b,
                                        const Vec3d& c) {
    if (orient3d_sign(v, b, c, w) != 0) return false;
    return point_on_triangle(w, v, b, c) || segments_intersect_3d(v, w, b, c);
}

/// Edge e and triangle t of vertex ids; at most one vertex is common.
NOLI_HD inline bool edge_meets_triangle(View<const Vec3d> x,
                                        const Int2& e,
                                        const Int3& t) {
    for (int i = 0; i < 2; ++i)
        for (int k = 0; k < 3; ++k)
            if (e.v[i] == t.v[k])
                return meets_beyond_vertex(
                    x[e.v[i]], x[e.v[1 - i]], x[t.v[(k + 1) % 3]], x[t.v[(k + 2) % 3]]);
    return segment_intersects_triangle(
        x[e.v[0]], x[e.v[1]], x[t.v[0]], x[t.v[1]], x[t.v[2]]);
}

/// Accepts edges and triangles that meet.
struct EdgeTriangleExactTest {
    static constexpr bool kSelf = false;
    static constexpr bool kSkipShared = false;
    CollisionMeshView mesh;
    View<const Vec3d> x;

    NOLI_HD bool operator()(const Int2& e, const Int3& t) const {
        int shared = 0;
        int movable = 0;
        for (int i = 0; i < 2; ++i)
            for (int k = 0; k < 3; ++k) {
                shared += e.v[i] == t.v[k] ? 1 : 0;
                movable += mesh.kinematic[e.v[i]] && mesh.kinematic[t.v[k]] ? 0 : 1;
            }
        if (shared == 2 || movable == 0 || !mesh.bodies_collide(e.v[0], t.v[0]))
            return false;
        return edge_meets_triangle(x, e, t);
    }
};

/// Accepts vertices without edges that lie in a triangle.
struct VertexTriangleExactTest {
    static constexpr bool kSelf = false;
    static constexpr bool kSkipShared = true;
    CollisionMeshView mesh;
    View<const Vec3d> x;

    NOLI_HD bool operator()(int vertex, const Int3& t) const {
        return mesh.may_collide(vertex, t)
            && point_on_triangle(x[vertex], x[t.v[0]], x[t.v[1]], x[t.v[2]]);
    }
};

/// Where the line through the edge meets the triangle's plane, kept within the edge; its
/// middle if flat.
inline Vec3d meeting_place(
    const Vec3d& p, const Vec3d& q, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const Vec3d normal = cross(b - a, c - a);
    const double from = dot(p - a, normal);
    const double to = dot(q - a, normal);
    const double t =
        from == to ? 0.5 : std::fmin(std::fmax(from / (from - to), 0.0), 1.0);
    return p + t * (q - p);
}

/// Surface vertices that belong to no edge, ascending.
inline std::vector<int> vertices_without_edges(const CollisionMesh& mesh) {
    std::vector<char> has_edge(static_cast<std::size_t>(mesh.num_vertices), 0);
    for (const Int2& e : mesh.edges)
        has_edge[static_cast<std::size_t>(e.v[0])] =
            has_edge[static_cast<std::size_t>(e.v[1])] = 1;
    std::vector<int> points;
    for (const int v : mesh.vertices)
        if (!has_edge[static_cast<std::size_t>(v)]) points.push_back(v);
    return points;
}

}  // namespace detail

/// Finds all intersections of a state. Host executors only: the report is built on the
/// host.
template <class Exec>
class IntersectionCheck {
  public:
    /// Keeps a copy of the mesh.
    void set_mesh(Exec& exec, const CollisionMesh& mesh) {
        host_ = mesh;
        mesh_.upload(exec, mesh);
        exec.upload(detail::vertices_without_edges(mesh), points_);
    }

    /// x: (num_vertices) m
    [[nodiscard]] Intersections run(Exec& exec, View<const Vec3d> x) {
        const CollisionMeshView m = mesh_.view();
        const View<const int> points = points_.view();
        const Motion still{x, {}, 0.0};
        const MortonGrid grid = detail::grid_around(exec, m.vertices, x);
        edges_.sort(exec, m.edges, grid, x);
        triangles_.sort(exec, m.triangles, grid, x);
        point_order_.sort(exec, points, grid, x);
        // Boxes are rounded outwards, so touching primitives have overlapping boxes
        // without a gap.
        edge_boxes_.refit(exec, edges_, detail::MotionBoxes<StaticBox>{still, 0.0});
        triangle_boxes_.refit(
            exec, triangles_, detail::MotionBoxes<StaticBox>{still, 0.0});
        point_boxes_.refit(
            exec, point_order_, detail::MotionBoxes<StaticBox>{still, 0.0});

        Intersections found;
        const auto triangles = triangle_boxes_.view(triangles_);
        const detail::EdgeTriangleExactTest edge_test{m, x};
        detail::find_tree_pairs(
            exec, edge_boxes_.view(edges_), triangles, edge_test, work_, pairs_);
        add_edges(x, found);
        const detail::VertexTriangleExactTest point_test{m, x};
        detail::find_tree_pairs(
            exec, point_boxes_.view(point_order_), triangles, point_test, work_, pairs_);
        add_points(x, found);
        add_vertices(x, found);
        return found;
    }

  private:
    void add_edges(View<const Vec3d> x, Intersections& found) const {
        for (const Int2& pair : pairs_.view()) {
            const Int2 e = host_.edges[static_cast<std::size_t>(pair[0])];
            const Int3 t = host_.triangles[static_cast<std::size_t>(pair[1])];
            found.edge_triangle.push_back(
                {e,
                 t,
                 detail::meeting_place(x[e[0]], x[e[1]], x[t[0]], x[t[1]], x[t[2]])});
        }
    }
    void add_points(View<const Vec3d> x, Intersections& found) const {
        for (const Int2& pair : pairs_.view()) {
            const int vertex = points_.view()[pair[0]];
            found.vertex_triangle.push_back(
                {vertex, host_.triangles[static_cast<std::size_t>(pair[1])], x[vertex]});
        }
    }
    void add_vertices(View<const Vec3d> x, Intersections& found) const {
        const CollisionMeshView m = mesh_.view();
        for (const int vertex : host_.vertices) {
            if (!std::isfinite(norm_sq(x[vertex]))) found.not_finite.push_back(vertex);
            for (int k = 0; k < m.walls.size && !m.kinematic[vertex]; ++k) {
                if (!m.wall_collides(k, vertex)) continue;
                if (wall_side(m.walls[k], x[vertex]) <= 0)
                    found.vertex_wall.push_back(
                        {vertex, k, wall_distance(m.walls[k], x[vertex])});
            }
        }
    }

    CollisionMesh host_;
    DeviceCollisionMesh<Exec> mesh_;
    typename Exec::template Buffer<int> points_;
    BvhOrder<Exec, Int2> edges_;
    BvhOrder<Exec, Int3> triangles_;
    BvhOrder<Exec, int> point_order_;
    BvhBoxes<Exec, StaticBox, Int2> edge_boxes_;
    BvhBoxes<Exec, StaticBox, Int3> triangle_boxes_;
    BvhBoxes<Exec, StaticBox, int> point_boxes_;
    detail::TreePairs<Exec> work_;
    typename Exec::template Buffer<Int2> pairs_;
};

/// Tetrahedra without positive volume.
struct InvertedTets {
    int count;
    int first;  ///< index of the first one; -1 if none
};

/// Counts tetrahedra (x1-x0) x (x2-x0) . (x3-x0) <= 0, by the exact sign.
template <class Exec>
InvertedTets count_inverted(Exec& exec, View<const Int4> tets, View<const Vec3d> x) {
    const double count =
        exec.sum("contact/count_inverted", tets.size, [=] NOLI_HD(int i) {
            const Int4& t = tets[i];
            return orient3d_sign(x[t.v[0]], x[t.v[1]], x[t.v[2]], x[t.v[3]]) > 0 ? 0.0
                                                                                 : 1.0;
        });
    const double first =
        exec.min("contact/first_inverted", tets.size, [=] NOLI_HD(int i) {
            const Int4& t = tets[i];
            const bool inverted =
                !(orient3d_sign(x[t.v[0]], x[t.v[1]], x[t.v[2]], x[t.v[3]]) > 0);
            return inverted ? double(i) : INFINITY;
        });
    return {static_cast<int>(count), first < INFINITY ? static_cast<int>(first) : -1};
}

}  // namespace noli
