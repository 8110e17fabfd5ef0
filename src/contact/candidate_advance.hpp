// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How far single candidates may move, and the loops over lists of them.
///
/// On the CPU most candidates are found free in packs (geometry/free_motion.hpp); the
/// others, and all on a device, are advanced one by one.

#include "contact/candidate_code.hpp"
#include "core/lane_load.hpp"
#include "exec/lanes.hpp"
#include "geometry/ccd.hpp"
#include "geometry/free_motion.hpp"
#include "geometry/wall_motion.hpp"

#include <cmath>

namespace noli {

/// A step that is safe for every candidate, and the pair that limits it.
struct StepBound {
    enum class Limit { None, VertexTriangle, EdgeEdge, Wall, NotFinite };

    double alpha;  ///< in [0, alpha_max]; all of it without a limit
    Limit limit;   ///< which list of candidates the limiting pair is from
    /// Its vertices: vertex and triangle; both edges; vertex, wall index, -1, -1;
    /// NotFinite: vertex, -1, -1, -1; else all -1.
    Int4 vertices;
    bool capped;  ///< its iteration cap was reached: alpha is safe, but may be short
    AdvanceEnd reason;  ///< why the limiting pair ends there; tells also why alpha is 0
};

namespace detail {

/// One motion of all candidates.
struct CandidateMotion {
    CandidateView candidates;
    View<const Vec3d> x;
    View<const Vec3d> p;
    AdvanceParams params;

    [[nodiscard]] NOLI_HD StepBound::Limit list_of(int i) const {
        if (candidates.is_vertex_triangle(i)) return StepBound::Limit::VertexTriangle;
        return candidates.is_wall(i) ? StepBound::Limit::Wall
                                     : StepBound::Limit::EdgeEdge;
    }
    /// First candidate of a list.
    [[nodiscard]] int begin_of(StepBound::Limit list) const {
        if (list == StepBound::Limit::VertexTriangle) return 0;
        const int edge_edge = candidates.vertex_triangle.size;
        if (list == StepBound::Limit::EdgeEdge) return edge_edge;
        return edge_edge + candidates.edge_edge.size;
    }
    /// Of candidate i, which is from List.
    template <StepBound::Limit List, class Stage>
    [[nodiscard]] NOLI_HD Advance advance(int i, double t_max, Stage& stage) const {
        const Int4 v = candidates.vertices(i);
        if constexpr (List == StepBound::Limit::Wall) {
            return advance_wall(
                candidates.mesh.walls[v[1]], x[v[0]], p[v[0]], t_max, params);
        }
        const Stencil<4> from = stencil_at(x, v);
        const Stencil<4> along = stencil_at(p, v);
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

/// Candidates of a sample, all from List: advances[i] of number k of them, i = (first +
/// k) * sample.stride. Where nothing is left of the motion, nothing more can limit it.
template <StepBound::Limit List, Doubles How>
struct SampleAdvance {
    CandidateMotion motion;
    Sample sample;
    int first;
    MotionEnd motion_end;
    View<Advance> advances;

    [[nodiscard]] NOLI_HD int candidate(int k) const {
        return (first + k) * sample.stride;
    }
    [[nodiscard]] NOLI_HD bool done(int i) const {
        return sample.done_stride != 0 && i % sample.done_stride == 0;
    }

    NOLI_HD void operator()(int k) const {
        const int i = candidate(k);
        if (done(i)) return;
        const double t_max = motion_end.now();
        if (t_max > 0.0)
            evaluate<How>(CandidateAdvance<List>{motion, advances, i, t_max});
        else
            advances[i] = {t_max, 0, false, AdvanceEnd::Free};
    }
};

/// The same in packs.
template <StepBound::Limit List, Doubles How>
struct SampleAdvanceKernel {
    SampleAdvance<List, How> one;

    template <class T>
    void operator()(Lane<T> lane) const {
        constexpr PairKind kParent = List == StepBound::Limit::VertexTriangle
                                       ? PairKind::PointTriangle
                                       : PairKind::EdgeEdge;
        const double t_max = one.motion_end.now();
        Int4 v[kLaneWidth<T>];
        for (int j = 0; j < kLaneWidth<T>; ++j)
            v[j] = one.motion.candidates.vertices(one.candidate(lane.first + j));
        Vec3<T> x[4];
        Vec3<T> p[4];
        for (int c = 0; c < 4; ++c) {
            x[c] = load_vec3_lanes<T>([&](int j) { return one.motion.x[v[j][c]]; });
            p[c] = load_vec3_lanes<T>([&](int j) { return one.motion.p[v[j][c]]; });
        }
        const T free =
            select(surely_free<kParent>(x, p, t_max, one.motion.params), T(1.0), T(0.0));
        for (int j = 0; j < kLaneWidth<T>; ++j) {
            const int i = one.candidate(lane.first + j);
            if (!(lane_of(free, j) > 0.0))
                rest(lane.first + j);
            else if (!one.done(i))
                one.advances[i] = {t_max, 0, false, AdvanceEnd::Free};
        }
    }

  private:
    /// Out of line: large, and for few.
    [[gnu::noinline]] void rest(int k) const { one(k); }
};

template <StepBound::Limit List, Doubles How, class Exec>
void advance_list(Exec& exec, int n, SampleAdvance<List, How> one) {
    exec.for_each(
        "contact/advance_list", n, [=] NOLI_HD(int k) { one(k); }, 16);
}

/// The candidates of a sample that are in [begin, end) and from List.
template <StepBound::Limit List, Doubles How, class Exec>
void advance_candidates(Exec& exec,
                        CandidateMotion motion,
                        Sample sample,
                        int begin,
                        int end,
                        MotionEnd motion_end,
                        View<Advance> advances) {
    const int first = (begin + sample.stride - 1) / sample.stride;
    const int n = (end + sample.stride - 1) / sample.stride - first;
    const SampleAdvance<List, How> one{motion, sample, first, motion_end, advances};
    if constexpr (Exec::kIsDevice || List == StepBound::Limit::Wall)
        advance_list(exec, n, one);
    else
        exec.for_lanes("contact/advance_lanes", n, SampleAdvanceKernel<List, How>{one});
}

}  // namespace detail

}  // namespace noli
