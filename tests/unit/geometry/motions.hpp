// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Moving pairs for the tests of step bounds, and the truth about them.

#include "geometry/ccd.hpp"
#include "geometry/exact.hpp"
#include "unit/geometry/oracle.hpp"

#include <gtest/gtest.h>

namespace noli::test {

/// One kind of primitive pair: the function under test and the truths about it.
struct PointTriangle {
    static constexpr int kFirst = 1;
    static Advance advance(const Stencil<4>& x,
                           const Stencil<4>& p,
                           double t_max,
                           const AdvanceParams& a) {
        return advance_point_triangle(x, p, t_max, a);
    }
    static double distance(const Stencil<4>& s) {
        return std::sqrt(classify_point_triangle(s).d_sq);
    }
    static bool touch(const Stencil<4>& s) {
        return point_on_triangle(s.x[0], s.x[1], s.x[2], s.x[3]);
    }
};
struct EdgeEdge {
    static constexpr int kFirst = 2;
    static Advance advance(const Stencil<4>& x,
                           const Stencil<4>& p,
                           double t_max,
                           const AdvanceParams& a) {
        return advance_edge_edge(x, p, t_max, a);
    }
    static double distance(const Stencil<4>& s) {
        return std::sqrt(classify_edge_edge(s).d_sq);
    }
    static bool touch(const Stencil<4>& s) {
        return segments_intersect_3d(s.x[0], s.x[1], s.x[2], s.x[3]);
    }
};

inline Stencil<4> moved(const Stencil<4>& x, const Stencil<4>& p, double t) {
    Stencil<4> out;
    for (int i = 0; i < 4; ++i)
        out.x[i] = x.x[i] + t * p.x[i];
    return out;
}

struct Query {
    Stencil<4> x, p;
    AdvanceParams params;
};

/// Motions of the kinds that Newton produces: towards each other, sliding past at a small
/// gap, turning, common translation, no motion of some points.
inline Query random_query(Random& random, int first, bool degenerate) {
    Query q;
    q.x = degenerate ? degenerate_stencil(random) : random.stencil<4>();
    q.p = random.stencil<4>(random.log_uniform(-4, 1));
    const int kind = random.integer(0, 4);
    if (kind == 0) {
        const Vec3d towards = random.log_uniform(-2, 1) * (q.x.x[first] - q.x.x[0]);
        for (int i = 0; i < first; ++i)
            q.p.x[i] += towards;
    }
    if (kind == 1) {
        const Vec3d common = random.vec(random.log_uniform(0, 3));
        for (Vec3d& v : q.p.x)
            v += common;
    }
    if (kind == 2)
        for (int i = first; i < 4; ++i)
            q.p.x[i] = {0, 0, 0};
    if (kind == 3)
        for (int i = first; i < 4; ++i)
            q.p.x[i] = q.p.x[first];
    q.params.slack = random.chance(0.5) ? 0.8 : random.uniform(0.05, 0.95);
    return q;
}

/// What the coordinates may lose when x + t p is stored.
inline double rounding(const Query& q) {
    return 1e-14 * (size_of(q.x) + size_of(q.p));
}

/// The distance stays above the target at sampled times, and no sample touches, exactly.
template <class Pair>
void expect_safe(const Query& q, const Advance& a, int num_samples) {
    const double d0 = Pair::distance(q.x);
    const double gap = d0 - q.params.min_separation;
    const double target = q.params.min_separation + (1 - q.params.slack) * gap;
    for (int k = 1; k <= num_samples && a.t > 0; ++k) {
        const Stencil<4> y = moved(q.x, q.p, a.t * k / num_samples);
        ASSERT_FALSE(Pair::touch(y)) << "sample " << k;
        // Rounding has been reserved: the stored coordinates keep the target themselves.
        ASSERT_GE(Pair::distance(y), target * (1 - 1e-9)) << "sample " << k;
    }
}

}  // namespace noli::test
