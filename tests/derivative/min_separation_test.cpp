// SPDX-License-Identifier: Apache-2.0
/// The barrier that a minimum separation shifts, against finite differences: by itself,
/// of pairs, of nearly parallel edges and of walls.
#include "derivative/contact_oracle.hpp"
#include "energy/barrier_params.hpp"
#include "energy/mollified_pair.hpp"
#include "energy/numeric_hessian.hpp"
#include "energy/wall.hpp"

#include <gtest/gtest.h>

namespace noli::test {
namespace {

constexpr double kDhat = 1e-2;

BarrierParams params_of(int exponent, double min_separation) {
    return {kDhat, 3.0, exponent, 0.0, min_separation};
}

/// f(params, gap): gap beyond the minimum separation, which is below and above dhat.
template <class F>
void sweep(const F& f) {
    for (double xi : {0.3 * kDhat, 5.0 * kDhat})
        for (double s : {0.99, 0.5, 0.1})
            for (int r : {1, 2}) {
                SCOPED_TRACE(testing::Message()
                             << "xi " << xi << ", gap / dhat " << s << ", r " << r);
                f(params_of(r, xi), s * kDhat);
            }
}

/// A tenth of a per cent of the way to where the barrier is not smooth.
double difference_step(double gap) {
    return 1e-3 * std::fmin(gap, kDhat - gap);
}

TEST(MinSeparation, BarrierMatchesCentralDifferences) {
    sweep([](const BarrierParams& params, double gap) {
        const double d = params.min_separation + gap;
        const double h = difference_step(gap);
        const auto value = [&](double at) { return barrier_at(params, at).value; };
        const auto slope = [&](double at) { return barrier_slope_at(params, at); };
        const double b_d = slope(d);
        const double b_dd = barrier_curvature_at(params, d);
        EXPECT_NEAR((value(d + h) - value(d - h)) / (2 * h), b_d, 1e-5 * std::fabs(b_d));
        EXPECT_NEAR((slope(d + h) - slope(d - h)) / (2 * h), b_dd, 1e-5 * b_dd);
        // With respect to D = d^2 it says the same.
        const BarrierJet b = barrier_at(params, d);
        EXPECT_NEAR(2.0 * d * b.d1, b_d, 1e-12 * std::fabs(b_d));
        EXPECT_NEAR(4.0 * d * d * b.d2 + 2.0 * b.d1, b_dd, 1e-10 * b_dd);
    });
}

TEST(MinSeparation, BarrierIsInfiniteFromItDownAndZeroFromItsReachOn) {
    const BarrierParams params = params_of(2, 0.5 * kDhat);
    EXPECT_TRUE(std::isinf(barrier_at(params, 0.5 * kDhat).value));
    EXPECT_TRUE(std::isinf(barrier_at(params, 0.1 * kDhat).value));
    EXPECT_EQ(barrier_at(params, 0.1 * kDhat).d1, 0.0);
    EXPECT_GT(barrier_at(params, 1.49 * kDhat).value, 0.0);
    EXPECT_EQ(barrier_at(params, 1.501 * kDhat).value, 0.0);
    EXPECT_DOUBLE_EQ(params.reach(), 1.5 * kDhat);
}

template <int S>
Eigen::MatrixXd full_hessian(PairKind kind,
                             const Stencil<S>& x,
                             const BarrierParams& params) {
    const ContactFrame<S> f = contact_frame(kind, x);
    double H[3 * S][3 * S];
    detail::full_pair_hessian<S>(f, barrier_at(params, f.d), H);
    Eigen::MatrixXd out(3 * S, 3 * S);
    for (int i = 0; i < 3 * S; ++i)
        for (int j = 0; j < 3 * S; ++j)
            out(i, j) = params.kappa * H[i][j];
    return out;
}

TEST(MinSeparation, PairsMatchCentralDifferences) {
    PairSampler sampler(21);
    sweep([&](const BarrierParams& params, double gap) {
        const double d = params.min_separation + gap;
        for_each_kind(sampler, d, 0.1, [&]<int S>(PairKind kind, const Stencil<S>& x) {
            const double h = difference_step(gap);
            const auto energy = [&](const Stencil<S>& y) {
                return Eigen::VectorXd::Constant(1, pair_energy(kind, y, params));
            };
            const auto gradient = [&](const Stencil<S>& y) -> Eigen::VectorXd {
                return flat(pair_gradient(kind, y, params).g);
            };
            EXPECT_LE(relative_error(gradient(x),
                                     central_differences(energy, x, h).transpose()),
                      1e-5);
            const Eigen::MatrixXd H = full_hessian(kind, x, params);
            EXPECT_LE(relative_error(H, central_differences(gradient, x, h)), 1e-5);
            const Eigen::MatrixXd projected = positive_part<Eigen::MatrixXd>(H);
            const auto exact = pair_hessian(ContactHessian::Exact, kind, x, params);
            EXPECT_LE(relative_error(dense(exact), projected), 1e-9);
            EXPECT_LE(
                relative_error(dense(numeric_pair_hessian(kind, x, params)), projected),
                1e-9);
        });
    });
}

TEST(MinSeparation, NearlyParallelEdgesMatchCentralDifferences) {
    PairSampler sampler(22);
    const MollifiedCase sub{PairKind::EdgeEdge, {0, 1, 2, 3}};
    sweep([&](const BarrierParams& params, double gap) {
        const double d = params.min_separation + gap;
        const Stencil<4> x = sampler.near_parallel(PairKind::EdgeEdge, 0.02, d);
        const double h = difference_step(gap);
        const auto energy = [&](const Stencil<4>& y) {
            return Eigen::VectorXd::Constant(1, mollified_energy(sub, y, 1e-3, params));
        };
        const auto gradient = [&](const Stencil<4>& y) -> Eigen::VectorXd {
            return flat(mollified_gradient(sub, y, 1e-3, params).g);
        };
        EXPECT_LE(
            relative_error(gradient(x), central_differences(energy, x, h).transpose()),
            1e-5);
        const Eigen::MatrixXd H = central_differences(gradient, x, h);
        EXPECT_LE(relative_error(dense(mollified_modes<MollifiedHessian::Exact>(
                                     sub, x, 1e-3, params)),
                                 positive_part<Eigen::MatrixXd>(H)),
                  1e-4);
    });
}

TEST(MinSeparation, WallsMatchCentralDifferences) {
    sweep([](const BarrierParams& params, double gap) {
        const Wall wall{{}, 0.0, WallShape::Sphere, {0.1, 0.2, 0.3}, 0.5};
        const Vec3d out = normalized(Vec3d{0.3, -0.5, 0.8});
        const Vec3d x = wall.center + (wall.radius - params.min_separation - gap) * out;
        const double h = difference_step(gap);
        const auto energy = [&](const Stencil<1>& y) {
            return Eigen::VectorXd::Constant(1, wall_energy(y.x[0], wall, params));
        };
        const auto gradient = [&](const Stencil<1>& y) -> Eigen::VectorXd {
            return flat(wall_gradient(y.x[0], wall, params).g);
        };
        const Stencil<1> at{{x}};
        EXPECT_LE(
            relative_error(gradient(at), central_differences(energy, at, h).transpose()),
            1e-5);
        EXPECT_LE(relative_error(dense(wall_hessian(x, wall, params)),
                                 central_differences(gradient, at, h)),
                  1e-5);
    });
}

}  // namespace
}  // namespace noli::test
