// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Broad phase: every pair of primitives that may come close during a motion.
///
/// Candidates depend on mesh, positions and motion alone: not on the order of the trees,
/// hence not on when they were last sorted. A tree search finds pairs whose boxes
/// overlap; what it finds is tested along the line through the centres and the common
/// normal too (moving_box.hpp), and whether the motion is long enough to bring it close
/// (reach.hpp): that leaves out most neighbours on a smooth surface, and saves more time
/// downstream than it costs. Most queries need no search of the trees, or one with a few
/// primitives: see candidate_pool.hpp.
///
/// Source: [Li2020] (which pairs), moving_box.hpp and reach.hpp (which are far).

#include "contact/candidate_pool.hpp"
#include "contact/candidates.hpp"
#include "contact/collision_mesh.hpp"
#include "contact/mesh_trees.hpp"
#include "contact/moving_box.hpp"
#include "contact/pool_query.hpp"
#include "contact/query_reach.hpp"
#include "contact/wall_search.hpp"

namespace noli {

/// The trees over a mesh, the pool and the buffers of the search, kept between queries.
template <class Exec>
class BroadPhase {
  public:
    /// Sorts the trees anew at the next search. Results never depend on when this was
    /// called, but searches slow down when much has moved since: once per time step is
    /// enough.
    void sort_at_next_search() { trees_.sort_at_next_search(); }

    /// The same at once, by positions x.
    void sort(Exec& exec, const CollisionMeshView& m, View<const Vec3d> x) {
        trees_.sort(exec, m, x);
        trees_hold_pool_ = false;
    }

    /// Call when the mesh has changed.
    void forget() {
        trees_.sort_at_next_search();
        pooled_ = false;
        edge_length_ = -1.0;
    }

    /// Starts to look how far the vertices have moved and will move along p (empty: not
    /// at all), for a call of `find` with these arrays.
    void look_along(Exec& exec,
                    const DeviceCollisionMesh<Exec>& mesh,
                    View<const Vec3d> x,
                    View<const Vec3d> p) {
        const CollisionMeshView m = mesh.view();
        reach_.travel = detail::largest_travel(exec, m.vertices, p);
        reach_.coordinate = detail::largest_coordinate(exec, m.vertices, x);
        reach_.long_travels = detail::count_long_travels(
            exec,
            m.vertices,
            p,
            PoolPolicy::longest_travel(policy_.widest(range_.gap, edge_length_)));
        if (pooled_) {
            const View<const Vec3d> reference(reference_.view());
            reach_.displaced =
                detail::largest_displacement(exec, m.vertices, reference, x);
            reach_.far =
                detail::count_far(exec, m.vertices, reference, x, p, range_.margin);
        }
        if (edge_length_ < 0.0)
            reach_.edge_lengths = detail::sum_of_lengths(exec, m.edge_rest_sq);
    }

    /// See find_candidates. Call look_along before, with the same arrays.
    void find(Exec& exec,
              const DeviceCollisionMesh<Exec>& mesh,
              const Motion& motion,
              double gap,
              Candidates<Exec>& out) {
        const CollisionMeshView m = mesh.view();
        const detail::VertexWallSearch walls{m, motion, gap};
        wall_pairs_.start(exec, walls);
        if (motion.p.size > 0)
            find_pairs_of<MovingBox>(exec, m, motion, gap, out);
        else
            find_pairs_of<StaticBox>(exec, m, motion, gap, out);
        wall_pairs_.finish(exec, walls, out.vertex_wall);
    }

  private:
    template <class T>
    using Buffer = typename Exec::template Buffer<T>;

    /// What belongs to one list of the pool.
    struct PooledPairs {
        Buffer<float> distances;  ///< at the reference, m
        detail::PairFilter<Exec> filter;
    };

    template <class Box>
    void find_pairs_of(Exec& exec,
                       const CollisionMeshView& m,
                       const Motion& motion,
                       double gap,
                       Candidates<Exec>& out) {
        bool pooled = covers(exec, m, motion, gap);
        if (pooled)
            policy_.used();
        else
            pooled = renew_pool(exec, m, motion, gap);
        if (pooled)
            keep_close<Box>(exec, m, motion, gap, out);
        else
            trees_.template search<Box>(exec, m, motion, gap, out);
    }

    /// How far a vertex travels at most, m, rounded up.
    double largest_travel(Exec& exec, const Motion& motion) {
        if (motion.p.size == 0) return 0.0;
        return detail::reach_up(motion.alpha * exec.value(reach_.travel));
    }

    /// Whether the pool holds the pairs of all but a few primitives of that query.
    bool covers(Exec& exec,
                const CollisionMeshView& m,
                const Motion& motion,
                double gap) {
        if (!pooled_ || gap != range_.gap || m.vertices.size == 0) return false;
        const double most =
            detail::reach_up(exec.value(reach_.displaced)) + largest_travel(exec, motion);
        some_far_ = !(most <= range_.margin);
        return !some_far_
            || (trees_hold_pool_ && most < INFINITY
                && PoolPolicy::few(exec.value(reach_.far), m.vertices.size));
    }

    /// A pool that covers this motion and what comes after it, if that seems worth it.
    bool renew_pool(Exec& exec,
                    const CollisionMeshView& m,
                    const Motion& motion,
                    double gap) {
        if (pooled_) policy_.missed();
        pooled_ = false;
        if (m.vertices.size == 0) return false;
        if (edge_length_ < 0.0)
            edge_length_ = m.edge_rest_sq.size == 0
                             ? 0.0
                             : exec.value(reach_.edge_lengths) / m.edge_rest_sq.size;
        const double margin = margin_for(exec, m, motion, gap);
        if (!(margin > 0.0)) return false;
        fill_pool(exec, m, motion.x, gap, margin);
        some_far_ = !(largest_travel(exec, motion) <= margin);
        return true;
    }

    /// Margin of a pool for this motion and what comes after it; 0: none is worth it.
    double margin_for(Exec& exec,
                      const CollisionMeshView& m,
                      const Motion& motion,
                      double gap) {
        double travel = largest_travel(exec, motion);
        const double longest =
            PoolPolicy::longest_travel(policy_.widest(gap, edge_length_));
        const bool known = gap == range_.gap && travel < INFINITY;
        if (travel > longest && known
            && PoolPolicy::few(exec.value(reach_.long_travels), m.vertices.size))
            travel = longest;
        return policy_.margin_for(travel, gap, edge_length_);
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
        const double extent = exec.value(reach_.coordinate);
        range_ = {margin, gap, kRounding * (2.0 * extent + gap + margin)};
        const Motion still{reference, {}, 0.0};
        trees_.template search<StaticBox>(exec, m, still, range_.distance(), pool_);
        measure_pool(exec, m, reference);
        pooled_ = true;
        trees_hold_pool_ = true;
        policy_.built(pool_.size(), m.edges.size);
    }

    void measure_pool(Exec& exec, const CollisionMeshView& m, View<const Vec3d> x) {
        const auto measure = [&](auto primitives, Buffer<Int2>& pairs, PooledPairs& out) {
            out.distances.resize(pairs.size());
            detail::pool_distances(
                exec, pairs.view(), primitives, x, out.distances.view());
        };
        measure(m.triangles, pool_.vertex_triangle, pooled_vertex_triangle_);
        measure(m.edges, pool_.edge_edge, pooled_edge_edge_);
    }

    /// The pairs of the pool that the motion brings close.
    template <class Box>
    void keep_close(Exec& exec,
                    const CollisionMeshView& m,
                    const Motion& motion,
                    double gap,
                    Candidates<Exec>& out) {
        reaches_.resize(motion.x.size);
        detail::vertex_reaches(exec,
                               m.vertices,
                               View<const Vec3d>(reference_.view()),
                               motion,
                               reaches_.view());
        const float margin =
            some_far_ ? static_cast<float>(range_.margin * (1.0 - 1e-6)) : INFINITY;
        const detail::PoolQuery query{m, motion, gap, reaches_.view(), margin};
        const auto start = [&](PooledPairs& pooled, Buffer<Int2>& pairs, auto keeps) {
            pooled.filter.start(exec, pairs.view(), pooled.distances.view(), keeps);
        };
        start(pooled_vertex_triangle_,
              pool_.vertex_triangle,
              detail::PooledVertexTriangle<Box>{query});
        start(pooled_edge_edge_, pool_.edge_edge, detail::PooledEdgeEdge<Box>{query});
        if (some_far_) trees_.template start_far<Box>(exec, query, range_.distance());
        Candidates<Exec>& near = some_far_ ? near_ : out;
        pooled_vertex_triangle_.filter.finish(exec, near.vertex_triangle);
        pooled_edge_edge_.filter.finish(exec, near.edge_edge);
        if (!some_far_) return;
        trees_.template finish_far<Box>(exec, query, range_.distance(), far_);
        detail::merge_pairs(
            exec, near_.vertex_triangle, far_.vertex_triangle, out.vertex_triangle);
        detail::merge_pairs(exec, near_.edge_edge, far_.edge_edge, out.edge_edge);
    }

    MeshTrees<Exec> trees_;
    detail::WallPairs<Exec> wall_pairs_;

    Candidates<Exec> pool_;        ///< its walls stay empty
    Candidates<Exec> near_, far_;  ///< pairs of the pool, and those with far primitives
    PoolRange range_{};
    QueryReach reach_;
    Buffer<Vec3d> reference_;
    Buffer<VertexReach> reaches_;
    PooledPairs pooled_vertex_triangle_, pooled_edge_edge_;
    bool pooled_ = false;
    bool trees_hold_pool_ = false;  ///< their standing boxes are those of the pool
    bool some_far_ = false;         ///< in the present query
    PoolPolicy policy_;
    double edge_length_ = -1.0;  ///< mean, m; negative: not known yet
};

/// Every pair of primitives whose distance gets below `inflation` at some time of the
/// motion, and some that stay a little farther: those whose boxes do not. Left out: pairs
/// that share a vertex, pairs of kinematic vertices alone, disabled body pairs.
/// broad_phase.look_along(exec, mesh, motion.x, motion.p) has been called.
///
/// In:   motion (num_vertices) m, without p for a static query; inflation >= 0 in m
/// Out:  sorted lists, equal for every executor, thread count and age of the trees
template <class Exec>
void find_candidates_seen(Exec& exec,
                          const DeviceCollisionMesh<Exec>& mesh,
                          BroadPhase<Exec>& broad_phase,
                          const Motion& motion,
                          double inflation,
                          Candidates<Exec>& out) {
    // Room for the rounding of x + alpha p and of differences of coordinates.
    const double gap = inflation * (1.0 + 1e-6);
    broad_phase.find(exec, mesh, motion, gap, out);
}

/// The same, looking along the motion first.
template <class Exec>
void find_candidates(Exec& exec,
                     const DeviceCollisionMesh<Exec>& mesh,
                     BroadPhase<Exec>& broad_phase,
                     const Motion& motion,
                     double inflation,
                     Candidates<Exec>& out) {
    broad_phase.look_along(exec, mesh, motion.x, motion.p);
    find_candidates_seen(exec, mesh, broad_phase, motion, inflation, out);
}

}  // namespace noli
