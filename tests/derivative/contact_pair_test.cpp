// SPDX-License-Identifier: Apache-2.0
/// Contact pairs against finite differences, against exact second derivatives of the
/// naive formulas, and against dense eigen-projections.
#include "energy/contact_pair.hpp"

#include "derivative/contact_oracle.hpp"
#include "energy/numeric_hessian.hpp"
#include "energy/wall.hpp"

#include <gtest/gtest.h>

namespace noli::test {
namespace {

constexpr double kDhat = 1e-2;
constexpr double kKappa = 3.0;

BarrierParams params_of(int exponent) {
    return {kDhat, kKappa, exponent, 0.0};
}

/// f(kind, stencil, exponent) over gaps, edge lengths (10 and 2 dhat), exponents and
/// kinds.
template <class F>
void sweep(unsigned seed, int samples, const F& f) {
    PairSampler sampler(seed);
    for (double s : {0.999, 0.9, 0.5, 0.1, 0.01}) {
        for (double edge : {10.0, 2.0}) {
            for (int k = 0; k < samples; ++k) {
                for_each_kind(
                    sampler, s * kDhat, edge * kDhat, [&](PairKind kind, auto x) {
                        SCOPED_TRACE(testing::Message()
                                     << "kind " << int(kind) << ", d/dhat " << s
                                     << ", edge/dhat " << edge);
                        f(kind, x, 1);
                        f(kind, x, 2);
                    });
            }
        }
    }
}

template <int S>
Eigen::Matrix<double, 3 * S, 1> gradient(PairKind kind, const Stencil<S>& x, int r) {
    return flat(pair_gradient(kind, x, params_of(r)).g);
}

TEST(ContactPair, GradientMatchesCentralDifferences) {
    sweep(1, 5, []<int S>(PairKind kind, const Stencil<S>& x, int r) {
        const double d = pair_geometry(kind, x).d;
        const auto energy = [&](const Stencil<S>& y) {
            return Eigen::VectorXd::Constant(1, pair_energy(kind, y, params_of(r)));
        };
        const double h = 2e-3 * std::fmin(d, kDhat - d);
        const Eigen::MatrixXd difference = central_differences(energy, x, h);
        EXPECT_LE(relative_error(gradient(kind, x, r), difference.transpose()), 1e-6);
    });
}

TEST(ContactPair, ValueAndGradientMatchTheNaiveFormula) {
    sweep(2, 10, []<int S>(PairKind kind, const Stencil<S>& x, int r) {
        const Jet<3 * S> exact = pair_oracle(kind, x, r, kDhat);
        EXPECT_NEAR(pair_energy(kind, x, params_of(r)) / (kKappa * exact.v), 1.0, 1e-8);
        EXPECT_LE(relative_error(gradient(kind, x, r), kKappa * exact.g), 1e-8);
    });
}

// Ties the oracle's second derivatives themselves to finite differences of our gradient.
TEST(ContactPair, OracleHessianMatchesDifferencesOfTheGradient) {
    sweep(3, 3, []<int S>(PairKind kind, const Stencil<S>& x, int r) {
        const double d = pair_geometry(kind, x).d;
        const auto g = [&](const Stencil<S>& y) -> Eigen::VectorXd {
            return gradient(kind, y, r);
        };
        const double h = 2e-3 * std::fmin(d, kDhat - d);
        const Eigen::MatrixXd difference = central_differences(g, x, h);
        EXPECT_LE(relative_error(difference, kKappa * pair_oracle(kind, x, r, kDhat).h),
                  1e-6);
    });
}

TEST(ContactPair, ExactHessianEqualsTheProjectionOfTheWholeMatrix) {
    double worst = 0.0;
    sweep(4, 20, [&]<int S>(PairKind kind, const Stencil<S>& x, int r) {
        const auto reference = positive_part<typename Jet<3 * S>::Hessian>(
            kKappa * pair_oracle(kind, x, r, kDhat).h);
        const auto modes = pair_hessian(ContactHessian::Exact, kind, x, params_of(r));
        const double error = relative_error(dense(modes), reference);
        EXPECT_LE(error, 1e-9);
        EXPECT_LE(modes.rank, max_rank(kind, ContactHessian::Exact));
        worst = std::fmax(worst, error);
    });
    sweep(4, 20, [&]<int S>(PairKind kind, const Stencil<S>& x, int r) {
        const auto reference = positive_part<typename Jet<3 * S>::Hessian>(
            kKappa * pair_oracle(kind, x, r, kDhat).h);
        const auto modes = numeric_pair_hessian(kind, x, params_of(r));
        EXPECT_LE(relative_error(dense(modes), reference), 1e-9);
        EXPECT_LE(modes.rank, max_rank(kind, ContactHessian::Numeric));
    });
    RecordProperty("worst_relative_error", std::to_string(worst));
    std::printf("reduced exact projection: worst relative error %.2e\n", worst);
}

/// b_dd grad d grad d^T and b_d hess d from the exact jet of d itself.
template <int S>
void split_hessian(PairKind kind,
                   const Stencil<S>& x,
                   int r,
                   typename Jet<3 * S>::Hessian& rank_one,
                   typename Jet<3 * S>::Hessian& curved) {
    const auto points = variables(x);
    const Jet<3 * S> d = sqrt(distance_sq_of(kind, points.data()));
    rank_one = kKappa * barrier_curvature(r, d.v, kDhat) * d.g * d.g.transpose();
    curved = kKappa * barrier_slope(r, d.v, kDhat) * d.h;
}

TEST(ContactPair, GaussNewtonIsTheRankOnePart) {
    sweep(5, 10, []<int S>(PairKind kind, const Stencil<S>& x, int r) {
        typename Jet<3 * S>::Hessian rank_one, curved;
        split_hessian(kind, x, r, rank_one, curved);
        const auto modes =
            pair_hessian(ContactHessian::GaussNewton, kind, x, params_of(r));
        EXPECT_EQ(modes.rank, 1);
        EXPECT_LE(relative_error(dense(modes), rank_one), 1e-9);
    });
}

TEST(ContactPair, GaussNewtonPlusAddsTheProjectionOfTheCurvedPart) {
    double worst = 0.0;
    sweep(6, 20, [&]<int S>(PairKind kind, const Stencil<S>& x, int r) {
        typename Jet<3 * S>::Hessian rank_one, curved;
        split_hessian(kind, x, r, rank_one, curved);
        const auto modes =
            pair_hessian(ContactHessian::GaussNewtonPlus, kind, x, params_of(r));
        EXPECT_EQ(modes.rank, max_rank(kind, ContactHessian::GaussNewtonPlus));
        const auto projected = positive_part(curved);
        EXPECT_LE(relative_error(dense(modes), rank_one + projected), 1e-9);
        if (S == 2) return;  // nothing curved is left for points
        // the curved part alone, which the rank-one part would drown
        StencilModes<S, kPairModes<S>> curved_modes = modes;
        for (auto& q : curved_modes.q[0])
            q = Vec3d{0.0, 0.0, 0.0};
        const double error = relative_error(dense(curved_modes), projected);
        EXPECT_LE(error, 1e-9);
        worst = std::fmax(worst, error);
    });
    std::printf("GN+ against numeric projection of b_d hess d: worst %.2e\n", worst);
}

// The claim of MATH 2.5: three to ten times closer to the exact projection than
// Gauss-Newton.
TEST(ContactPair, GaussNewtonPlusIsCloserToTheProjectionThanGaussNewton) {
    for (double edge : {10.0, 2.0}) {
        PairSampler sampler(7);
        double plain[4] = {};
        double plus[4] = {};
        for (int k = 0; k < 40; ++k) {
            const auto measure = [&]<int S>(PairKind kind, const Stencil<S>& x) {
                const auto exact =
                    dense(pair_hessian(ContactHessian::Exact, kind, x, params_of(1)));
                const auto gn = dense(
                    pair_hessian(ContactHessian::GaussNewton, kind, x, params_of(1)));
                const auto gn_plus = dense(
                    pair_hessian(ContactHessian::GaussNewtonPlus, kind, x, params_of(1)));
                plain[int(kind)] += relative_error(gn, exact) / 40;
                plus[int(kind)] += relative_error(gn_plus, exact) / 40;
            };
            for_each_kind(sampler, 0.5 * kDhat, edge * kDhat, measure);
        }
        EXPECT_LE(plain[int(PairKind::PointPoint)], 1e-12);  // GN is exact for two points
        for (int kind = 1; kind < 4; ++kind) {
            std::printf(
                "edges %2.0f dhat, s = .5, kind %d: |GN - exact| %.4f, |GN+ - exact| "
                "%.4f\n",
                edge,
                kind,
                plain[kind],
                plus[kind]);
            EXPECT_GT(plain[kind], 3.0 * plus[kind]);
        }
    }
}

TEST(ContactPair, DerivativesMatchAtTheBorderOfTheBand) {
    PairSampler sampler(8);
    for (double below : {1e-4, 1e-7, 1e-10}) {
        for_each_kind(
            sampler, (1.0 - below) * kDhat, 10 * kDhat, [&](PairKind kind, auto x) {
                for (int r : {1, 2}) {
                    const double d = pair_geometry(kind, x).d;
                    if (!(d < kDhat)) continue;
                    // leading term: b = kappa dhat^4 (1 - g)^(2 + r)
                    const double gap = (kDhat - d) * (kDhat + d) / (kDhat * kDhat);
                    const double K = kKappa * std::pow(kDhat, 4);
                    EXPECT_NEAR(
                        pair_energy(kind, x, params_of(r)) / (K * std::pow(gap, 2 + r)),
                        1.0,
                        1.1 * r * gap + 1e-5);
                    const auto modes =
                        pair_hessian(ContactHessian::Exact, kind, x, params_of(r));
                    EXPECT_GT(modes.rank, 0);
                    EXPECT_TRUE(dense(modes).allFinite());
                }
            });
    }
}

TEST(HalfSpacePair, DerivativesMatchCentralDifferences) {
    PairSampler sampler(9);
    for (double s : {0.999, 0.9, 0.5, 0.1, 0.01}) {
        for (int r : {1, 2}) {
            const Wall plane{normalized(sampler.normal()), sampler.uniform(-1.0, 1.0)};
            Vec3d x = sampler.normal();
            x += (s * kDhat - wall_distance(plane, x)) * plane.normal;
            const Stencil<1> at{{x}};
            const double h = 2e-3 * kDhat * std::fmin(s, 1.0 - s);
            const BarrierParams params = params_of(r);
            const auto energy = [&](const Stencil<1>& y) {
                return Eigen::VectorXd::Constant(1, wall_energy(y.x[0], plane, params));
            };
            const auto gradient_at = [&](const Stencil<1>& y) -> Eigen::VectorXd {
                return flat(wall_gradient(y.x[0], plane, params).g);
            };
            EXPECT_LE(relative_error(gradient_at(at),
                                     central_differences(energy, at, h).transpose()),
                      1e-6);
            EXPECT_LE(relative_error(dense(wall_hessian(x, plane, params)),
                                     central_differences(gradient_at, at, h)),
                      1e-6);
        }
    }
}

TEST(CurvedWall, DerivativesMatchCentralDifferences) {
    PairSampler sampler(10);
    for (const WallShape shape : {WallShape::Sphere, WallShape::Cylinder})
        for (double radius : {1.5 * kDhat, 20.0 * kDhat})
            for (double s : {0.999, 0.9, 0.5, 0.1, 0.01})
                for (int r : {1, 2}) {
                    const Wall wall{normalized(sampler.normal()),
                                    0.0,
                                    shape,
                                    0.1 * sampler.normal(),
                                    radius};
                    const Vec3d out = normalized(across_axis(wall, sampler.normal()));
                    const Vec3d x =
                        wall.center + (radius - s * kDhat) * out
                        + (shape == WallShape::Cylinder ? 0.1 : 0.0) * wall.normal;
                    const Stencil<1> at{{x}};
                    const double h = 2e-3 * kDhat * std::fmin(s, 1.0 - s);
                    const BarrierParams params = params_of(r);
                    const auto energy = [&](const Stencil<1>& y) {
                        return Eigen::VectorXd::Constant(
                            1, wall_energy(y.x[0], wall, params));
                    };
                    const auto gradient_at = [&](const Stencil<1>& y) -> Eigen::VectorXd {
                        return flat(wall_gradient(y.x[0], wall, params).g);
                    };
                    EXPECT_LE(
                        relative_error(gradient_at(at),
                                       central_differences(energy, at, h).transpose()),
                        1e-6);
                    const auto modes = wall_hessian(x, wall, params);
                    EXPECT_EQ(modes.rank, 1 + num_curved_directions(shape));
                    EXPECT_LE(relative_error(dense(modes),
                                             central_differences(gradient_at, at, h)),
                              1e-6);
                }
}

}  // namespace
}  // namespace noli::test
