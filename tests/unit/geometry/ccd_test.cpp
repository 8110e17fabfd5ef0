// SPDX-License-Identifier: Apache-2.0
#include "geometry/ccd.hpp"

#include "unit/geometry/motions.hpp"

#include <gtest/gtest.h>

namespace noli::test {
namespace {

struct Tally {
    int ends[6] = {};
    int capped = 0;
    long iterations = 0;
    int most_iterations = 0;
    void add(const Advance& a) {
        ++ends[int(a.reason)];
        capped += a.capped;
        iterations += a.iterations;
        most_iterations = std::max(most_iterations, a.iterations);
    }
};

/// Where the gap ended the advance, nearly all that may be used was used, at the end or
/// shortly before.
template <class Pair>
void expect_not_short(const Query& q, const Advance& a) {
    if (a.reason != AdvanceEnd::GapUsed) return;
    const double gap = Pair::distance(q.x) - q.params.min_separation;
    const double target = q.params.min_separation + (1 - q.params.slack) * gap;
    double least = Pair::distance(moved(q.x, q.p, a.t));
    for (int k = 1; k <= 50; ++k)
        least = std::min(least, Pair::distance(moved(q.x, q.p, a.t * (1 - 0.001 * k))));
    ASSERT_LE(least - target, 0.0101 * q.params.slack * gap + rounding(q));
}

template <class Pair>
void run_queries(unsigned seed, bool degenerate) {
    Random random(seed);
    Tally tally;
    for (int trial = 0; trial < 100000; ++trial) {
        SCOPED_TRACE(trial);
        const Query q = random_query(random, Pair::kFirst, degenerate);
        const Advance a = Pair::advance(q.x, q.p, 1.0, q.params);
        tally.add(a);
        ASSERT_GE(a.t, 0.0);
        ASSERT_LE(a.t, 1.0);
        ASSERT_EQ(a.t == 0.0,
                  a.reason == AdvanceEnd::InitiallyClosed
                      || a.reason == AdvanceEnd::BelowRounding);
        if (a.reason == AdvanceEnd::InitiallyClosed) {
            ASSERT_TRUE(Pair::touch(q.x));
        }
        if (a.reason == AdvanceEnd::BelowRounding) {
            ASSERT_LE(Pair::distance(q.x), 20 * rounding(q));
        }
        expect_safe<Pair>(q, a, 24);
        expect_not_short<Pair>(q, a);
        if (testing::Test::HasFatalFailure()) return;
    }
    // Degenerate queries include gaps near rounding under motions 1e13 times as long.
    EXPECT_LE(tally.capped, degenerate ? 50 : 0);
    EXPECT_GT(tally.ends[int(AdvanceEnd::Free)], 1000);
    EXPECT_GT(tally.ends[int(AdvanceEnd::GapUsed)], 1000);
    std::printf(
        "free %d, gap used %d, closed %d, rounding %d; iterations: mean %.2f, most %d\n",
        tally.ends[0],
        tally.ends[1],
        tally.ends[3],
        tally.ends[4],
        double(tally.iterations) / 100000,
        tally.most_iterations);
}

TEST(Advance, PointTriangleIsSafeAndNotShortOnRandomQueries) {
    run_queries<PointTriangle>(21, false);
}
TEST(Advance, PointTriangleIsSafeAndNotShortOnDegenerateQueries) {
    run_queries<PointTriangle>(22, true);
}
TEST(Advance, EdgeEdgeIsSafeAndNotShortOnRandomQueries) {
    run_queries<EdgeEdge>(23, false);
}
TEST(Advance, EdgeEdgeIsSafeAndNotShortOnDegenerateQueries) {
    run_queries<EdgeEdge>(24, true);
}

/// Proves distance > bound on [lo, hi] by halving: the distance changes by at most speed
/// * time.
template <class Pair>
bool proven_above(
    const Query& q, double speed, double bound, double lo, double hi, int& budget) {
    const double middle = 0.5 * (lo + hi);
    const double d = Pair::distance(moved(q.x, q.p, middle));
    if (d <= bound) return false;
    if (d - speed * 0.5 * (hi - lo) > bound) return true;
    if (--budget < 0) return true;  // undecided
    return proven_above<Pair>(q, speed, bound, lo, middle, budget)
        && proven_above<Pair>(q, speed, bound, middle, hi, budget);
}

template <class Pair>
void prove_queries(unsigned seed) {
    Random random(seed);
    int undecided = 0;
    for (int trial = 0; trial < 5000; ++trial) {
        SCOPED_TRACE(trial);
        const Query q = random_query(random, Pair::kFirst, trial % 2 == 1);
        const Advance a = Pair::advance(q.x, q.p, 1.0, q.params);
        if (a.t == 0.0) continue;
        const double d0 = Pair::distance(q.x);
        double speed = 0;
        for (int i = 0; i < Pair::kFirst; ++i)
            for (int j = Pair::kFirst; j < 4; ++j)
                speed = std::max(speed, norm(q.p.x[i] - q.p.x[j]));
        int budget = 20000;
        // Half the target, so that the proof ends; between samples nothing passed
        // through.
        ASSERT_TRUE(proven_above<Pair>(
            q, speed, 0.5 * (1 - q.params.slack) * d0, 0.0, a.t, budget));
        undecided += budget < 0;
    }
    EXPECT_LT(undecided, 50);
}

// The speed bound holds because |(p_i - p_j)| over all pairs bounds the relative speed of
// any two points.
TEST(Advance, PointTriangleIsSafeAtEveryTimeByProof) {
    prove_queries<PointTriangle>(25);
}
TEST(Advance, EdgeEdgeIsSafeAtEveryTimeByProof) {
    prove_queries<EdgeEdge>(26);
}

template <class Pair>
void expect_free_when_parting(unsigned seed) {
    Random random(seed);
    for (int trial = 0; trial < 20000; ++trial) {
        SCOPED_TRACE(trial);
        Query q;
        q.x = random.stencil<4>();
        const Vec3d n = normalized(random.vec());
        double lowest = 1e9, highest = -1e9;
        for (int i = 0; i < Pair::kFirst; ++i)
            lowest = std::min(lowest, dot(q.x.x[i], n));
        for (int j = Pair::kFirst; j < 4; ++j)
            highest = std::max(highest, dot(q.x.x[j], n));
        for (int i = 0; i < Pair::kFirst; ++i)
            q.x.x[i] += (highest - lowest + random.log_uniform(-6, 0)) * n;
        const Vec3d common = random.vec(10.0);
        // Straight away from each other along the closest direction, plus a common
        // motion.
        const Stencil<4>& s = q.x;
        const ClosestFeature f =
            Pair::kFirst == 1 ? classify_point_triangle(s) : classify_edge_edge(s);
        Vec3d away = feature_normal(s, f);
        if (dot(away, n) < 0.0) away = -away;
        const double speed = trial % 2 ? 0.0 : random.log_uniform(-3, 2);
        for (int i = 0; i < 4; ++i)
            q.p.x[i] = common + (i < Pair::kFirst ? speed : 0.0) * away;
        const Advance a = Pair::advance(q.x, q.p, 0.75, q.params);
        ASSERT_EQ(a.t, 0.75);
        ASSERT_EQ(a.reason, AdvanceEnd::Free);
        ASSERT_LE(a.iterations, 1);
    }
}
TEST(Advance, PointTriangleIsFreeWhenPartingOrMovingTogether) {
    expect_free_when_parting<PointTriangle>(27);
}
TEST(Advance, EdgeEdgeIsFreeWhenPartingOrMovingTogether) {
    expect_free_when_parting<EdgeEdge>(28);
}

template <class Pair>
void run_with_separation(unsigned seed) {
    Random random(seed);
    int closed = 0;
    for (int trial = 0; trial < 30000; ++trial) {
        SCOPED_TRACE(trial);
        Query q = random_query(random, Pair::kFirst, trial % 2 == 1);
        const double d0 = Pair::distance(q.x);
        q.params.min_separation = d0 * random.uniform(0.0, 1.3);
        const Advance a = Pair::advance(q.x, q.p, 1.0, q.params);
        if (d0 <= q.params.min_separation) {
            ++closed;
            ASSERT_EQ(a.t, 0.0);
            ASSERT_EQ(a.reason, AdvanceEnd::InitiallyClosed);
            continue;
        }
        expect_safe<Pair>(q, a, 16);
        expect_not_short<Pair>(q, a);
        if (testing::Test::HasFatalFailure()) return;
    }
    EXPECT_GT(closed, 1000);
}
TEST(Advance, PointTriangleKeepsAMinimumSeparation) {
    run_with_separation<PointTriangle>(29);
}
TEST(Advance, EdgeEdgeKeepsAMinimumSeparation) {
    run_with_separation<EdgeEdge>(30);
}

TEST(Advance, HeadOnApproachUsesExactlyTheSlack) {
    const Stencil<4> x = {{{0.25, 0.25, 1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    const Stencil<4> p = {{{0, 0, -2}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}}};
    const Advance a = advance_point_triangle(x, p, 1.0, {.slack = 0.8});
    EXPECT_NEAR(a.t, 0.4, 1e-8);
    EXPECT_LE(a.t, 0.4);
    EXPECT_EQ(a.reason, AdvanceEnd::GapUsed);
}

TEST(Advance, FastCrossingIsSeen) {
    const Stencil<4> x = {{{-1, 0, 0}, {1, 0, 0}, {0, -1, 1e-3}, {0, 1, 1e-3}}};
    const Stencil<4> p = {{{0, 0, 1e6}, {0, 0, 1e6}, {0, 0, 0}, {0, 0, 0}}};
    const Advance a = advance_edge_edge(x, p, 1.0, {.slack = 0.8});
    EXPECT_NEAR(a.t, 0.8e-9, 1e-18);
    EXPECT_GT(a.t, 0.0);
}

TEST(Advance, GapBelowRoundingIsNamed) {
    const Stencil<4> x = {{{1e3 + 0.25, 0.25, std::nextafter(1e3, 2e3)},
                           {1e3, 0, 1e3},
                           {1e3 + 1, 0, 1e3},
                           {1e3, 1, 1e3}}};
    const Stencil<4> p = {{{0, 0, -1}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}}};
    const Advance a = advance_point_triangle(x, p, 1.0, {});
    EXPECT_EQ(a.t, 0.0);
    EXPECT_EQ(a.reason, AdvanceEnd::BelowRounding);
}

TEST(Advance, InputThatIsNotFiniteIsNamed) {
    Stencil<4> x = {{{0.25, 0.25, 1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    const Stencil<4> p = {{{0, 0, -2}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}}};
    for (double bad : {double(NAN), double(INFINITY)}) {
        x.x[2].y = bad;
        EXPECT_EQ(advance_point_triangle(x, p, 1.0, {}).reason, AdvanceEnd::NotFinite);
        EXPECT_EQ(advance_edge_edge(p, x, 1.0, {}).reason, AdvanceEnd::NotFinite);
    }
}

TEST(Advance, IterationCapIsNamedAndSafe) {
    Random random(31);
    int capped = 0;
    for (int trial = 0; trial < 5000; ++trial) {
        SCOPED_TRACE(trial);
        Query q = random_query(random, 2, false);
        q.params.max_iterations = 2;
        const Advance a = advance_edge_edge(q.x, q.p, 1.0, q.params);
        ASSERT_EQ(a.capped, a.reason == AdvanceEnd::IterationCap);
        capped += a.capped;
        ASSERT_GT(a.t, 0.0);
        expect_safe<EdgeEdge>(q, a, 16);
        if (HasFatalFailure()) return;
    }
    EXPECT_GT(capped, 10);
}

TEST(Advance, FarPairsNeedNoClassification) {
    const Stencil<4> x = {{{0, 0, 5}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    const Stencil<4> p = {{{0, 0, -2}, {0, 1, 0}, {0, 0, 0}, {0, 0, 0}}};
    const Advance a = advance_point_triangle(x, p, 1.0, {});
    EXPECT_EQ(a.t, 1.0);
    EXPECT_EQ(a.iterations, 0);
}

TEST(Advance, CodimensionalPairsStopAtTheirGap) {
    const AdvanceParams params = {.slack = 0.5};
    const Advance edge = advance_point_edge({{{0.5, 1, 0}, {0, 0, 0}, {1, 0, 0}}},
                                            {{{0, -1, 0}, {0, 0, 0}, {0, 0, 0}}},
                                            1.0,
                                            params);
    EXPECT_NEAR(edge.t, 0.5, 1e-8);
    const Advance point = advance_point_point(
        {{{2, 0, 0}, {0, 0, 0}}}, {{{-4, 0, 0}, {0, 0, 0}}}, 1.0, params);
    EXPECT_NEAR(point.t, 0.25, 1e-8);
    const Advance miss = advance_point_point(
        {{{2, 0, 0}, {0, 0, 0}}}, {{{0, 9, 0}, {0, 0, 0}}}, 1.0, params);
    EXPECT_EQ(miss.t, 1.0);
}

}  // namespace
}  // namespace noli::test
