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
#include "geometry/ccd.hpp"

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
    typename Exec::template Buffer<Int4> vertices;
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
    [[nodiscard]] NOLI_HD Advance advance(int i, double t_max) const {
        const Int4 v = vertices_of(i);
        const StepBound::Limit list = list_of(i);
        if (list == StepBound::Limit::Plane) {
            const CollisionMesh::Plane& plane = mesh.planes[v[1]];
            const double distance =
                plane_distance(plane, x[v[0]]) - params.min_separation;
            return advance_half_space(
                distance, dot(plane.normal, p[v[0]]), params.slack, t_max);
        }
        const Stencil<4> from{{x[v[0]], x[v[1]], x[v[2]], x[v[3]]}};
        const Stencil<4> along{{p[v[0]], p[v[1]], p[v[2]], p[v[3]]}};
        if (list == StepBound::Limit::VertexTriangle)
            return advance_point_triangle(from, along, t_max, params);
        return advance_edge_edge(from, along, t_max, params);
    }
};

/// Bound of an advance that did not get to the end of the motion; infinite for one that
/// did.
NOLI_HD inline double limit_of(const Advance& advance) {
    return advance.reason == AdvanceEnd::Free ? INFINITY : advance.t;
}

/// Every stride-th candidate; those of the sample before (done_stride a multiple of
/// stride; 0: none) keep their result.
struct Sample {
    int stride;
    int done_stride;
};

/// Advances the candidates of a sample and returns the smallest bound so far, t_max
/// without one.
template <class Exec>
double advance_sample(Exec& exec,
                      CandidateMotion motion,
                      Sample sample,
                      double t_max,
                      View<Advance> advances) {
    const int n = (motion.size() + sample.stride - 1) / sample.stride;
    exec.for_each(
        "contact/advance_sample",
        n,
        [=] NOLI_HD(int k) {
            const int i = k * sample.stride;
            if (sample.done_stride == 0 || i % sample.done_stride != 0)
                advances[i] = motion.advance(i, t_max);
        },
        16);
    const double limit = exec.min("contact/smallest_bound", n, [=] NOLI_HD(int k) {
        return limit_of(advances[k * sample.stride]);
    });
    return std::fmin(limit, t_max);
}

/// First candidate of the sample with this bound; -1 if none has it.
template <class Exec>
int first_with_limit(Exec& exec, double limit, int stride, View<const Advance> advances) {
    const int n = (advances.size + stride - 1) / stride;
    const double first = exec.min("contact/first_with_limit", n, [=] NOLI_HD(int k) {
        return limit_of(advances[k * stride]) == limit ? double(k) : INFINITY;
    });
    return first < INFINITY ? static_cast<int>(first) * stride : -1;
}

/// First vertex with a NaN or infinity in x or p, which no box would find; -1 if all are
/// finite.
template <class Exec>
int first_not_finite(Exec& exec, View<const Vec3d> x, View<const Vec3d> p) {
    const double first = exec.min("contact/first_not_finite", x.size, [=] NOLI_HD(int i) {
        double zero = 0.0;  // NaN as soon as a term is NaN or infinite
        for (int k = 0; k < 3; ++k)
            zero += 0.0 * x[i][k] + 0.0 * p[i][k];
        return zero == 0.0 ? INFINITY : double(i);
    });
    return first < INFINITY ? static_cast<int>(first) : -1;
}

/// out[0] = vertices of candidate i
template <class Exec>
void name_vertices(Exec& exec, CandidateMotion motion, int i, View<Int4> out) {
    exec.for_each("contact/name_vertices", 1, [=] NOLI_HD(int /*only*/) {
        out[0] = motion.vertices_of(i);
    });
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
    const int bad = detail::first_not_finite(exec, x, p);
    if (bad >= 0)
        return {0.0,
                StepBound::Limit::NotFinite,
                {{bad, -1, -1, -1}},
                false,
                AdvanceEnd::NotFinite};
    const detail::CandidateMotion motion{mesh.view(),
                                         candidates.vertex_triangle.view(),
                                         candidates.edge_edge.view(),
                                         candidates.vertex_plane.view(),
                                         x,
                                         p,
                                         params};
    work.advances.resize(motion.size());
    work.vertices.resize(1);
    const View<Advance> advances = work.advances.view();
    const int strides[] = {0, 64, 8, 1};
    double alpha = alpha_max;
    int stride = 1;
    for (int k = 1; k < 4 && alpha > 0.0; ++k) {
        stride = strides[k];
        alpha = detail::advance_sample(
            exec, motion, {stride, strides[k - 1]}, alpha, advances);
    }
    const int i =
        detail::first_with_limit(exec, alpha, stride, View<const Advance>(advances));
    if (i < 0)
        return {
            alpha, StepBound::Limit::None, {{-1, -1, -1, -1}}, false, AdvanceEnd::Free};
    detail::name_vertices(exec, motion, i, work.vertices.view());
    const Advance limiting = exec.read(View<const Advance>(advances), i);
    const Int4 vertices = exec.read(View<const Int4>(work.vertices.view()), 0);
    return {alpha, motion.list_of(i), vertices, limiting.capped, limiting.reason};
}

}  // namespace noli
