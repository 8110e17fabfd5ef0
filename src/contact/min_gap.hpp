// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Smallest distance among the active pairs, and the pair that has it.

#include "contact/pairs.hpp"

#include <cmath>

namespace noli {

/// For reports: which pair is closest.
struct MinGap {
    enum class Kind {
        None,
        PointPoint,
        PointEdge,
        PointTriangle,
        EdgeEdge,
        Mollified,
        Wall
    };

    double gap;  ///< m; +infinity without pairs, not positive behind a wall
    Kind kind;
    Int4 vertices;  ///< of the pair; Wall: vertex, wall index; unused places -1
};

/// Buffers of min_gap, kept between calls.
template <class Exec>
struct MinGapWork {
    typename Exec::template Buffer<double> distances;
    typename Exec::template Buffer<MinGap> closest;
};

namespace detail {

/// The lists of a PairSet for reading, pairs numbered through in the order of the lists.
struct PairSetReader {
    View<const Int2> pp;
    View<const Int3> pe;
    View<const Int4> pt;
    View<const Int4> ee;
    View<const MollifiedPair> mollified;
    View<const Int2> walls;
    View<const Wall> shapes;

    [[nodiscard]] NOLI_HD int size() const {
        return pp.size + pe.size + pt.size + ee.size + mollified.size + walls.size;
    }
    /// Kind and vertices of pair i; gap is not set.
    [[nodiscard]] NOLI_HD MinGap name(int i) const {
        using Kind = MinGap::Kind;
        if (i < pp.size) return {0.0, Kind::PointPoint, {{pp[i][0], pp[i][1], -1, -1}}};
        i -= pp.size;
        if (i < pe.size)
            return {0.0, Kind::PointEdge, {{pe[i][0], pe[i][1], pe[i][2], -1}}};
        i -= pe.size;
        if (i < pt.size) return {0.0, Kind::PointTriangle, pt[i]};
        i -= pt.size;
        if (i < ee.size) return {0.0, Kind::EdgeEdge, ee[i]};
        i -= ee.size;
        if (i < mollified.size) return {0.0, Kind::Mollified, mollified[i].v};
        i -= mollified.size;
        return {0.0, Kind::Wall, {{walls[i][0], walls[i][1], -1, -1}}};
    }
};

template <class Exec>
PairSetReader reader_of(const DeviceCollisionMesh<Exec>& mesh,
                        const PairSet<Exec>& pairs) {
    return {pairs.pp.view(),
            pairs.pe.view(),
            pairs.pt.view(),
            pairs.ee.view(),
            pairs.mollified.view(),
            pairs.walls.view(),
            mesh.view().walls};
}

/// Distance of the primitives that a pair stands for, m; NaN where doubles do not
/// suffice. Classified anew: the closest features of an edge pair are the distance of its
/// edges.
struct PairDistance {
    PairSetReader pairs;
    View<const Vec3d> x;
    int i;

    template <class Stage>
    NOLI_HD double operator()(Stage& stage) const {
        const double distance = of(pairs.name(i), stage);
        return stage.enough() ? distance : NAN;
    }
    template <class Stage>
    NOLI_HD double of(const MinGap& pair, Stage& stage) const {
        const Int4& v = pair.vertices;
        switch (pair.kind) {
            case MinGap::Kind::PointPoint:
                return std::sqrt(point_point_distance_sq({{x[v[0]], x[v[1]]}}));
            case MinGap::Kind::PointEdge:
                return std::sqrt(
                    point_segment_feature(
                        {{x[v[0]], x[v[1]], x[v[2]], x[v[2]]}}, 0, 1, 2, stage)
                        .d_sq);
            case MinGap::Kind::PointTriangle:
                return std::sqrt(classify_point_triangle(stencil_at(x, v), stage).d_sq);
            case MinGap::Kind::EdgeEdge:
            case MinGap::Kind::Mollified:
                return std::sqrt(classify_edge_edge(stencil_at(x, v), stage).d_sq);
            case MinGap::Kind::Wall:
                return wall_distance(pairs.shapes[v[1]], x[v[0]]);
            case MinGap::Kind::None:
                break;
        }
        return INFINITY;
    }
};

template <Doubles How, class Exec>
void pair_distances(Exec& exec,
                    PairSetReader pairs,
                    View<const Vec3d> x,
                    View<double> distances) {
    exec.for_each(
        "contact/pair_distances",
        distances.size,
        [=] NOLI_HD(int i) {
            distances[i] = evaluate<How>(PairDistance{pairs, x, i});
        },
        32);
}

template <class Exec>
Later smallest_of(Exec& exec, View<const double> values) {
    return exec.min_later(
        "contact/smallest_of", values.size, [=] NOLI_HD(int i) { return values[i]; });
}

/// Smallest distance of the pairs; the distance of each stays in `work`.
template <class Exec>
Later smallest_gap_later(Exec& exec,
                         const PairSetReader& pairs,
                         Doubles doubles,
                         View<const Vec3d> x,
                         MinGapWork<Exec>& work) {
    work.distances.resize(pairs.size());
    with_constant<Exec>(doubles, [&](auto how) {
        pair_distances<decltype(how)::value>(exec, pairs, x, work.distances.view());
    });
    return smallest_of(exec, work.distances.view());
}

template <class Exec>
double first_place_of(Exec& exec, double value, View<const double> values) {
    return exec.min("contact/first_place_of", values.size, [=] NOLI_HD(int i) {
        return values[i] == value ? double(i) : INFINITY;
    });
}

/// out[0] = name of pair i
template <class Exec>
void name_pair(Exec& exec, PairSetReader pairs, int i, View<MinGap> out) {
    exec.for_each(
        "contact/name_pair", 1, [=] NOLI_HD(int /*only*/) { out[0] = pairs.name(i); });
}

}  // namespace detail

/// Smallest distance of the pairs at positions x, where they were found, m; +infinity
/// without pairs.
template <class Exec>
Later smallest_gap_later(Exec& exec,
                         const DeviceCollisionMesh<Exec>& mesh,
                         const PairSet<Exec>& pairs,
                         View<const Vec3d> x,
                         MinGapWork<Exec>& work) {
    return detail::smallest_gap_later(
        exec, detail::reader_of(mesh, pairs), pairs.doubles, x, work);
}

/// Smallest distance of the pairs at positions x, where they were found, and the first
/// pair that has it. A NaN distance gives gap NaN and kind None.
template <class Exec>
MinGap min_gap(Exec& exec,
               const DeviceCollisionMesh<Exec>& mesh,
               const PairSet<Exec>& pairs,
               View<const Vec3d> x,
               MinGapWork<Exec>& work) {
    const detail::PairSetReader reader = detail::reader_of(mesh, pairs);
    const double gap =
        exec.value(detail::smallest_gap_later(exec, reader, pairs.doubles, x, work));
    const double first = detail::first_place_of(exec, gap, work.distances.view());
    work.closest.resize(1);
    if (!(first < INFINITY)) return {gap, MinGap::Kind::None, {{-1, -1, -1, -1}}};
    detail::name_pair(exec, reader, static_cast<int>(first), work.closest.view());
    MinGap closest = exec.read(View<const MinGap>(work.closest.view()), 0);
    closest.gap = gap;
    return closest;
}

}  // namespace noli
