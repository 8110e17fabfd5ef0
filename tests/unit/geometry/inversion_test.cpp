// SPDX-License-Identifier: Apache-2.0
#include "geometry/inversion.hpp"

#include "unit/geometry/oracle.hpp"

#include <gtest/gtest.h>

namespace noli::test {
namespace {

/// Six times the signed volume of x + t p, in extended precision.
long double volume(const Stencil<4>& x, const Stencil<4>& p, double t) {
    Vec3<long double> y[4];
    for (int i = 0; i < 4; ++i)
        y[i] = extended(x.x[i]) + (long double)(t)*extended(p.x[i]);
    return dot(cross(y[1] - y[0], y[2] - y[0]), y[3] - y[0]);
}

Stencil<4> positive_tet(Random& random) {
    Stencil<4> x = random.stencil<4>();
    if (random.chance(0.3))
        x.x[3] = x.x[0] + random.log_uniform(-6, 0) * (x.x[3] - x.x[0]);
    if (volume(x, x, 0.0) < 0) std::swap(x.x[2], x.x[3]);
    return x;
}

/// Motions with every degree of the cubic: one vertex (linear), two (quadratic), all;
/// rigid translation (constant); nearly vanishing leading coefficients.
Stencil<4> motion(Random& random, const Stencil<4>& x) {
    Stencil<4> p = {};
    const int kind = random.integer(0, 5);
    const double size = random.log_uniform(-3, 2);
    const int num_moving = kind == 5 ? 4 : kind;
    for (int i = 0; i < num_moving; ++i)
        p.x[i] = random.vec(size);
    if (kind == 5) {
        const Vec3d common = p.x[0];
        for (Vec3d& v : p.x)
            v = common + random.log_uniform(-16, -6) * random.vec(size);
        p.x[random.integer(0, 3)] += random.vec(size);
    }
    if (random.chance(0.1))  // uniform scaling about a point: a triple root
        for (int i = 0; i < 4; ++i)
            p.x[i] = -size * x.x[i];
    return p;
}

TEST(InversionBound, IsTheFirstRootOnRandomAndDegenerateMotions) {
    Random random(41);
    int limited = 0;
    for (int trial = 0; trial < 100000; ++trial) {
        SCOPED_TRACE(trial);
        const Stencil<4> x = positive_tet(random);
        const Stencil<4> p = motion(random, x);
        const double keep = trial % 3 == 0 ? 0.2 : random.uniform(0.0, 0.9);
        const double t = inversion_bound(x, p, keep);
        const long double v0 = volume(x, p, 0.0);
        ASSERT_GT(t, 0.0);
        ASSERT_LE(t, 1.0);
        for (int k = 1; k <= 32; ++k)
            ASSERT_GE(double(volume(x, p, t * k / 32) / v0), keep - 1e-9) << k;
        if (t == 1.0) continue;
        ++limited;
        // Just behind t the bound is used up, within the stated 1e-6 and rounding of a
        // flat root.
        double least = 1e300;
        for (int k = 0; k <= 16; ++k)
            least = std::min(least, double(volume(x, p, t * (1 + 1e-5 * k / 16)) / v0));
        ASSERT_LE(least, keep + 1e-5);
    }
    EXPECT_GT(limited, 20000);
    EXPECT_LT(limited, 80000);
}

TEST(InversionBound, IsOneWhereVolumeIsSurelyKept) {
    Random random(43);
    int sure = 0;
    int one = 0;
    for (int trial = 0; trial < 300000; ++trial) {
        const Stencil<4> x = positive_tet(random);
        Stencil<4> p = motion(random, x);
        // As near to the edge of what is allowed as the bound can lead.
        if (random.chance(0.5)) {
            const double t =
                inversion_bound(x, p, 0.2) * (1.0 - random.log_uniform(-16, -2));
            for (Vec3d& v : p.x)
                v = t * v;
        }
        const bool exact = inversion_bound(x, p, 0.2) == 1.0;
        const bool quick = surely_keeps_volume(x.x, p.x, 0.2);
        ASSERT_TRUE(exact || !quick) << trial;
        sure += quick;
        one += exact;
    }
    EXPECT_GT(sure, one * 9 / 10);
}

TEST(InversionBound, DoubleRootIsNotStoodOver) {
    // f(t) / f(0) = (1 - 2 t)^2: two columns shrink to nothing at t = 1/2 and grow again.
    const Stencil<4> x = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    const Stencil<4> p = {{{0, 0, 0}, {-2, 0, 0}, {0, -2, 0}, {0, 0, 0}}};
    EXPECT_LE(inversion_bound(x, p, 0.0), 0.5);
    EXPECT_NEAR(inversion_bound(x, p, 0.0), 0.5, 1e-4);
    EXPECT_NEAR(inversion_bound(x, p, 0.25), 0.25, 1e-6);
}

TEST(InversionBound, ShortDipIsSeen) {
    // (1 - 2 t)^2 + dip: the minimum of g just crosses, or just misses, zero.
    const Stencil<4> x = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    const double e = 1e-4;
    Stencil<4> p = {
        {{0, 0, 0}, {-2, e, 0}, {-e, -2, 0}, {0, 0, 0}}};  // f = (1-2t)^2 + e^2 t^2
    EXPECT_EQ(inversion_bound(x, p, 0.0), 1.0);
    p = {{{0, 0, 0}, {-2, e, 0}, {e, -2, 0}, {0, 0, 0}}};  // f = (1-2t)^2 - e^2 t^2
    EXPECT_NEAR(inversion_bound(x, p, 0.0), 1.0 / (2.0 + e), 1e-6);
    EXPECT_LE(inversion_bound(x, p, 0.0), 1.0 / (2.0 + e));
}

TEST(InversionBound, DoesNotDependOnScaleOrPlace) {
    Random random(42);
    for (int trial = 0; trial < 1000; ++trial) {
        const Stencil<4> x = positive_tet(random);
        const Stencil<4> p = motion(random, x);
        const double t = inversion_bound(x, p, 0.2);
        for (double scale : {0x1p-40, 0x1p30}) {
            Stencil<4> xs = x, ps = p;
            for (int i = 0; i < 4; ++i) {
                xs.x[i] = scale * x.x[i];
                ps.x[i] = scale * p.x[i];
            }
            ASSERT_EQ(inversion_bound(xs, ps, 0.2), t);
        }
    }
}

TEST(InversionBound, ThinTetrahedronIsNotLost) {
    const Stencil<4> x = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.25, 0.25, 1e-9}}};
    const Stencil<4> p = {{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, -2e-9}}};
    EXPECT_NEAR(inversion_bound(x, p, 0.2), 0.4, 1e-6);
}

TEST(InversionBound, IsZeroForWhatIsInvertedAlreadyOrNotFinite) {
    const Stencil<4> flat = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}};
    const Stencil<4> inverted = {{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}}};
    Stencil<4> good = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    const Stencil<4> still = {};
    EXPECT_EQ(inversion_bound(flat, still, 0.2), 0.0);
    EXPECT_EQ(inversion_bound(inverted, still, 0.2), 0.0);
    EXPECT_EQ(inversion_bound(good, still, 0.2), 1.0);
    Stencil<4> bad = still;
    bad.x[1].y = NAN;
    EXPECT_EQ(inversion_bound(good, bad, 0.2), 0.0);
}

}  // namespace
}  // namespace noli::test
