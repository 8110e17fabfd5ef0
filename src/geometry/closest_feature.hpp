// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Which parts of a point-triangle or edge-edge pair are closest, and their distance.
///
/// The interior class (point-triangle, edge-edge) is taken when the foot points lie
/// strictly inside, judged with cross products that do not cancel; otherwise the nearest
/// of the point-segment candidates wins. Every candidate is a distance that the
/// primitives do attain, so a foot point misjudged by rounding on a region border moves
/// the result by rounding only, and degenerate input (edges of length 0, triangles
/// without area, parallel edges) needs no tolerance: an interior class without a normal
/// is no candidate.
///
/// Source: MATH 9 (regions). Its parallel threshold 1e-20 is not needed here.

#include "core/stencil.hpp"
#include "geometry/exact.hpp"
#include "geometry/pair_geometry.hpp"
#include "geometry/predicates.hpp"

namespace noli {

/// The closest features of a 4-point primitive pair.
struct ClosestFeature {
    PairKind kind;
    int local[4];  ///< positions in the 4-point stencil, in the order of `kind`'s own
                   ///< stencil: PP p,q; PE p,a,b; PT p,a,b,c; EE a0,a1,b0,b1; unused
                   ///< entries are -1
    double d_sq;   ///< squared distance of the two primitives, m^2; 0 only if they touch
};

namespace detail {

NOLI_HD inline ClosestFeature point_point_feature(const Stencil<4>& s, int p, int q) {
    return {PairKind::PointPoint, {p, q, -1, -1}, norm_sq(s.x[p] - s.x[q])};
}

/// Nearest feature of segment a b (two stencil positions) to point p (another).
template <class Stage>
NOLI_HD inline ClosestFeature point_segment_feature(
    const Stencil<4>& s, int p, int a, int b, Stage& stage) {
    const Vec3d e = s.x[b] - s.x[a];
    const double length_sq = norm_sq(e);
    const double along = dot(s.x[p] - s.x[a], e);
    if (!(along > 0.0)) return point_point_feature(s, p, a);
    if (!(along < length_sq)) return point_point_feature(s, p, b);
    const double d_sq =
        norm_sq(cross_of_edges(s.x[a], s.x[p], s.x[a], s.x[b], stage)) / length_sq;
    const auto touches = [&] { return point_on_segment(s.x[p], s.x[a], s.x[b]); };
    if (d_sq == 0.0 && !stage.refined(true, touches)) {
        const ClosestFeature at_a = point_point_feature(s, p, a);
        const ClosestFeature at_b = point_point_feature(s, p, b);
        return at_b.d_sq < at_a.d_sq ? at_b : at_a;
    }
    return {PairKind::PointEdge, {p, a, b, -1}, d_sq};
}

NOLI_HD inline const ClosestFeature& nearer(const ClosestFeature& first,
                                            const ClosestFeature& second) {
    return second.d_sq < first.d_sq ? second : first;
}

/// Point-point pairs of two edges name the point of edge a first.
NOLI_HD inline ClosestFeature edge_a_first(ClosestFeature f) {
    if (f.kind == PairKind::PointPoint && f.local[0] > f.local[1]) {
        const int first = f.local[1];
        f.local[1] = f.local[0];
        f.local[0] = first;
    }
    return f;
}

}  // namespace detail

/// Closest features of point p and triangle a b c (order p, a, b, c).
template <class Stage = Exactly>
NOLI_HD inline ClosestFeature classify_point_triangle(const Stencil<4>& s,
                                                      Stage&& stage = {}) {
    const Vec3d& p = s.x[0];
    const Vec3d& a = s.x[1];
    const Vec3d& b = s.x[2];
    const Vec3d& c = s.x[3];
    const Vec3d N = cross_of_edges(a, b, a, c, stage);
    const double n_sq = norm_sq(N);
    const bool inside = n_sq > 0.0 && dot(cross_of_edges(a, b, a, p, stage), N) > 0.0
                     && dot(cross_of_edges(b, c, b, p, stage), N) > 0.0
                     && dot(cross_of_edges(c, a, c, p, stage), N) > 0.0;
    if (inside) {
        const double volume = orient3d_value(a, b, c, p, stage);
        const auto touches = [&] { return point_on_triangle(p, a, b, c); };
        if (volume != 0.0 || stage.refined(true, touches))
            return {PairKind::PointTriangle, {0, 1, 2, 3}, volume * volume / n_sq};
    }
    using detail::nearer;
    using detail::point_segment_feature;
    return nearer(nearer(point_segment_feature(s, 0, 1, 2, stage),
                         point_segment_feature(s, 0, 2, 3, stage)),
                  point_segment_feature(s, 0, 3, 1, stage));
}

/// Closest features of the edges a0 a1 and b0 b1 (order a0, a1, b0, b1).
template <class Stage = Exactly>
NOLI_HD inline ClosestFeature classify_edge_edge(const Stencil<4>& s,
                                                 Stage&& stage = {}) {
    const Vec3d& a0 = s.x[0];
    const Vec3d& a1 = s.x[1];
    const Vec3d& b0 = s.x[2];
    const Vec3d& b1 = s.x[3];
    const Vec3d N = cross_of_edges(a0, a1, b0, b1, stage);
    const double n_sq = norm_sq(N);
    if (n_sq > 0.0) {
        const double sigma = dot(cross_of_edges(b0, b1, b0, a0, stage), N);
        const double tau = dot(cross_of_edges(a0, a1, b0, a0, stage), N);
        if (sigma > 0.0 && sigma < n_sq && tau > 0.0 && tau < n_sq) {
            const double volume = orient3d_value(a0, a1, b0, b1, stage);
            const auto touch = [&] { return segments_intersect_3d(a0, a1, b0, b1); };
            if (volume != 0.0 || stage.refined(true, touch))
                return {PairKind::EdgeEdge, {0, 1, 2, 3}, volume * volume / n_sq};
        }
    }
    using detail::nearer;
    using detail::point_segment_feature;
    const ClosestFeature ends_a = nearer(point_segment_feature(s, 0, 2, 3, stage),
                                         point_segment_feature(s, 1, 2, 3, stage));
    const ClosestFeature ends_b = nearer(point_segment_feature(s, 2, 0, 1, stage),
                                         point_segment_feature(s, 3, 0, 1, stage));
    return detail::edge_a_first(nearer(ends_a, ends_b));
}

/// The points of feature f, in the order of its kind, from its parent's stencil.
template <int S>
NOLI_HD inline Stencil<S> feature_stencil(const Stencil<4>& s, const ClosestFeature& f) {
    Stencil<S> out;
    for (int i = 0; i < S; ++i)
        out.x[i] = s.x[f.local[i]];
    return out;
}

/// Unit vector from the second primitive's closest point to the first's features, or 0
/// where the distance is 0. The sign is that of f's own stencil order, so it may point
/// either way.
template <class Stage = Exactly>
NOLI_HD inline Vec3d feature_normal(const Stencil<4>& s,
                                    const ClosestFeature& f,
                                    Stage&& stage = {}) {
    switch (f.kind) {
        case PairKind::PointPoint:
            return point_point_geometry(feature_stencil<2>(s, f)).n;
        case PairKind::PointEdge:
            return point_edge_geometry(feature_stencil<3>(s, f), stage).n;
        case PairKind::PointTriangle:
            return point_triangle_geometry(s, stage).n;
        case PairKind::EdgeEdge:
            break;
    }
    return edge_edge_geometry(s, stage).n;
}

}  // namespace noli
