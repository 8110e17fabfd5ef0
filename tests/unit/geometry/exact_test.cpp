// SPDX-License-Identifier: Apache-2.0
#include "geometry/exact.hpp"

#include "unit/geometry/oracle.hpp"

#include <gtest/gtest.h>

#include <array>

namespace noli::test {
namespace {

// ---- oracle: intersection of convex hulls by rational linear algebra on small integers
// ------------- A segment meets a triangle iff 0 is in the hull of the Minkowski
// difference; instead of predicates the oracle clips the segment's parameter interval
// exactly, with fractions of 128-bit integers.

struct Fraction {
    Int128 num, den;  // den > 0
};

Fraction fraction(Int128 num, Int128 den) {
    return den < 0 ? Fraction{-num, -den} : Fraction{num, den};
}
bool less(const Fraction& a, const Fraction& b) {
    return a.num * b.den < b.num * a.den;
}

struct Interval {
    Fraction lo{0, 1}, hi{1, 1};
    bool empty = false;

    /// Keep the t with c + t k >= 0.
    void clip(Int128 c, Int128 k) {
        if (k == 0) {
            empty = empty || c < 0;
            return;
        }
        const Fraction root = fraction(-c, k);
        if (k > 0 && less(lo, root)) lo = root;
        if (k < 0 && less(root, hi)) hi = root;
        empty = empty || less(hi, lo);
    }
    void clip_to_zero(Int128 c, Int128 k) {
        clip(c, k);
        clip(-c, -k);
    }
};

IntPoint cross(const IntPoint& a, const IntPoint& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Int128 dot(const IntPoint& a, const IntPoint& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
bool is_zero(const IntPoint& a) {
    return a.x == 0 && a.y == 0 && a.z == 0;
}

/// Closed segments: keep the t for which p + t d lies on the line of ab and between a and
/// b.
bool oracle_segment_segment(const IntPoint& p,
                            const IntPoint& q,
                            const IntPoint& a,
                            const IntPoint& b) {
    const IntPoint d = q - p;
    const IntPoint e = b - a;
    const IntPoint r = p - a;
    Interval t;
    if (is_zero(e)) {
        t.clip_to_zero(r.x, d.x);
        t.clip_to_zero(r.y, d.y);
        t.clip_to_zero(r.z, d.z);
        return !t.empty;
    }
    const IntPoint c0 = cross(r, e);
    const IntPoint c1 = cross(d, e);
    t.clip_to_zero(c0.x, c1.x);
    t.clip_to_zero(c0.y, c1.y);
    t.clip_to_zero(c0.z, c1.z);
    t.clip(dot(r, e), dot(d, e));
    t.clip(dot(e, e) - dot(r, e), -dot(d, e));
    return !t.empty;
}

/// Keep the t for which p + t d lies in the plane of abc and inside its three sides.
bool oracle_segment_triangle(const IntPoint& p,
                             const IntPoint& q,
                             const IntPoint& a,
                             const IntPoint& b,
                             const IntPoint& c) {
    const IntPoint N = cross(b - a, c - a);
    if (is_zero(N))
        return oracle_segment_segment(p, q, a, b) || oracle_segment_segment(p, q, b, c)
            || oracle_segment_segment(p, q, c, a);
    const IntPoint d = q - p;
    Interval t;
    t.clip_to_zero(dot(p - a, N), dot(d, N));
    const std::array<IntPoint, 3> corner = {a, b, c};
    for (int i = 0; i < 3; ++i) {
        const IntPoint inward = cross(N, corner[(i + 1) % 3] - corner[i]);
        t.clip(dot(p - corner[i], inward), dot(d, inward));
    }
    return !t.empty;
}

// ---- inputs
// ----------------------------------------------------------------------------------------

struct IntCase {
    std::array<IntPoint, 5> x;
};

/// Five grid points; a small grid makes coplanar, touching and degenerate cases the rule.
IntCase random_case(Random& random, int range) {
    IntCase out;
    for (IntPoint& x : out.x)
        x = {random.integer(-range, range),
             random.integer(-range, range),
             random.integer(-range, range)};
    const int kind = random.integer(0, 3);
    if (kind == 0)
        for (IntPoint& x : out.x)
            x.z = x.x + 2 * x.y;  // all coplanar, in no coordinate plane
    if (kind == 1) out.x[0] = out.x[2 + random.integer(0, 2)];
    return out;
}

/// offset + scale * integer, exact for the offsets and scales used.
Vec3d placed(const IntPoint& x, const Vec3d& offset, double scale) {
    return {offset.x + scale * double(x.x),
            offset.y + scale * double(x.y),
            offset.z + scale * double(x.z)};
}

void expect_agreement(const IntCase& c, const Vec3d& offset, double scale) {
    std::array<Vec3d, 5> x;
    for (int i = 0; i < 5; ++i)
        x[i] = placed(c.x[i], offset, scale);
    ASSERT_EQ(orient3d_sign(x[0], x[1], x[2], x[3]),
              orient3d(c.x[0], c.x[1], c.x[2], c.x[3]));
    ASSERT_EQ(segments_intersect_3d(x[0], x[1], x[2], x[3]),
              oracle_segment_segment(c.x[0], c.x[1], c.x[2], c.x[3]));
    ASSERT_EQ(point_on_triangle(x[0], x[2], x[3], x[4]),
              oracle_segment_triangle(c.x[0], c.x[0], c.x[2], c.x[3], c.x[4]));
    ASSERT_EQ(point_on_segment(x[0], x[2], x[3]),
              oracle_segment_segment(c.x[0], c.x[0], c.x[2], c.x[3]));
    ASSERT_EQ(segment_intersects_triangle(x[0], x[1], x[2], x[3], x[4]),
              oracle_segment_triangle(c.x[0], c.x[1], c.x[2], c.x[3], c.x[4]));
}

TEST(ExactPredicates, AgreeWithIntegersOnSmallGrids) {
    Random random(11);
    int hits = 0;
    for (int trial = 0; trial < 100000; ++trial) {
        SCOPED_TRACE(trial);
        const IntCase c = random_case(random, random.integer(1, 6));
        expect_agreement(c, {0, 0, 0}, 1.0);
        hits += oracle_segment_triangle(c.x[0], c.x[1], c.x[2], c.x[3], c.x[4]);
        if (HasFatalFailure()) return;
    }
    EXPECT_GT(hits, 20000);  // both answers are well represented
    EXPECT_LT(hits, 80000);
}

TEST(ExactPredicates, AgreeWithIntegersWhenOneGridStepIsOneUlp) {
    Random random(12);
    const double ulp = std::nextafter(1.0, 2.0) - 1.0;  // spacing of doubles in [1, 2)
    for (int trial = 0; trial < 100000; ++trial) {
        SCOPED_TRACE(trial);
        const IntCase c = random_case(random, random.integer(1, 6));
        expect_agreement(c, {1.5, 1.25, 1.75}, ulp);
        if (HasFatalFailure()) return;
    }
}

TEST(ExactPredicates, AgreeWithIntegersAfterALargeTranslation) {
    Random random(13);
    for (int trial = 0; trial < 50000; ++trial) {
        SCOPED_TRACE(trial);
        const IntCase c = random_case(random, 100);
        expect_agreement(c, {0x1p40, -0x1p44, 0x1p38}, 0x1p-6);
        if (HasFatalFailure()) return;
    }
}

// Coordinates of 40 bits: products of three need 120, so that the filter fails on the
// flat cases.
TEST(ExactPredicates, AgreeWithIntegersOnLongCoordinatesThatAreNearlyFlat) {
    Random random(14);
    int flat = 0;
    for (int trial = 0; trial < 100000; ++trial) {
        SCOPED_TRACE(trial);
        const auto big = [&] {
            return Int128(std::llround(random.uniform(-0x1p36, 0x1p36)));
        };
        const IntPoint a = {big(), big(), big()}, b = {big(), big(), big()},
                       c = {big(), big(), big()};
        const auto along = [&](Int128 from, Int128 to1, Int128 to2, int i, int j) {
            return from + i * ((to1 - from) / 8) + j * ((to2 - from) / 8)
                 + random.integer(-1, 1);
        };
        const int i = random.integer(-8, 8), j = random.integer(-8, 8);
        const IntPoint d = {along(a.x, b.x, c.x, i, j),
                            along(a.y, b.y, c.y, i, j),
                            along(a.z, b.z, c.z, i, j)};
        const int expected = orient3d(a, b, c, d);
        flat += expected == 0;
        const Vec3d zero = {0, 0, 0};
        ASSERT_EQ(orient3d_sign(placed(a, zero, 1),
                                placed(b, zero, 1),
                                placed(c, zero, 1),
                                placed(d, zero, 1)),
                  expected);
        ASSERT_EQ(orient2d_sign({double(a.x), double(a.y)},
                                {double(b.x), double(b.y)},
                                {double(d.x), double(d.y)}),
                  sign((b.x - a.x) * (d.y - a.y) - (b.y - a.y) * (d.x - a.x)));
    }
    EXPECT_GT(flat, 0);
}

// Exactly collinear points of 30-bit multiples, then off by one unit.
TEST(ExactPredicates, TellCollinearFromAlmostCollinear) {
    Random random(15);
    for (int trial = 0; trial < 100000; ++trial) {
        const auto small = [&] { return double(random.integer(-1000000, 1000000)); };
        const double dx = small(), dy = small();
        const double k1 = small(), k2 = small();
        const Vec2d a = {small(), small()};
        const Vec2d b = {a.x + k1 * dx, a.y + k1 * dy};
        const Vec2d c = {a.x + k2 * dx, a.y + k2 * dy};
        ASSERT_EQ(orient2d_sign(a, b, c), 0);
        const int expected = sign(Int128(k1 * dx));
        ASSERT_EQ(orient2d_sign(a, b, {c.x, c.y + 1.0}), expected);
    }
}

TEST(ExactPredicates, ValuesKeepRelativeAccuracyWhereDoublesCancel) {
    Random random(16);
    for (int trial = 0; trial < 20000; ++trial) {
        SCOPED_TRACE(trial);
        const Stencil<4> s = degenerate_stencil(random);
        const Vec3q u = quad(s.x[1]) - quad(s.x[0]);
        const Vec3q v = quad(s.x[2]) - quad(s.x[0]);
        const Vec3q w = quad(s.x[3]) - quad(s.x[0]);
        const Vec3q N = noli::cross(u, v);
        const Vec3d N_ours = cross_of_edges(s.x[0], s.x[1], s.x[0], s.x[2]);
        const double size = double(quad_sqrt(norm_sq(N)));
        // 1e-33: rounding of the 113-bit oracle, for coordinates of size 1.
        const double scale = size_of(s) * size_of(s);
        ASSERT_NEAR(norm(N_ours - Vec3d{double(N.x), double(N.y), double(N.z)}),
                    0.0,
                    2e-10 * size + 1e-31 * scale);
        const double volume = double(noli::dot(N, w));
        ASSERT_NEAR(orient3d_value(s.x[0], s.x[1], s.x[2], s.x[3]),
                    volume,
                    2e-10 * std::fabs(volume) + 1e-31 * scale * size_of(s));
    }
}

TEST(ExactPredicates, PlaneSideIsDecidedWhereDoublesCancel) {
    // 3 (1 + 2^-52 k) x - 1 around x = 1/3, which is no double: integers decide.
    const Vec3d normal{3.0, 1.0, -1.0};
    const double third = 1.0 / 3.0;  // below 1/3 by 2^-54 / 3
    EXPECT_EQ(plane_side({third, 0.0, 0.0}, normal, 1.0), -1);
    EXPECT_EQ(plane_side({std::nextafter(third, 1.0), 0.0, 0.0}, normal, 1.0), 1);
    EXPECT_EQ(plane_side({1.0, 1e-30, 1e-30}, normal, 3.0), 0);
    EXPECT_EQ(plane_side({1.0, 2e-30, 1e-30}, normal, 3.0), 1);
    EXPECT_EQ(plane_side({1.0, 1e-30, 2e-30}, normal, 3.0), -1);
    EXPECT_EQ(plane_side({0.0, 5.0, 2.0}, normal, 2.0), 1);
    EXPECT_EQ(plane_side({0.0, -5.0, 2.0}, normal, 2.0), -1);
}

TEST(ExactPredicates, ExpansionsFindABitAtTheOtherEndOfTheRange) {
    // a b - c d with a result 2^-104 below its terms.
    const double x = 1.0 + 0x1p-52;
    const Vec2d a = {0, 0}, b = {x, 1.0}, c = {x * 1.0, 1.0};
    EXPECT_EQ(orient2d_sign(a, b, c), 0);
    EXPECT_EQ(orient2d_sign(a, b, {x + 0x1p-52, x}), 1);  // x^2 - (1 + 2^-51) = 2^-104
    EXPECT_EQ(orient2d_sign(a, b, {x + 0x1p-52, 1.0}), -1);
}

}  // namespace
}  // namespace noli::test
