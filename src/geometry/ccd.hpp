// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Continuous collision detection: how far a pair may move before too much of its gap is
/// used up.
///
/// Points move on straight lines, x(t) = x + t p. With d0 the initial distance, the
/// returned t satisfies, for every time in [0, t],
///
///     distance >= min_separation + (1 - slack) (d0 - min_separation)
///
/// Method: conservative advancement. At the current time take the closest features and
/// their unit normal n. For ANY unit n the distance is at least the gap between the
/// projections of the two primitives on n, and this gap is a minimum of linear functions
/// of time, so the time at which it falls to the target is a quotient, and no time before
/// it can violate the target. Move there, take the new normal, repeat. Each such step is
/// at least as long as the additive step (d - target) / l of MATH 8.5 (l: largest speed
/// of one primitive plus that of the other), which only sees speeds and not directions.
/// Correctness does not rest on the classification: a poor normal costs length only.
///
/// Rounding: the target is raised by a bound on what storing x + t p in doubles may take
/// away. Source: MATH 8.5 for the target, the mean motion and the speed bound.

#include "core/stencil.hpp"
#include "geometry/aabb.hpp"
#include "geometry/closest_feature.hpp"

#include <cmath>
#include <cstdint>

namespace noli {

struct AdvanceParams {
    double slack = 0.8;           ///< fraction of the gap that may be used up, in (0, 1)
    double min_separation = 0.0;  ///< distance never to be entered, m; >= 0
    int max_iterations = 1000;    ///< > 0; if reached, the safe time so far is returned
};

/// Why an advance ended where it did.
enum class AdvanceEnd : std::uint8_t {
    Free,             ///< t == t_max
    GapUsed,          ///< going on would use up more than `slack` of the gap
    IterationCap,     ///< max_iterations reached; t is safe but may be short
    InitiallyClosed,  ///< t == 0: the initial distance does not exceed min_separation
    BelowRounding,  ///< t == 0: the gap is no larger than the rounding of the coordinates
    NotFinite,      ///< t == 0: a NaN or infinity in the input
    Undecided,      ///< nothing is known: doubles did not suffice (geometry/stages.hpp)
};

struct Advance {
    double t;        ///< largest time found to be safe, in [0, t_max]
    int iterations;  ///< classifications made; 0 when a speed bound was enough
    bool capped;     ///< reason == IterationCap
    AdvanceEnd reason;
};

namespace detail {

/// Motion of a pair without its mean, and bounds on it.
///
/// The distance of the stored points x + t p is off by at most x_rounding + t p_rounding.
/// The second term acts like a closing speed and is part of every closing speed below.
struct RelativeMotion {
    Stencil<4> p;
    double closing_speed;  ///< fastest point of one side plus fastest of the other, m
    double x_rounding;     ///< m
    double p_rounding;     ///< m
};

/// `first`: number of leading points that form the first primitive.
NOLI_HD inline RelativeMotion relative_motion(const Stencil<4>& x,
                                              const Stencil<4>& p,
                                              int first) {
    const Vec3d mean = 0.25 * (p.x[0] + p.x[1] + p.x[2] + p.x[3]);
    RelativeMotion out;
    double speed_sq[2] = {0.0, 0.0};
    double x_size = 0.0;
    double p_size = 0.0;
    for (int i = 0; i < 4; ++i) {
        out.p.x[i] = p.x[i] - mean;
        double& fastest = speed_sq[i < first ? 0 : 1];
        fastest = greater(fastest, norm_sq(out.p.x[i]));
        x_size = greater(x_size, size_1(x.x[i]));
        p_size = greater(p_size, size_1(p.x[i]));
    }
    out.x_rounding = 16.0 * kUnitRoundoff * x_size;
    out.p_rounding = 32.0 * kUnitRoundoff * p_size;
    out.closing_speed = std::sqrt(speed_sq[0]) + std::sqrt(speed_sq[1]) + out.p_rounding;
    return out;
}

NOLI_HD inline bool is_finite(const Stencil<4>& s) {
    double zero = 0.0;  // stays 0 unless a coordinate is NaN or infinite
    for (int i = 0; i < 4; ++i)
        for (int c = 0; c < 3; ++c)
            zero += s.x[i][c] - s.x[i][c];
    return zero == 0.0;
}

NOLI_HD inline Stencil<4> moved(const Stencil<4>& x, const Stencil<4>& p, double t) {
    Stencil<4> out;
    for (int i = 0; i < 4; ++i)
        out.x[i] = x.x[i] + t * p.x[i];
    return out;
}

/// Largest step for which the projections on n stay `target` apart: every pair of points,
/// one of each primitive, bounds it by one division. Not positive if they are closer than
/// that now.
NOLI_HD inline double directional_step(const Stencil<4>& y,
                                       const RelativeMotion& motion,
                                       int first,
                                       Vec3d n,
                                       double target) {
    const Vec3d across = (y.x[0] + y.x[first - 1]) - (y.x[first] + y.x[3]);
    if (dot(across, n) < 0.0) n = -n;
    double step = INFINITY;
    for (int i = 0; i < first; ++i) {
        for (int j = first; j < 4; ++j) {
            const double room = dot(y.x[i] - y.x[j], n) - target;
            const double closing =
                dot(motion.p.x[j] - motion.p.x[i], n) + motion.p_rounding;
            if (!(room > 0.0)) return 0.0;
            if (closing > 0.0) step = lesser(step, room / closing);
        }
    }
    return step;
}

/// Distance that the boxes of the two primitives keep; a cheap lower bound.
NOLI_HD inline double box_distance(const Stencil<4>& x, int first) {
    Aabb a = aabb_of_point(x.x[0]);
    Aabb b = aabb_of_point(x.x[3]);
    if (first == 2) a = merged(a, x.x[1]);
    if (first == 1) b = merged(b, x.x[1]);
    b = merged(b, x.x[2]);
    return std::sqrt(distance_sq(a, b));
}

template <PairKind Parent, class Stage>
NOLI_HD inline ClosestFeature classify(const Stencil<4>& s, Stage& stage) {
    if constexpr (Parent == PairKind::PointTriangle)
        return classify_point_triangle(s, stage);
    else
        return classify_edge_edge(s, stage);
}

/// Decides when going on is not worth it: the usable gap is all but gone and steps have
/// become small against the time reached. One such step is not enough, for the pair may
/// be about to part again.
struct Arrival {
    static constexpr double kSmallStep = 1e-2;  ///< of the time reached
    static constexpr double kNear = 1e-2;       ///< of the usable gap
    static constexpr double kThere = 1e-6;      ///< of the usable gap
    static constexpr int kPatience = 4;
    int small_steps = 0;

    NOLI_HD bool after_step(double step, double t, double left, double usable) {
        const bool small = left <= kNear * usable && step <= kSmallStep * t;
        small_steps = small ? small_steps + 1 : 0;
        return small_steps == kPatience || (small && left <= kThere * usable);
    }
};

/// Distances are good to 3e-10 relative; leave this much room for that.
inline constexpr double kDistanceTolerance = 4e-10;

template <PairKind Parent, class Stage>
NOLI_HD inline Advance advance_by_normals(const Stencil<4>& x,
                                          const RelativeMotion& motion,
                                          double t_max,
                                          const AdvanceParams& params,
                                          Stage& stage) {
    constexpr int kFirst = Parent == PairKind::PointTriangle ? 1 : 2;
    double t = 0.0;
    double target_t0 = 0.0;
    double usable = 0.0;
    Arrival arrival;
    for (int k = 1; k <= params.max_iterations; ++k) {
        const Stencil<4> y = moved(x, motion.p, t);
        const ClosestFeature f = classify<Parent>(y, stage);
        const Vec3d n = feature_normal(y, f, stage);
        if (!stage.enough()) break;
        const double d = std::sqrt(f.d_sq);
        if (k == 1) {
            const double gap = d - params.min_separation;
            if (!(gap > 0.0)) return {0.0, k, false, AdvanceEnd::InitiallyClosed};
            usable = params.slack * gap;
            target_t0 = d * (1.0 + kDistanceTolerance) - usable + motion.x_rounding;
        }
        const double target = target_t0 + t * motion.p_rounding;
        const double left = d * (1.0 - kDistanceTolerance) - target;
        double step = directional_step(y, motion, kFirst, n, target);
        if (!(step > 0.0))
            step = left / motion.closing_speed;  // a normal spoilt by rounding
        if (!(step > 0.0))
            return {
                t, k, false, t > 0.0 ? AdvanceEnd::GapUsed : AdvanceEnd::BelowRounding};
        if (t + step >= t_max) return {t_max, k, false, AdvanceEnd::Free};
        t += step;
        if (arrival.after_step(step, t, left, usable))
            return {t, k, false, AdvanceEnd::GapUsed};
    }
    return {t, params.max_iterations, true, AdvanceEnd::IterationCap};
}

template <PairKind Parent, class Stage>
NOLI_HD inline Advance advance(const Stencil<4>& x,
                               const Stencil<4>& p,
                               double t_max,
                               const AdvanceParams& params,
                               Stage& stage) {
    constexpr int kFirst = Parent == PairKind::PointTriangle ? 1 : 2;
    if (!is_finite(x) || !is_finite(p)) return {0.0, 0, false, AdvanceEnd::NotFinite};
    const RelativeMotion motion = relative_motion(x, p, kFirst);
    const double far_gap = box_distance(x, kFirst) - params.min_separation;
    const double approach = t_max * motion.closing_speed + motion.x_rounding;
    if (far_gap > 0.0 && approach <= params.slack * far_gap * (1.0 - kDistanceTolerance))
        return {t_max, 0, false, AdvanceEnd::Free};
    return advance_by_normals<Parent>(x, motion, t_max, params, stage);
}

}  // namespace detail

/// Point p against triangle a b c (order p, a, b, c), moving by t * p over t in [0,
/// t_max], t_max > 0. A point against an edge or a point: repeat the last point.
template <class Stage = Exactly>
NOLI_HD inline Advance advance_point_triangle(const Stencil<4>& x,
                                              const Stencil<4>& p,
                                              double t_max,
                                              const AdvanceParams& params,
                                              Stage&& stage = {}) {
    return detail::advance<PairKind::PointTriangle>(x, p, t_max, params, stage);
}

/// Edge a0 a1 against edge b0 b1 (order a0, a1, b0, b1); the rest as in
/// advance_point_triangle.
template <class Stage = Exactly>
NOLI_HD inline Advance advance_edge_edge(const Stencil<4>& x,
                                         const Stencil<4>& p,
                                         double t_max,
                                         const AdvanceParams& params,
                                         Stage&& stage = {}) {
    return detail::advance<PairKind::EdgeEdge>(x, p, t_max, params, stage);
}

/// Point p against edge a b (order p, a, b); otherwise as advance_point_triangle.
NOLI_HD inline Advance advance_point_edge(const Stencil<3>& x,
                                          const Stencil<3>& p,
                                          double t_max,
                                          const AdvanceParams& params) {
    return advance_point_triangle({{x.x[0], x.x[1], x.x[2], x.x[2]}},
                                  {{p.x[0], p.x[1], p.x[2], p.x[2]}},
                                  t_max,
                                  params);
}

/// Point p against point q; otherwise as advance_point_triangle.
NOLI_HD inline Advance advance_point_point(const Stencil<2>& x,
                                           const Stencil<2>& p,
                                           double t_max,
                                           const AdvanceParams& params) {
    return advance_point_triangle({{x.x[0], x.x[1], x.x[1], x.x[1]}},
                                  {{p.x[0], p.x[1], p.x[1], p.x[1]}},
                                  t_max,
                                  params);
}

}  // namespace noli
