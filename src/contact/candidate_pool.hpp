// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Pairs found once for a whole neighbourhood of positions, so that most queries of a
/// time step need no tree search.
///
/// Newton moves far once or twice in a step and then ever less, and the next step starts
/// where the last one ended. A pool belongs to reference positions and holds every pair
/// that is closer than gap + 2 margin there, with its distance. A query whose vertices
/// are displaced from the reference and travel on by no more than `margin` (sum of the
/// largest of both) can bring no other pair closer than gap, and of the pool only pairs
/// whose distance is below gap + displacement + travel of their own vertices. What is
/// left takes the tests of a tree search (within_reach among them). Where a few vertices
/// go farther, the pairs of their primitives are searched for (far_search.hpp) and all
/// others come from the pool. A query finds the same candidates with a pool and without,
/// bit for bit.

#include "contact/collision_mesh.hpp"
#include "contact/reach.hpp"

#include <cstdint>

namespace noli {

/// A pool's neighbourhood.
struct PoolRange {
    double margin;    ///< m
    double gap;       ///< of the queries, m
    double rounding;  ///< m, more than the error of distances and float boxes

    /// The pool holds all pairs closer than this at the reference, m.
    [[nodiscard]] NOLI_HD double distance() const {
        return gap + 2.0 * margin + rounding;
    }
};

/// How far a vertex is from the reference and how far it travels from there, m, rounded
/// up.
struct VertexReach {
    float displaced, travels;
};

namespace detail {

NOLI_HD inline float reach_up(double v) {
    return static_cast<float>(v * (1.0 + 1e-6)) + 1e-37F;
}

/// out[v] for the vertices of the surface.
template <class Exec>
void vertex_reaches(Exec& exec,
                    View<const int> vertices,
                    View<const Vec3d> reference,
                    Motion motion,
                    View<VertexReach> out) {
    const bool moves = motion.p.size > 0;
    exec.for_each("contact/vertex_reaches", vertices.size, [=] NOLI_HD(int i) {
        const int v = vertices[i];
        out[v] = {reach_up(norm(motion.x[v] - reference[v])),
                  moves ? reach_up(motion.alpha * norm(motion.p[v])) : 0.0F};
    });
}

/// A distance that is surely not above the true one, as a float.
template <class IdsA, class IdsB>
NOLI_HD inline float distance_below(View<const Vec3d> x, const IdsA& a, const IdsB& b) {
    const double room = 1e-6 * size_of_pair(x, a, b);
    return static_cast<float>(plain_distance(x, a, b) * (1.0 - 1e-6) - room);
}

/// Distances of vertex-triangle pairs at x.
template <class Exec>
void pool_distances(Exec& exec,
                    View<const Int2> pairs,
                    View<const Int3> triangles,
                    View<const Vec3d> x,
                    View<float> out) {
    exec.for_each("contact/pool_distances", out.size, [=] NOLI_HD(int i) {
        out[i] = distance_below(x, pairs[i][0], triangles[pairs[i][1]]);
    });
}

/// Distances of edge pairs at x.
template <class Exec>
void pool_distances(Exec& exec,
                    View<const Int2> pairs,
                    View<const Int2> edges,
                    View<const Vec3d> x,
                    View<float> out) {
    exec.for_each("contact/pool_distances", out.size, [=] NOLI_HD(int i) {
        out[i] = distance_below(x, edges[pairs[i][0]], edges[pairs[i][1]]);
    });
}

}  // namespace detail

/// When to build a pool and how wide. Decides about time only, never about results.
class PoolPolicy {
  public:
    /// Widest margin of a pool at present, m. `edge` = mean length of an edge, m.
    [[nodiscard]] double widest(double gap, double edge) const {
        return share_ * (kOfEdge * edge + kOfGap * gap);
    }
    /// Motions of up to this are short enough for a pool of that margin.
    [[nodiscard]] static double longest_travel(double widest) { return 0.5 * widest; }

    /// Whether so few vertices may go farther than a pool allows.
    [[nodiscard]] static bool few(double num_far, int num_vertices) {
        return num_far <= kFewest || num_far <= kFewShare * num_vertices;
    }

    /// Margin of a pool for a motion of that size, m; 0: search without one.
    /// `edge` = mean length of an edge, m.
    [[nodiscard]] double margin_for(double travel, double gap, double edge) {
        const double most = widest(gap, edge);
        if (!(travel <= longest_travel(most))) return 0.0;
        if (pause_ > 0) {
            --pause_;
            return 0.0;
        }
        return std::fmin(most, std::fmax(0.1 * most, 2.0 * travel));
    }
    /// Large pools take longer than they save: the next ones get smaller.
    void built(int num_pairs, int num_edges) {
        used_ = false;
        if (num_pairs > num_edges)
            share_ *= 0.7;
        else if (share_ < 1.0)
            share_ *= 1.05;
    }
    void used() {
        used_ = true;
        next_pause_ = 1;
    }
    /// The pool does not cover a query: if it never did, do without one for a while.
    void missed() {
        if (used_) return;
        pause_ = next_pause_;
        next_pause_ = next_pause_ < kLongestPause ? 2 * next_pause_ : kLongestPause;
        used_ = true;
    }

  private:
    static constexpr double kFewest = 4.0;
    static constexpr double kFewShare = 0.03;
    static constexpr double kOfEdge = 0.1;
    static constexpr double kOfGap = 0.25;
    static constexpr int kLongestPause = 8;
    double share_ = 1.0;
    int pause_ = 0;
    int next_pause_ = 1;
    bool used_ = true;  ///< or none was built
};

}  // namespace noli
