// SPDX-License-Identifier: Apache-2.0
/// Supplement 5: Eqs. (16) to (20) as printed (with the 3 s x 2 basis that Eq. (19)
/// needs) against the library's friction.
#include "derivative/contact_oracle.hpp"
#include "energy/friction_hessian.hpp"

#include <gtest/gtest.h>

namespace noli::test {
namespace {

constexpr double kMu = 0.3;
constexpr double kEps = 1e-4;  // eps_v dt

/// Eq. (17).
double printed_f1(double y) {
    return y < kEps ? -y * y / (kEps * kEps) + 2.0 * y / kEps : 1.0;
}
double printed_df1(double y) {
    return y < kEps ? -2.0 * y / (kEps * kEps) + 2.0 / kEps : 0.0;
}

/// T of Eq. (19): the columns are w (x) t.
template <int S>
Eigen::Matrix<double, 3 * S, 2> sliding_basis(const FrictionBasis<S>& basis) {
    Vec3d columns[2][S];
    for (int i = 0; i < S; ++i) {
        columns[0][i] = basis.w[i] * basis.t0;
        columns[1][i] = basis.w[i] * basis.t1;
    }
    Eigen::Matrix<double, 3 * S, 2> out;
    out << flat(columns[0]), flat(columns[1]);
    return out;
}

/// Eq. (20).
Eigen::Matrix2d printed_block(const Eigen::Vector2d& u) {
    const double y = u.norm();
    return (printed_df1(y) * y - printed_f1(y)) / (y * y * y) * u * u.transpose()
         + printed_f1(y) / y * Eigen::Matrix2d::Identity();
}

/// f(basis, moved) for random pairs of each kind and slips below and above eps.
template <class F>
void sweep(unsigned seed, const F& f) {
    PairSampler sampler(seed);
    const BarrierParams params{1e-3, 1e8, 2, 0.0};
    for (double slip : {1e-3, 0.3, 0.99, 1.01, 5.0})
        for (int k = 0; k < 10; ++k)
            for_each_kind(
                sampler, 0.4e-3, 1e-2, [&]<int S>(PairKind kind, const Stencil<S>& x) {
                    SCOPED_TRACE(testing::Message()
                                 << "kind " << int(kind) << ", slip " << slip);
                    const FrictionBasis<S> basis = friction_basis(kind, x, params);
                    Stencil<S> moved;
                    for (Vec3d& p : moved.x)
                        p = sampler.normal();
                    const Eigen::Vector2d u =
                        sliding_basis(basis).transpose() * flat(moved.x);
                    for (Vec3d& p : moved.x)
                        p *= slip * kEps / u.norm();
                    f(basis, moved);
                });
}

TEST(PaperFriction, Equation17IsTheLawOfTheLibraryAndTheSlopeOfItsPotential) {
    for (double s : {1e-3, 0.1, 0.5, 0.99, 1.01, 3.0}) {
        const double y = s * kEps;
        const FrictionJet f = friction_law(y, kEps);
        EXPECT_NEAR(f.f1, printed_f1(y), 1e-14);
        EXPECT_NEAR(f.df1 * kEps, printed_df1(y) * kEps, 1e-13);
        const double h = 1e-3 * kEps * std::fmin(s, 1.0);
        const double slope =
            (friction_law(y + h, kEps).f0 - friction_law(y - h, kEps).f0) / (2.0 * h);
        EXPECT_NEAR(slope, printed_f1(y), 1e-6 * printed_f1(y));
    }
    EXPECT_DOUBLE_EQ(friction_law(kEps, kEps).f0, kEps);
    EXPECT_DOUBLE_EQ(friction_law(std::nextafter(kEps, 0.0), kEps).f0, kEps);
}

TEST(PaperFriction, Equation16IsMinusTheGradientOfEquation18) {
    sweep(1, []<int S>(const FrictionBasis<S>& basis, const Stencil<S>& moved) {
        const auto T = sliding_basis(basis);
        const Eigen::Vector2d u = T.transpose() * flat(moved.x);
        const auto force =
            (-kMu * basis.normal_force * T * printed_f1(u.norm()) * u / u.norm()).eval();
        EXPECT_LE(
            relative_error(flat(friction_gradient(basis, moved, kMu, kEps).g), -force),
            1e-12);
        const auto potential = [&](const Stencil<S>& y) -> Eigen::VectorXd {
            return Eigen::VectorXd::Constant(1, friction_energy(basis, y, kMu, kEps));
        };
        const double h = 1e-3 * std::fmin(u.norm(), kEps);
        const Eigen::MatrixXd difference = central_differences(potential, moved, h);
        EXPECT_LE(relative_error(-force, difference.transpose()), 1e-5);
    });
}

TEST(PaperFriction, Equation19IsTheHessian) {
    sweep(2, []<int S>(const FrictionBasis<S>& basis, const Stencil<S>& moved) {
        const auto T = sliding_basis(basis);
        const Eigen::Vector2d u = T.transpose() * flat(moved.x);
        const auto printed =
            (kMu * basis.normal_force * T * printed_block(u) * T.transpose()).eval();
        EXPECT_LE(
            relative_error(dense(friction_hessian(basis, moved, kMu, kEps)), printed),
            1e-11);
        const auto gradient = [&](const Stencil<S>& y) -> Eigen::VectorXd {
            return flat(friction_gradient(basis, y, kMu, kEps).g);
        };
        const double h = 1e-3 * std::fmin(u.norm(), kEps);
        EXPECT_LE(relative_error(printed, central_differences(gradient, moved, h)), 1e-7);
    });
}

TEST(PaperFriction, ProjectionOfEquation20ChangesNothing) {
    PairSampler sampler(3);
    for (int k = 0; k < 2000; ++k) {
        const double y = kEps * std::pow(10.0, sampler.uniform(-6.0, 3.0));
        const double angle = sampler.uniform(-3.2, 3.2);
        const Eigen::Vector2d u(y * std::cos(angle), y * std::sin(angle));
        const Eigen::Matrix2d block = printed_block(u);
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(block);
        const double unit = 1.0 / kEps;
        EXPECT_NEAR(eigen.eigenvalues()[1], printed_f1(y) / y, 1e-12 * unit);
        EXPECT_NEAR(eigen.eigenvalues()[0], printed_df1(y), 1e-12 * unit);
        EXPECT_LE((positive_part(block) - block).norm(), 1e-14 * block.norm());
    }
}

}  // namespace
}  // namespace noli::test
