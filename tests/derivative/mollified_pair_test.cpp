// SPDX-License-Identifier: Apache-2.0
/// Mollified edge-edge pairs against finite differences, exact second derivatives of the
/// naive formulas, and the closed forms of MATH 3 written densely.
#include "energy/mollified_pair.hpp"

#include "derivative/contact_oracle.hpp"

#include <gtest/gtest.h>

#include <utility>

namespace noli::test {
namespace {

constexpr double kDhat = 0.1;
constexpr double kKappa = 3.0;
constexpr double kEps = 1e-3;  // unit edges
constexpr PairKind kKinds[] = {
    PairKind::PointPoint, PairKind::PointEdge, PairKind::EdgeEdge};

BarrierParams params_of(int exponent) {
    return {kDhat, kKappa, exponent, 0.0};
}

struct Sample {
    Stencil<4> x;
    MollifiedCase sub;
};

/// A near-parallel pair with its vertices relabelled at random, so that every place
/// occurs.
Sample sample(PairSampler& sampler, PairKind kind, double angle, double d) {
    Sample out{sampler.near_parallel(kind, angle, d), {kind, {0, 1, 2, 3}}};
    if (kind == PairKind::PointEdge) out.sub = {kind, {2, 0, 1, -1}};
    if (kind == PairKind::PointPoint) out.sub = {kind, {1, 2, -1, -1}};
    if (kind == PairKind::EdgeEdge) return out;
    int place[4] = {0, 1, 2, 3};
    if (sampler.uniform(0, 1) < 0.5) std::swap(place[0], place[1]);
    if (sampler.uniform(0, 1) < 0.5) std::swap(place[2], place[3]);
    if (sampler.uniform(0, 1) < 0.5) {
        std::swap(place[0], place[2]);
        std::swap(place[1], place[3]);
    }
    const Stencil<4> original = out.x;
    for (int i = 0; i < 4; ++i)
        out.x.x[place[i]] = original.x[i];
    for (int& local : out.sub.local)
        if (local >= 0) local = place[local];
    return out;
}

/// f(sample, exponent) over sub-cases, gaps, angles and exponents.
template <class F>
void sweep(unsigned seed, int samples, const F& f) {
    PairSampler sampler(seed);
    for (PairKind kind : kKinds) {
        for (double s : {0.9, 0.5, 0.1, 0.01}) {
            for (double angle : {0.03, 0.02, 0.006, 0.001}) {
                for (int k = 0; k < samples; ++k) {
                    SCOPED_TRACE(testing::Message() << "kind " << int(kind) << ", d/dhat "
                                                    << s << ", angle " << angle);
                    const Sample one = sample(sampler, kind, angle, s * kDhat);
                    f(one, 1);
                    f(one, 2);
                }
            }
        }
    }
}

template <class T>
T distance_sq_of(const MollifiedCase& sub, const Point<T>* x) {
    Point<T> points[4];
    for (int i = 0; i < 4; ++i)
        if (sub.local[i] >= 0) points[i] = x[sub.local[i]];
    return distance_sq_of<T>(sub.kind, points);
}

/// Exact jet of kappa m b.
Jet<12> oracle(const Sample& one, int r) {
    const auto x = variables(one.x);
    return Jet<12>(kKappa) * mollifier_of(x.data(), kEps)
         * barrier_of(r, distance_sq_of(one.sub, x.data()), kDhat);
}

Jet<12>::Gradient gradient(const Sample& one, int r) {
    return flat(mollified_gradient(one.sub, one.x, kEps, params_of(r)).g);
}

Jet<12>::Hessian hessian(MollifiedHessian model, const Sample& one, int r) {
    return dense(mollified_hessian(model, one.sub, one.x, kEps, params_of(r)));
}

TEST(MollifiedPair, GradientMatchesCentralDifferences) {
    sweep(1, 2, [](const Sample& one, int r) {
        const auto energy = [&](const Stencil<4>& y) {
            return Eigen::VectorXd::Constant(
                1, mollified_energy(one.sub, y, kEps, params_of(r)));
        };
        const double d = mollified_geometry(one.sub, one.x).d;
        const double angle =
            norm(cross(one.x.x[1] - one.x.x[0], one.x.x[3] - one.x.x[2]));
        const double h = 3e-3 * std::fmin(std::fmin(d, kDhat - d), angle);
        const Eigen::MatrixXd difference = central_differences(energy, one.x, h);
        EXPECT_LE(relative_error(gradient(one, r), difference.transpose()), 1e-6);
    });
}

TEST(MollifiedPair, ValueAndGradientMatchTheNaiveFormula) {
    sweep(2, 5, [](const Sample& one, int r) {
        const Jet<12> exact = oracle(one, r);
        EXPECT_NEAR(
            mollified_energy(one.sub, one.x, kEps, params_of(r)) / exact.v, 1.0, 1e-9);
        EXPECT_LE(relative_error(gradient(one, r), exact.g), 1e-9);
    });
}

TEST(MollifiedPair, OracleHessianMatchesDifferencesOfTheGradient) {
    sweep(3, 1, [](const Sample& one, int r) {
        const auto g = [&](const Stencil<4>& y) -> Eigen::VectorXd {
            return gradient({y, one.sub}, r);
        };
        const double d = mollified_geometry(one.sub, one.x).d;
        const double angle =
            norm(cross(one.x.x[1] - one.x.x[0], one.x.x[3] - one.x.x[2]));
        const double h = 3e-3 * std::fmin(std::fmin(d, kDhat - d), angle);
        const Eigen::MatrixXd difference = central_differences(g, one.x, h);
        EXPECT_LE(relative_error(difference, oracle(one, r).h), 1e-6);
    });
}

TEST(MollifiedPair, ExactHessianEqualsTheDenseProjection) {
    double worst = 0.0;
    sweep(4, 5, [&](const Sample& one, int r) {
        const double error = relative_error(hessian(MollifiedHessian::Exact, one, r),
                                            positive_part(oracle(one, r).h));
        EXPECT_LE(error, 1e-8);
        worst = std::fmax(worst, error);
    });
    std::printf("mollified exact against dense projection: worst %.2e\n", worst);
}

/// MATH 3.3 and 3.4 written densely with the closed forms in g of MATH 1.2 and 1.3.
Jet<12>::Hessian closed_form(const Sample& one, int r, bool keep_gamma_modes) {
    const auto x = variables(one.x);
    const Point<Jet<12>> k = times(minus(x[1], x[0]), minus(x[3], x[2]));
    const Jet<12> c = sqrt(scalar(k, k));
    const Jet<12> d = sqrt(distance_sq_of(one.sub, x.data()));
    const double gamma = c.v * c.v;
    const double s = d.v / kDhat;
    const double g = s * s;
    const double L = std::log(g);
    const double K = kKappa * std::pow(kDhat, 4);
    const double b = K * (g - 1) * (g - 1) * (r == 1 ? -L : L * L);
    const double b1 = r == 1 ? -K * (g - 1) * (2 * g * L + g - 1) / g
                             : 2 * K * L * (g - 1) * (g * L + g - 1) / g;
    const double lambda1 =
        r == 1 ? 2 * K * (6 * g + 2 * g * L - 7 * g * g - 6 * g * g * L + 1) / g
               : 4 * K
                     * (3 * g * g * L * L + 7 * g * g * L + 2 * g * g - g * L * L
                        - 6 * g * L - 4 * g - L + 2)
                     / g;
    const double m = 2 * gamma / kEps - gamma * gamma / (kEps * kEps);
    const double m1 = 2 * (kEps - gamma) / (kEps * kEps);
    Eigen::Matrix2d M;
    M(0, 0) = 4 * b * (kEps - 3 * gamma) / (kEps * kEps);
    M(0, 1) = M(1, 0) = 4 * c.v * s * m1 * b1;
    M(1, 1) = m * lambda1;
    Eigen::Matrix<double, 12, 2> A;
    A.col(0) = c.g;
    A.col(1) = d.g / kDhat;
    Jet<12>::Hessian H = A * positive_part(M) * A.transpose();
    if (!keep_gamma_modes) return H;
    Eigen::Matrix<double, 3, 12> K_x;
    Eigen::Vector3d k_hat;
    for (int i = 0; i < 3; ++i) {
        K_x.row(i) = k[i].g.transpose();
        k_hat[i] = k[i].v / c.v;
    }
    return H
         + 2 * m1 * b * K_x.transpose()
               * (Eigen::Matrix3d::Identity() - k_hat * k_hat.transpose()) * K_x;
}

TEST(MollifiedPair, TwoAndFourModesMatchTheirFormulas) {
    sweep(5, 5, [](const Sample& one, int r) {
        const BarrierParams params = params_of(r);
        EXPECT_LE(relative_error(hessian(MollifiedHessian::TwoMode, one, r),
                                 closed_form(one, r, false)),
                  1e-9);
        EXPECT_LE(relative_error(hessian(MollifiedHessian::FourMode, one, r),
                                 closed_form(one, r, true)),
                  1e-9);
        for (auto model : {MollifiedHessian::TwoMode,
                           MollifiedHessian::FourMode,
                           MollifiedHessian::Exact})
            EXPECT_LE(mollified_hessian(model, one.sub, one.x, kEps, params).rank,
                      max_rank(model));
    });
}

/// Mean and standard deviation of a model's relative error over random pairs.
struct Spread {
    double sum = 0.0;
    double sum_sq = 0.0;
    int count = 0;
    void add(double error) {
        sum += error;
        sum_sq += error * error;
        ++count;
    }
    [[nodiscard]] double mean() const { return sum / count; }
    [[nodiscard]] double deviation() const {
        return std::sqrt(sum_sq / count - mean() * mean());
    }
};

// MATH 3.4 reports 0.97, 0.85, 0.81 for two modes and 0.69, 0.48, 0.37 for four (EE, PE,
// PP), each the mean of 20 random pairs; the tolerance is three standard errors of such a
// mean.
TEST(MollifiedPair, ModelErrorsAreThoseOfTheReference) {
    const double two_reference[] = {0.81, 0.85, 0.97};
    const double four_reference[] = {0.37, 0.48, 0.69};
    PairSampler sampler(6);
    for (int kind = 0; kind < 3; ++kind) {
        Spread two;
        Spread four;
        for (int k = 0; k < 2000; ++k) {
            const double angle = 1e-2 * sampler.uniform(0.3, 2.0);
            const Sample one =
                sample(sampler, kKinds[kind], angle, sampler.uniform(0.02, 0.08));
            const auto exact = hessian(MollifiedHessian::Exact, one, 2);
            two.add(relative_error(hessian(MollifiedHessian::TwoMode, one, 2), exact));
            four.add(relative_error(hessian(MollifiedHessian::FourMode, one, 2), exact));
        }
        std::printf(
            "mollified kind %d: two modes %.3f +- %.3f, four modes %.3f +- %.3f\n",
            kind,
            two.mean(),
            two.deviation(),
            four.mean(),
            four.deviation());
        const double errors_of_20 = 3.0 / std::sqrt(20.0);
        EXPECT_NEAR(two.mean(), two_reference[kind], errors_of_20 * two.deviation());
        EXPECT_NEAR(four.mean(), four_reference[kind], errors_of_20 * four.deviation());
        EXPECT_LT(four.mean(), two.mean() - 0.2);
    }
}

TEST(MollifiedPair, ExactlyParallelEdgesHaveFiniteExactCurvature) {
    for (PairKind kind : {PairKind::PointPoint, PairKind::PointEdge}) {
        for (int r : {1, 2}) {
            // along an axis, so that the cross product is exactly zero
            const double start = kind == PairKind::PointEdge ? 0.5 : 1.02;
            Sample one{{{{0.0, 0.0, 0.0},
                         {1.0, 0.0, 0.0},
                         {start, 0.04, 0.0},
                         {start + 1, 0.04, 0.0}}},
                       {kind, {2, 0, 1, -1}}};
            if (kind == PairKind::PointPoint) one.sub = {kind, {1, 2, -1, -1}};
            ASSERT_EQ(edge_cross_sq(one.x), 0.0);
            EXPECT_EQ(mollified_energy(one.sub, one.x, kEps, params_of(r)), 0.0);
            EXPECT_EQ(gradient(one, r).norm(), 0.0);
            const auto exact = oracle(one, r).h;
            EXPECT_GT(exact.norm(), 0.0);
            EXPECT_LE(relative_error(hessian(MollifiedHessian::FourMode, one, r), exact),
                      1e-12);
            EXPECT_LE(relative_error(hessian(MollifiedHessian::Exact, one, r), exact),
                      1e-12);
            EXPECT_EQ(mollified_hessian(
                          MollifiedHessian::TwoMode, one.sub, one.x, kEps, params_of(r))
                          .rank,
                      0);
        }
    }
}

TEST(MollifiedPair, FourModesAreContinuousTowardsParallelEdges) {
    const auto at_angle = [](double angle) {
        return Sample{{{{0.0, 0.0, 0.0},
                        {1.0, 0.0, 0.0},
                        {0.5, 0.04, 0.0},
                        {0.5 + std::cos(angle), 0.04, std::sin(angle)}}},
                      {PairKind::PointEdge, {2, 0, 1, -1}}};
    };
    const auto parallel = hessian(MollifiedHessian::FourMode, at_angle(0.0), 2);
    for (double angle : {1e-4, 1e-6, 1e-9, 1e-160}) {
        const auto near = hessian(MollifiedHessian::FourMode, at_angle(angle), 2);
        EXPECT_LE(relative_error(near, parallel), 400.0 * angle + 1e-12) << angle;
    }
}

TEST(MollifiedPair, MeetsThePlainPairAtTheThreshold) {
    PairSampler sampler(8);
    const Vec3d u{1.0, 0.0, 0.0};
    const double angle = std::asin(std::sqrt(kEps));
    const Vec3d v{std::cos(angle), std::sin(angle), 0.0};
    const Stencil<4> x = sampler.crossing_edges(u, v, 0.3 * kDhat);
    const MollifiedCase sub{PairKind::EdgeEdge, {0, 1, 2, 3}};
    const double threshold = edge_cross_sq(x);  // exactly at the border, and just inside
    for (double eps : {threshold, threshold * (1 + 1e-9)}) {
        const BarrierParams params = params_of(2);
        EXPECT_NEAR(mollified_energy(sub, x, eps, params)
                        / pair_energy(PairKind::EdgeEdge, x, params),
                    1.0,
                    1e-9);
        EXPECT_LE(relative_error(flat(mollified_gradient(sub, x, eps, params).g),
                                 flat(pair_gradient(PairKind::EdgeEdge, x, params).g)),
                  1e-6);
    }
}

}  // namespace
}  // namespace noli::test
