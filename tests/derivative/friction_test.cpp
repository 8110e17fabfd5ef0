// SPDX-License-Identifier: Apache-2.0
/// Friction against finite differences, inside, at and beyond the sticking radius.
#include "derivative/contact_oracle.hpp"
#include "energy/friction_hessian.hpp"

#include <gtest/gtest.h>

namespace noli::test {
namespace {

constexpr double kMu = 0.4;
constexpr double kEps = 1e-3;
constexpr BarrierParams kParams{1e-2, 1e8, 2, 0.0};

/// Displacements whose tangential part has the given length, in a random direction, plus
/// a motion along the normal and one that moves all points alike where the weights sum to
/// zero.
template <int S>
Stencil<S> moved_by(PairSampler& sampler, const FrictionBasis<S>& basis, double y) {
    Stencil<S> out;
    for (Vec3d& p : out.x)
        p = kEps * sampler.normal();
    const Vec2d now = detail::tangential_displacement(basis, out);
    const double angle = sampler.uniform(0.0, 6.28);
    const Vec3d wanted = (y * std::cos(angle) - now.x) * basis.t0
                       + (y * std::sin(angle) - now.y) * basis.t1;
    out.x[0] += (1.0 / basis.w[0]) * wanted;
    return out;
}

template <class F>
void for_each_basis(unsigned seed, const F& f) {
    PairSampler sampler(seed);
    for (int k = 0; k < 5; ++k) {
        for_each_kind(sampler, 4e-3, 0.1, [&](PairKind kind, auto x) {
            f(sampler, friction_basis(kind, x, kParams));
        });
        const Wall plane{normalized(sampler.normal()), 0.3};
        f(sampler, wall_friction_basis((0.3 + 4e-3) * plane.normal, plane, kParams));
        const Wall pipe{
            normalized(sampler.normal()), 0.0, WallShape::Cylinder, {0.1, 0, 0}, 0.2};
        const Vec3d out = normalized(across_axis(pipe, sampler.normal()));
        const Vec3d inside = pipe.center + (pipe.radius - 4e-3) * out;
        f(sampler, wall_friction_basis(inside, pipe, kParams));
        const MollifiedCase sub{PairKind::PointEdge, {2, 0, 1, -1}};
        const Stencil<4> x = sampler.near_parallel(PairKind::PointEdge, 0.02, 4e-3);
        FrictionBasis<4> basis = mollified_friction_basis(sub, x, 1e-3, kParams);
        f(sampler, basis);
    }
}

/// Moves a point with a non-zero weight: mollified bases have zero weights at some
/// vertices.
template <int S>
FrictionBasis<S> starting_with_a_weight(FrictionBasis<S> basis) {
    for (int i = 1; i < S && basis.w[0] == 0.0; ++i)
        std::swap(basis.w[0], basis.w[i]);
    return basis;
}

TEST(Friction, GradientMatchesCentralDifferences) {
    for_each_basis(1, []<int S>(PairSampler& sampler, FrictionBasis<S> basis) {
        basis = starting_with_a_weight(basis);
        for (double y : {0.01, 0.3, 0.9, 1.1, 5.0}) {
            const Stencil<S> moved = moved_by(sampler, basis, y * kEps);
            const auto energy = [&](const Stencil<S>& u) {
                return Eigen::VectorXd::Constant(1, friction_energy(basis, u, kMu, kEps));
            };
            const double h = 1e-3 * kEps;
            const Eigen::MatrixXd difference = central_differences(energy, moved, h);
            const auto exact = flat(friction_gradient(basis, moved, kMu, kEps).g);
            EXPECT_LE(relative_error(exact, difference.transpose()), 1e-7) << y;
        }
    });
}

TEST(Friction, HessianMatchesCentralDifferencesWithoutProjection) {
    for_each_basis(2, []<int S>(PairSampler& sampler, FrictionBasis<S> basis) {
        basis = starting_with_a_weight(basis);
        for (double y : {0.01, 0.3, 0.9, 1.1, 5.0}) {
            const Stencil<S> moved = moved_by(sampler, basis, y * kEps);
            const auto g = [&](const Stencil<S>& u) -> Eigen::VectorXd {
                return flat(friction_gradient(basis, u, kMu, kEps).g);
            };
            const double h = 5e-4 * kEps;
            const Eigen::MatrixXd difference = central_differences(g, moved, h);
            EXPECT_LE(relative_error(dense(friction_hessian(basis, moved, kMu, kEps)),
                                     difference),
                      1e-7)
                << y;
        }
    });
}

TEST(Friction, EigenvaluesAreSlopeAndSecantOfTheLaw) {
    for_each_basis(3, []<int S>(PairSampler& sampler, FrictionBasis<S> basis) {
        basis = starting_with_a_weight(basis);
        double w_sq = 0.0;
        for (double w : basis.w)
            w_sq += w * w;
        for (double y : {0.2, 0.8, 2.0}) {
            const Stencil<S> moved = moved_by(sampler, basis, y * kEps);
            const auto H = dense(friction_hessian(basis, moved, kMu, kEps));
            const double unit = kMu * basis.normal_force * w_sq / kEps;
            const double slope = y < 1.0 ? 2.0 - 2.0 * y : 0.0;
            const double secant = y < 1.0 ? 2.0 - y : 1.0 / y;
            const Eigen::SelfAdjointEigenSolver<std::decay_t<decltype(H)>> eigen(H);
            const auto values = eigen.eigenvalues();  // ascending
            EXPECT_NEAR(values[3 * S - 1] / unit, secant, 1e-10);
            EXPECT_NEAR(values[3 * S - 2] / unit, slope, 1e-10);
            EXPECT_LE(std::fabs(values[0]) / unit, 1e-10);
        }
    });
}

TEST(Friction, IsContinuousAtTheStickingRadius) {
    for_each_basis(4, []<int S>(PairSampler& sampler, FrictionBasis<S> basis) {
        basis = starting_with_a_weight(basis);
        const Stencil<S> moved = moved_by(sampler, basis, kEps);
        Stencil<S> in = moved;
        Stencil<S> out = moved;
        for (int i = 0; i < S; ++i) {
            in.x[i] *= 1.0 - 1e-9;
            out.x[i] *= 1.0 + 1e-9;
        }
        EXPECT_NEAR(friction_energy(basis, in, kMu, kEps)
                        / friction_energy(basis, out, kMu, kEps),
                    1.0,
                    1e-8);
        EXPECT_LE(relative_error(flat(friction_gradient(basis, in, kMu, kEps).g),
                                 flat(friction_gradient(basis, out, kMu, kEps).g)),
                  1e-8);
        EXPECT_LE(relative_error(dense(friction_hessian(basis, in, kMu, kEps)),
                                 dense(friction_hessian(basis, out, kMu, kEps))),
                  1e-8);
    });
}

}  // namespace
}  // namespace noli::test
