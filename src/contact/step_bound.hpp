// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Largest step along a direction in which no candidate pair uses up more than a given
/// part of its gap.
///
/// The answer is the smallest bound of all candidates, and most bounds do not matter. So
/// a sparse sample is advanced first, its smallest bound becomes the end of the motion
/// for a denser one, and so on: most pairs then reach the shortened end at once. The
/// samples depend on the candidates' order alone.
///
/// Source: MATH 8.5 (pairs), MATH 6 (half-spaces).

#include "contact/candidates.hpp"
#include "contact/collision_mesh.hpp"
#include "exec/later.hpp"
#include "geometry/ccd.hpp"

#include <array>
#include <cmath>

namespace noli {

/// A step that is safe for every candidate, and the pair that limits it.
struct StepBound {
    enum class Limit { None, VertexTriangle, EdgeEdge, Plane, NotFinite };

    double alpha;  ///< in [0, alpha_max]; all of it without a limit
    Limit limit;   ///< which list of candidates the limiting pair is from
    /// Its vertices: vertex and triangle; both edges; vertex, plane index, -1, -1;
    /// NotFinite: vertex, -1, -1, -1; else all -1.
    Int4 vertices;
    bool capped;  ///< its iteration cap was reached: alpha is safe, but may be short
    AdvanceEnd reason;  ///< why the limiting pair ends there; tells also why alpha is 0
};

/// Buffers of step_bound, kept between calls.
template <class Exec>
struct StepBoundWork {
    typename Exec::template Buffer<Advance> advances;
};

namespace detail {

/// One motion of all candidates.
struct CandidateMotion {
    CollisionMeshView mesh;
    View<const Int2> vertex_triangle;
    View<const Int2> edge_edge;
    View<const Int2> vertex_plane;
    View<const Vec3d> x;
    View<const Vec3d> p;
    AdvanceParams params;

    [[nodiscard]] NOLI_HD int size() const {
        return vertex_triangle.size + edge_edge.size + vertex_plane.size;
    }
    /// Candidates are numbered through: vertex-triangle, edge-edge, vertex-plane.
    [[nodiscard]] NOLI_HD StepBound::Limit list_of(int i) const {
        if (i < vertex_triangle.size) return StepBound::Limit::VertexTriangle;
        if (i < vertex_triangle.size + edge_edge.size) return StepBound::Limit::EdgeEdge;
        return StepBound::Limit::Plane;
    }
    [[nodiscard]] NOLI_HD Int4 vertices_of(int i) const {
        if (i < vertex_triangle.size) {
            const Int3& t = mesh.triangles[vertex_triangle[i][1]];
            return {vertex_triangle[i][0], t[0], t[1], t[2]};
        }
        i -= vertex_triangle.size;
        if (i < edge_edge.size) {
            const Int2& a = mesh.edges[edge_edge[i][0]];
            const Int2& b = mesh.edges[edge_edge[i][1]];
            return {a[0], a[1], b[0], b[1]};
        }
        const Int2& pair = vertex_plane[i - edge_edge.size];
        return {pair[0], pair[1], -1, -1};
    }
    /// First candidate of a list.
    [[nodiscard]] int begin_of(StepBound::Limit list) const {
        if (list == StepBound::Limit::VertexTriangle) return 0;
        if (list == StepBound::Limit::EdgeEdge) return vertex_triangle.size;
        return vertex_triangle.size + edge_edge.size;
    }
    /// Of candidate i, which is from List.
    template <StepBound::Limit List, class Stage>
    [[nodiscard]] NOLI_HD Advance advance(int i, double t_max, Stage& stage) const {
        const Int4 v = vertices_of(i);
        if constexpr (List == StepBound::Limit::Plane) {
            const CollisionMesh::Plane& plane = mesh.planes[v[1]];
            const double distance =
                plane_distance(plane, x[v[0]]) - params.min_separation;
            return advance_half_space(
                distance, dot(plane.normal, p[v[0]]), params.slack, t_max);
        }
        const Stencil<4> from{{x[v[0]], x[v[1]], x[v[2]], x[v[3]]}};
        const Stencil<4> along{{p[v[0]], p[v[1]], p[v[2]], p[v[3]]}};
        if constexpr (List == StepBound::Limit::VertexTriangle)
            return advance_point_triangle(from, along, t_max, params, stage);
        return advance_edge_edge(from, along, t_max, params, stage);
    }
};

/// Advances candidate i from List.
template <StepBound::Limit List>
struct CandidateAdvance {
    static constexpr Advance kUndecided{-1.0, 0, false, AdvanceEnd::Undecided};
    CandidateMotion motion;
    View<Advance> advances;
    int i;
    double t_max;

    template <class Stage>
    NOLI_HD void operator()(Stage& stage) const {
        const Advance advance = motion.advance<List>(i, t_max, stage);
        advances[i] = stage.enough() ? advance : kUndecided;
    }
};

/// Bound of an advance that did not get to the end of the motion; infinite for one that
/// did, negative for one that is undecided.
NOLI_HD inline double limit_of(const Advance& advance) {
    return advance.reason == AdvanceEnd::Free ? INFINITY : advance.t;
}

/// Every stride-th candidate; those of the sample before (done_stride a multiple of
/// stride; 0: none) keep their result.
struct Sample {
    int stride;
    int done_stride;
};

/// The end of a motion that is shortened while it is looked at: the smallest bound so
/// far, at `limit` in the memory of the executor (nullptr: none yet), and no more than
/// alpha.
struct MotionEnd {
    double alpha;
    const double* limit;

    [[nodiscard]] NOLI_HD double now() const {
        return limit == nullptr ? alpha : std::fmin(*limit, alpha);
    }
};

/// The candidates of a sample that are in [begin, end) and from List. Where nothing is
/// left of the motion, nothing more can limit it.
template <StepBound::Limit List, Doubles How, class Exec>
void advance_list(Exec& exec,
                  CandidateMotion motion,
                  Sample sample,
                  int begin,
                  int end,
                  MotionEnd motion_end,
                  View<Advance> advances) {
    const int first = (begin + sample.stride - 1) / sample.stride;
    const int last = (end + sample.stride - 1) / sample.stride;
    exec.for_each(
        "contact/advance_list",
        last - first,
        [=] NOLI_HD(int k) {
            const int i = (first + k) * sample.stride;
            if (sample.done_stride != 0 && i % sample.done_stride == 0) return;
            const double t_max = motion_end.now();
            if (t_max > 0.0)
                evaluate<How>(CandidateAdvance<List>{motion, advances, i, t_max});
            else
                advances[i] = {t_max, 0, false, AdvanceEnd::Free};
        },
        16);
}

/// Advances the candidates of a sample, one loop per list: on a GPU a matter of
/// registers. The number is the smallest bound so far, infinite without one.
template <Doubles How, class Exec>
Later advance_sample(Exec& exec,
                     CandidateMotion motion,
                     Sample sample,
                     MotionEnd end,
                     View<Advance> advances) {
    using List = StepBound::Limit;
    const int edge_edge = motion.begin_of(List::EdgeEdge);
    const int plane = motion.begin_of(List::Plane);
    advance_list<List::VertexTriangle, How>(
        exec, motion, sample, 0, edge_edge, end, advances);
    advance_list<List::EdgeEdge, How>(
        exec, motion, sample, edge_edge, plane, end, advances);
    advance_list<List::Plane, How>(
        exec, motion, sample, plane, motion.size(), end, advances);
    const int n = (motion.size() + sample.stride - 1) / sample.stride;
    return exec.min_later("contact/smallest_bound", n, [=] NOLI_HD(int k) {
        return limit_of(advances[k * sample.stride]);
    });
}

/// First candidate that ends the motion; infinite if none does.
template <class Exec>
Later first_with_limit(Exec& exec, MotionEnd end, View<const Advance> advances) {
    return exec.min_later("contact/first_with_limit", advances.size, [=] NOLI_HD(int i) {
        return limit_of(advances[i]) == end.now() ? double(i) : INFINITY;
    });
}

/// First vertex with a NaN or infinity in x or p, which no box would find; infinite if
/// all are finite.
template <class Exec>
Later first_not_finite(Exec& exec, View<const Vec3d> x, View<const Vec3d> p) {
    return exec.min_later("contact/first_not_finite", x.size, [=] NOLI_HD(int i) {
        double zero = 0.0;  // NaN as soon as a term is NaN or infinite
        for (int k = 0; k < 3; ++k)
            zero += 0.0 * x[i][k] + 0.0 * p[i][k];
        return zero == 0.0 ? INFINITY : double(i);
    });
}

/// Vertices of candidate *first, whether its advance was capped, why it ends.
template <class Exec>
std::array<Later, 6> limiting_candidate(Exec& exec,
                                        CandidateMotion motion,
                                        const double* first,
                                        View<const Advance> advances) {
    return exec.template numbers_later<6>("contact/name", [=] NOLI_HD(double* to) {
        if (!(*first < INFINITY)) return;
        const int i = static_cast<int>(*first);
        const Int4 v = motion.vertices_of(i);
        for (int k = 0; k < 4; ++k)
            to[k] = v[k];
        to[4] = advances[i].capped ? 1.0 : 0.0;
        to[5] = static_cast<double>(advances[i].reason);
    });
}

/// The step bound of at least one candidate. alpha is negative if one is undecided.
template <Doubles How, class Exec>
StepBound bound_of_candidates(Exec& exec,
                              const CandidateMotion& motion,
                              double alpha_max,
                              StepBoundWork<Exec>& work) {
    work.advances.resize(motion.size());
    const View<Advance> advances = work.advances.view();
    MotionEnd end{alpha_max, nullptr};
    Later limit;
    int done_stride = 0;
    for (const int stride : {64, 8, 1}) {
        limit = advance_sample<How>(exec, motion, {stride, done_stride}, end, advances);
        end.limit = exec.place(limit);
        done_stride = stride;
    }
    const Later first = first_with_limit(exec, end, View<const Advance>(advances));
    const auto name = limiting_candidate(
        exec, motion, exec.place(first), View<const Advance>(advances));
    const double alpha = std::fmin(exec.value(limit), alpha_max);
    if (!(exec.value(first) < INFINITY))
        return {
            alpha, StepBound::Limit::None, {{-1, -1, -1, -1}}, false, AdvanceEnd::Free};
    StepBound out{alpha, motion.list_of(static_cast<int>(exec.value(first))), {}, {}, {}};
    for (int k = 0; k < 4; ++k)
        out.vertices[k] = static_cast<int>(exec.value(name[static_cast<std::size_t>(k)]));
    out.capped = exec.value(name[4]) != 0.0;
    out.reason = static_cast<AdvanceEnd>(static_cast<int>(exec.value(name[5])));
    return out;
}

/// The same, decided.
template <class Exec>
StepBound bound_of_candidates(Exec& exec,
                              const CandidateMotion& motion,
                              double alpha_max,
                              StepBoundWork<Exec>& work) {
    if constexpr (Exec::kIsDevice) {
        const StepBound out =
            bound_of_candidates<Doubles::Only>(exec, motion, alpha_max, work);
        if (!(out.alpha < 0.0)) return out;
    }
    return bound_of_candidates<Doubles::First>(exec, motion, alpha_max, work);
}

}  // namespace detail

/// Largest alpha in [0, alpha_max] such that in the motion x + t p, t in [0, alpha],
/// every candidate keeps 1 - params.slack of its distance above params.min_separation.
///
/// In:   x, p (num_vertices) m; alpha_max > 0
/// Out:  alpha is 0 only if limit names a pair or vertex and reason says why (already
/// closed, a gap below
///       rounding, input that is not finite). Of several pairs with the same bound one is
///       named, the same for every executor and thread count.
template <class Exec>
StepBound step_bound(Exec& exec,
                     const DeviceCollisionMesh<Exec>& mesh,
                     const Candidates<Exec>& candidates,
                     View<const Vec3d> x,
                     View<const Vec3d> p,
                     double alpha_max,
                     const AdvanceParams& params,
                     StepBoundWork<Exec>& work) {
    const Later not_finite = detail::first_not_finite(exec, x, p);
    const detail::CandidateMotion motion{mesh.view(),
                                         candidates.vertex_triangle.view(),
                                         candidates.edge_edge.view(),
                                         candidates.vertex_plane.view(),
                                         x,
                                         p,
                                         params};
    constexpr Int4 kNobody{{-1, -1, -1, -1}};
    StepBound out{alpha_max, StepBound::Limit::None, kNobody, false, AdvanceEnd::Free};
    if (motion.size() > 0)
        out = detail::bound_of_candidates(exec, motion, alpha_max, work);
    const double bad = exec.value(not_finite);
    if (bad < INFINITY)
        return {0.0,
                StepBound::Limit::NotFinite,
                {{static_cast<int>(bad), -1, -1, -1}},
                false,
                AdvanceEnd::NotFinite};
    return out;
}

}  // namespace noli
