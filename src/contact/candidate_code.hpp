// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Which list of active pairs a candidate belongs to, and its closest features, as a
/// 16-bit code.

#include "contact/candidates.hpp"
#include "geometry/closest_feature.hpp"

#include <cmath>
#include <cstdint>

namespace noli::detail {

/// The lists of a PairSet, in order; then candidates for which doubles did not suffice
/// (geometry/stages.hpp), which are counted like a list.
enum class PairList : int { PP, PE, PT, EE, Mollified, Wall, Undecided, None };
inline constexpr int kNumPairLists = 6;
inline constexpr int kNumCounts = 7;

/// Bits 0-2 list, 3-4 kind, 5-12 the four local positions (0 where unused).
NOLI_HD inline std::uint16_t encode(PairList list, const ClosestFeature& f) {
    unsigned code = static_cast<unsigned>(list) | static_cast<unsigned>(f.kind) << 3;
    for (int k = 0; k < 4; ++k) {
        const int position = f.local[k];
        if (position > 0) code |= static_cast<unsigned>(position) << (5 + 2 * k);
    }
    return static_cast<std::uint16_t>(code);
}
NOLI_HD inline PairList list_of(std::uint16_t code) {
    return static_cast<PairList>(code & 7U);
}
NOLI_HD inline PairKind kind_of(std::uint16_t code) {
    return static_cast<PairKind>((code >> 3) & 3U);
}
NOLI_HD inline int local_of(std::uint16_t code, int k) {
    return (code >> (5 + 2 * k)) & 3;
}

/// Number of points in a kind's stencil.
NOLI_HD inline int stencil_size(PairKind kind) {
    if (kind == PairKind::PointPoint) return 2;
    return kind == PairKind::PointEdge ? 3 : 4;
}

/// Candidates, numbered through as vertex-triangle, edge-edge, vertex-wall.
struct CandidateView {
    CollisionMeshView mesh;
    View<const Int2> vertex_triangle;
    View<const Int2> edge_edge;
    View<const Int2> vertex_wall;

    [[nodiscard]] NOLI_HD int size() const {
        return vertex_triangle.size + edge_edge.size + vertex_wall.size;
    }
    [[nodiscard]] NOLI_HD bool is_vertex_triangle(int i) const {
        return i < vertex_triangle.size;
    }
    [[nodiscard]] NOLI_HD bool is_wall(int i) const {
        return i >= vertex_triangle.size + edge_edge.size;
    }
    [[nodiscard]] NOLI_HD Int2 ids(int i) const {
        if (i < vertex_triangle.size) return vertex_triangle[i];
        i -= vertex_triangle.size;
        return i < edge_edge.size ? edge_edge[i] : vertex_wall[i - edge_edge.size];
    }
    /// Vertex and triangle; both edges; vertex, wall index, -1, -1.
    [[nodiscard]] NOLI_HD Int4 vertices(int i) const {
        const Int2 pair = ids(i);
        if (is_wall(i)) return {{pair[0], pair[1], -1, -1}};
        if (is_vertex_triangle(i)) {
            const Int3& t = mesh.triangles[pair[1]];
            return {{pair[0], t[0], t[1], t[2]}};
        }
        const Int2& a = mesh.edges[pair[0]];
        const Int2& b = mesh.edges[pair[1]];
        return {{a[0], a[1], b[0], b[1]}};
    }
    [[nodiscard]] NOLI_HD double eps_cross(int i) const {
        const Int2 pair = ids(i);
        return 1e-3 * mesh.edge_rest_sq[pair[0]] * mesh.edge_rest_sq[pair[1]];
    }
};

template <class Exec>
CandidateView view_of(const DeviceCollisionMesh<Exec>& mesh,
                      const Candidates<Exec>& candidates) {
    return {mesh.view(),
            candidates.vertex_triangle.view(),
            candidates.edge_edge.view(),
            candidates.vertex_wall.view()};
}

NOLI_HD inline Stencil<4> stencil_at(View<const Vec3d> x, const Int4& v) {
    return {{x[v[0]], x[v[1]], x[v[2]], x[v[3]]}};
}

/// List and closest features of candidate i at positions x; list None if it is not closer
/// than dhat. In doubles only, the geometry of an active pair is looked at as well, so
/// that what is computed of it at x can do with doubles too.
template <Doubles How>
struct CandidateCode {
    CandidateView candidates;
    View<const Vec3d> x;
    double dhat;
    int i;

    template <class Stage>
    NOLI_HD std::uint16_t operator()(Stage& stage) const {
        const Int4 v = candidates.vertices(i);
        constexpr ClosestFeature kNothing{PairKind::PointPoint, {-1, -1, -1, -1}, 0.0};
        if (candidates.is_wall(i)) {
            const bool active =
                wall_distance(candidates.mesh.walls[v[1]], x[v[0]]) < dhat;
            return encode(active ? PairList::Wall : PairList::None, kNothing);
        }
        const Stencil<4> s = stencil_at(x, v);
        const bool vertex_triangle = candidates.is_vertex_triangle(i);
        const ClosestFeature f = vertex_triangle ? classify_point_triangle(s, stage)
                                                 : classify_edge_edge(s, stage);
        const bool active = std::sqrt(f.d_sq) < dhat;
        if (How == Doubles::Only && active) feature_normal(s, f, stage);
        if (!stage.enough()) return encode(PairList::Undecided, kNothing);
        if (!active) return encode(PairList::None, kNothing);
        if (!vertex_triangle && edge_cross_sq(s) < candidates.eps_cross(i))
            return encode(PairList::Mollified, f);
        return encode(static_cast<PairList>(f.kind), f);
    }
};

}  // namespace noli::detail
