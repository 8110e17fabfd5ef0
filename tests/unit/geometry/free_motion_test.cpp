// SPDX-License-Identifier: Apache-2.0
#include "geometry/free_motion.hpp"

#include "core/pack.hpp"
#include "unit/geometry/motions.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace noli::test {
namespace {

template <class Pair>
constexpr PairKind kParent =
    Pair::kFirst == 1 ? PairKind::PointTriangle : PairKind::EdgeEdge;

template <class Pair>
bool is_surely_free(const Query& q, double t_max = 1.0) {
    return surely_free<kParent<Pair>>(q.x.x, q.p.x, t_max, q.params);
}

/// A motion short enough to be free often, and min_separation sometimes.
template <class Pair>
Query short_query(Random& random, bool degenerate) {
    Query q = random_query(random, Pair::kFirst, degenerate);
    const double scale = random.log_uniform(-3, 0);
    for (Vec3d& v : q.p.x)
        v = scale * v;
    if (random.chance(0.3)) q.params.min_separation = 0.1 * Pair::distance(q.x);
    return q;
}

template <class Pair>
class FreeMotion : public testing::Test {};
using Pairs = testing::Types<PointTriangle, EdgeEdge>;
TYPED_TEST_SUITE(FreeMotion, Pairs);

/// The end of the longest motion that is surely free, up to 64; 0 without one.
template <class Pair>
double longest_free(const Query& q) {
    double free = 0.0;
    double unsure = 64.0;
    for (int k = 0; k < 40; ++k) {
        const double middle = 0.5 * (free + unsure);
        (is_surely_free<Pair>(q, middle) ? free : unsure) = middle;
    }
    return free;
}

TYPED_TEST(FreeMotion, KeepsTheTarget) {
    for (const bool degenerate : {false, true}) {
        Random random(61);
        int ended = 0;
        for (int trial = 0; trial < 50000; ++trial) {
            SCOPED_TRACE(trial);
            const Query q = short_query<TypeParam>(random, degenerate);
            const double t = longest_free<TypeParam>(q);
            ended += t > 0.0 && t < 63.0;
            expect_safe<TypeParam>(q, {t, 0, false, AdvanceEnd::Free}, 24);
            if (this->HasFatalFailure()) return;
        }
        EXPECT_GT(ended, 10000);
    }
}

TYPED_TEST(FreeMotion, IsFoundWhereOneLookIsEnough) {
    Random random(62);
    int one_look = 0;
    int found = 0;
    for (int trial = 0; trial < 50000; ++trial) {
        const Query q = short_query<TypeParam>(random, false);
        const Advance a = TypeParam::advance(q.x, q.p, 1.0, q.params);
        if (a.reason != AdvanceEnd::Free || a.iterations != 1) continue;
        ++one_look;
        found += is_surely_free<TypeParam>(q);
    }
    EXPECT_GT(one_look, 1000);
    EXPECT_GT(found, 0.999 * one_look);
}

TYPED_TEST(FreeMotion, IsTheSameInPacks) {
    constexpr int kWidth = 4;
    using T = Pack<kWidth>;
    Random random(63);
    for (int trial = 0; trial < 5000; ++trial) {
        std::vector<Query> queries;
        Vec3<T> x[4];
        Vec3<T> p[4];
        for (int j = 0; j < kWidth; ++j) {
            queries.push_back(short_query<TypeParam>(random, trial % 2 == 1));
            queries[std::size_t(j)].params = queries[0].params;
            for (int c = 0; c < 4; ++c)
                for (int axis = 0; axis < 3; ++axis) {
                    x[c][axis].set(j, queries[std::size_t(j)].x.x[c][axis]);
                    p[c][axis].set(j, queries[std::size_t(j)].p.x[c][axis]);
                }
        }
        const T free =
            select(surely_free<kParent<TypeParam>>(x, p, 0.7, queries[0].params),
                   T(1.0),
                   T(0.0));
        for (int j = 0; j < kWidth; ++j)
            ASSERT_EQ(free[j] > 0.0,
                      is_surely_free<TypeParam>(queries[std::size_t(j)], 0.7));
    }
}

TYPED_TEST(FreeMotion, IsNotSureOfWhatIsNotFinite) {
    Random random(64);
    for (const double bad : {double(NAN), double(INFINITY), -double(INFINITY)})
        for (int c = 0; c < 4; ++c) {
            Query q{random.stencil<4>(), random.stencil<4>(1e-6), {}};
            ASSERT_TRUE(is_surely_free<TypeParam>(q));
            Query of_x = q;
            of_x.x.x[c].y = bad;
            EXPECT_FALSE(is_surely_free<TypeParam>(of_x));
            q.p.x[c].z = bad;
            EXPECT_FALSE(is_surely_free<TypeParam>(q));
        }
}

}  // namespace
}  // namespace noli::test
