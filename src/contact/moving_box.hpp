// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Boxes of primitives that stand still or move on straight lines.
///
/// Points move as x + t p, t in [0, alpha]. On one axis, "lowest point of A minus highest
/// point of B" is a concave function of t, so when it is >= gap at both ends of the
/// motion it is >= gap all along. A MovingBox therefore keeps the boxes at the two ends
/// instead of the hull of the sweep: what two primitives have in common of their motion
/// drops out, and fast bodies find no more pairs than slow ones.
///
/// The same holds along any direction, not the axes only: see stay_apart. Boxes are
/// floats rounded outwards (half the memory traffic); directions are tested in double.

#include "core/vec.hpp"
#include "core/view.hpp"

namespace noli {

/// Where points are at the start and at the end of a motion. Without `p` they stand
/// still.
struct Motion {
    View<const Vec3d> x;  ///< (num_vertices) m
    View<const Vec3d> p;  ///< (num_vertices) m, or empty
    double alpha;

    [[nodiscard]] NOLI_HD Vec3d end(int vertex) const {
        return x[vertex] + alpha * p[vertex];
    }
};

/// Axis-aligned box of points that stand still.
struct StaticBox {
    float lo[3];
    float hi[3];
};

/// Boxes of moving points at both ends of their motion.
struct MovingBox {
    StaticBox start;
    StaticBox end;
};

/// A float that is <= v: far below the double's own spacing matters nothing to a coarse
/// test.
NOLI_HD inline float round_down(double v) {
    const float f = static_cast<float>(v);
    return f - (std::fabs(f) * 1.2e-7F + 1e-37F);
}
/// A float that is >= v.
NOLI_HD inline float round_up(double v) {
    return -round_down(-v);
}

NOLI_HD inline StaticBox empty_static_box() {
    constexpr float kHuge = 3e38F;
    return {{kHuge, kHuge, kHuge}, {-kHuge, -kHuge, -kHuge}};
}
NOLI_HD inline void make_empty(StaticBox& box) {
    box = empty_static_box();
}
NOLI_HD inline void make_empty(MovingBox& box) {
    box = {empty_static_box(), empty_static_box()};
}

/// Grows the box by `gap` around the point. Always inline, as `load`: g++ has a budget
/// for a whole source, and when it was used up finding pairs took 17 % longer.
[[gnu::always_inline]] NOLI_HD inline void add_point(StaticBox& box,
                                                     const Vec3d& x,
                                                     double gap) {
    for (int k = 0; k < 3; ++k) {
        const float lo = round_down(x[k] - gap);
        const float hi = round_up(x[k] + gap);
        box.lo[k] = lo < box.lo[k] ? lo : box.lo[k];
        box.hi[k] = hi > box.hi[k] ? hi : box.hi[k];
    }
}
[[gnu::always_inline]] NOLI_HD inline void add_vertex(StaticBox& box,
                                                      const Motion& motion,
                                                      int vertex,
                                                      double gap) {
    add_point(box, motion.x[vertex], gap);
}
[[gnu::always_inline]] NOLI_HD inline void add_vertex(MovingBox& box,
                                                      const Motion& motion,
                                                      int vertex,
                                                      double gap) {
    add_point(box.start, motion.x[vertex], gap);
    add_point(box.end, motion.end(vertex), gap);
}

NOLI_HD inline void merge_into(StaticBox& box, const StaticBox& other) {
    for (int k = 0; k < 3; ++k) {
        box.lo[k] = other.lo[k] < box.lo[k] ? other.lo[k] : box.lo[k];
        box.hi[k] = other.hi[k] > box.hi[k] ? other.hi[k] : box.hi[k];
    }
}
NOLI_HD inline void merge_into(MovingBox& box, const MovingBox& other) {
    merge_into(box.start, other.start);
    merge_into(box.end, other.end);
}

/// False only if the boxes are apart on some axis. Touching counts as overlap.
NOLI_HD inline bool overlap(const StaticBox& a, const StaticBox& b) {
    return (a.lo[0] <= b.hi[0]) & (b.lo[0] <= a.hi[0]) & (a.lo[1] <= b.hi[1])
         & (b.lo[1] <= a.hi[1]) & (a.lo[2] <= b.hi[2]) & (b.lo[2] <= a.hi[2]);
}
/// False only if the boxes are apart on some axis, in the same order, at both ends.
NOLI_HD inline bool overlap(const MovingBox& a, const MovingBox& b) {
    bool hit = true;
    for (int k = 0; k < 3; ++k) {
        hit &= (a.start.lo[k] <= b.start.hi[k]) | (a.end.lo[k] <= b.end.hi[k]);
        hit &= (b.start.lo[k] <= a.start.hi[k]) | (b.end.lo[k] <= a.end.hi[k]);
    }
    return hit;
}

/// Vertex number k of a primitive given by its ids: int (a point), Int2 or Int3.
NOLI_HD inline int corner(int ids, int /*k*/) {
    return ids;
}
NOLI_HD inline int corner(const Int2& ids, int k) {
    return ids.v[k];
}
NOLI_HD inline int corner(const Int3& ids, int k) {
    return ids.v[k];
}
template <class Ids>
inline constexpr int kNumCorners = static_cast<int>(sizeof(Ids) / sizeof(int));

namespace detail {

/// The points of two primitives, A's first, at one time, seen from A's first point at the
/// start.
template <int kA, int kB>
struct PointsOfPair {
    Vec3d y[kA + kB];

    /// Lowest point of A minus highest of B (first), and the other way round, along n.
    [[nodiscard]] NOLI_HD Vec2d gaps_along(const Vec3d& n) const {
        double a_lo = dot(n, y[0]);
        double b_lo = dot(n, y[kA]);
        double a_hi = a_lo;
        double b_hi = b_lo;
        for (int i = 1; i < kA; ++i)
            widen(dot(n, y[i]), a_lo, a_hi);
        for (int i = kA + 1; i < kA + kB; ++i)
            widen(dot(n, y[i]), b_lo, b_hi);
        return {a_lo - b_hi, b_lo - a_hi};
    }
    static NOLI_HD void widen(double c, double& lo, double& hi) {
        lo = c < lo ? c : lo;
        hi = c > hi ? c : hi;
    }
    [[nodiscard]] NOLI_HD Vec3d centre_difference() const {
        Vec3d a = y[0];
        Vec3d b = y[kA];
        for (int i = 1; i < kA; ++i)
            a += y[i];
        for (int i = 1; i < kB; ++i)
            b += y[kA + i];
        return (1.0 / kA) * a - (1.0 / kB) * b;
    }
    /// Normal of the triangle, or of both edges.
    [[nodiscard]] NOLI_HD Vec3d normal() const {
        constexpr int kSecond = kA == 1 ? kA + kB - 1 : 1;  // end of the first direction
        constexpr int kFirst = kA == 1 ? kA : 0;
        return cross(y[kSecond] - y[kFirst], y[kA + 1] - y[kA]);
    }
};

template <class IdsA, class IdsB>
NOLI_HD inline PointsOfPair<kNumCorners<IdsA>, kNumCorners<IdsB>> points_of_pair(
    const Motion& motion, bool at_end, const IdsA& a, const IdsB& b) {
    constexpr int kA = kNumCorners<IdsA>;
    constexpr int kB = kNumCorners<IdsB>;
    const Vec3d origin = motion.x[corner(a, 0)];
    PointsOfPair<kA, kB> out;
    for (int i = 0; i < kA + kB; ++i) {
        const int vertex = i < kA ? corner(a, i) : corner(b, i - kA);
        out.y[i] = (at_end ? motion.end(vertex) : motion.x[vertex]) - origin;
    }
    return out;
}

/// gap >= wanted |n|, without a root.
NOLI_HD inline bool at_least(double gap, double wanted_sq_n_sq) {
    return gap > 0.0 && gap * gap >= wanted_sq_n_sq;
}

/// True if A stays `wanted` above B, or B above A, along n at both ends.
template <class Points>
NOLI_HD inline bool apart_along(
    const Points& start, const Points& end, bool moves, const Vec3d& n, double wanted) {
    const double bound = wanted * wanted * norm_sq(n);
    const Vec2d at_start = start.gaps_along(n);
    const bool a_above = at_least(at_start.x, bound);
    const bool b_above = at_least(at_start.y, bound);
    if (!moves || !(a_above || b_above)) return a_above || b_above;
    const Vec2d at_end = end.gaps_along(n);
    return at_least(a_above ? at_end.x : at_end.y, bound);
}

}  // namespace detail

/// True if along the line through the centres or along the common normal one primitive
/// stays at least `gap` above the other all along the motion: then their distance never
/// gets below `gap`. Meant for pairs whose boxes overlap: the coordinate axes are not
/// tried again. Ids: int and Int3, Int2 and Int2, or Int2 and Int3.
template <class IdsA, class IdsB>
NOLI_HD inline bool stay_apart(const Motion& motion,
                               const IdsA& a,
                               const IdsB& b,
                               double gap) {
    const bool moves = motion.p.size > 0;
    const auto start = detail::points_of_pair(motion, false, a, b);
    const auto end = moves ? detail::points_of_pair(motion, true, a, b) : start;
    // Room for the rounding of x + alpha p and of the products.
    constexpr int kB0 = kNumCorners<IdsA>;
    const double size = max_abs(motion.x[corner(a, 0)]) + max_abs(start.y[kB0])
                      + (moves ? max_abs(end.y[0]) + max_abs(end.y[kB0]) : 0.0);
    const double wanted = gap + 1e-14 * size;
    return detail::apart_along(start, end, moves, start.centre_difference(), wanted)
        || detail::apart_along(start, end, moves, start.normal(), wanted);
}

}  // namespace noli
