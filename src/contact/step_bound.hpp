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
/// Source: docs/theory/ccd.md (pairs), walls.md.

#include "contact/candidate_advance.hpp"
#include "exec/later.hpp"

#include <array>
#include <cmath>

namespace noli {

/// Buffers of step_bound, kept between calls.
template <class Exec>
struct StepBoundWork {
    typename Exec::template Buffer<Advance> advances;
};

namespace detail {

/// Bound of an advance that did not get to the end of the motion; infinite for one that
/// did, negative for one that is undecided.
NOLI_HD inline double limit_of(const Advance& advance) {
    return advance.reason == AdvanceEnd::Free ? INFINITY : advance.t;
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
    const int wall = motion.begin_of(List::Wall);
    advance_candidates<List::VertexTriangle, How>(
        exec, motion, sample, 0, edge_edge, end, advances);
    advance_candidates<List::EdgeEdge, How>(
        exec, motion, sample, edge_edge, wall, end, advances);
    advance_candidates<List::Wall, How>(
        exec, motion, sample, wall, motion.candidates.size(), end, advances);
    const int n = (motion.candidates.size() + sample.stride - 1) / sample.stride;
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
        const Int4 v = motion.candidates.vertices(i);
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
    work.advances.resize(motion.candidates.size());
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
    const detail::CandidateMotion motion{detail::view_of(mesh, candidates), x, p, params};
    constexpr Int4 kNobody{{-1, -1, -1, -1}};
    StepBound out{alpha_max, StepBound::Limit::None, kNobody, false, AdvanceEnd::Free};
    if (motion.candidates.size() > 0)
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
