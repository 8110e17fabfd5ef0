// SPDX-License-Identifier: Apache-2.0
/// Supplement 2: the change-of-basis tensor, both terms of Eq. (4).
#include "derivative/contact_oracle.hpp"
#include "support/paper_constructions.hpp"

#include <gtest/gtest.h>

namespace noli::test {
namespace {

constexpr double kDhat = 0.1;

/// f(kind, stencil): pairs whose rotation of Eq. (2) is far from its singular direction,
/// where differences of H lose their digits.
template <class F>
void sweep(unsigned seed, const F& f) {
    PairSampler sampler(seed);
    for (double s : {0.1, 0.5, 0.9})
        for (int k = 0; k < 10; ++k)
            for_each_kind(
                sampler,
                s * kDhat,
                5.0 * kDhat,
                [&]<int S>(PairKind kind, const Stencil<S>& x) {
                    if constexpr (S == 2)
                        if (normalized(x.x[0] - x.x[1]).y < -0.8) return;
                    if constexpr (S == 3)
                        if (normalized(cross(x.x[1] - x.x[0], x.x[2] - x.x[0])).y < -0.8)
                            return;
                    SCOPED_TRACE(testing::Message()
                                 << "kind " << int(kind) << ", s " << s);
                    f(kind, x);
                });
}

template <class M>
Eigen::VectorXd vec(const M& matrix) {
    return matrix.reshaped();
}

TEST(ChangeOfBasis, SumMatchesDifferencesOfF) {
    sweep(1, []<int S>(PairKind kind, const Stencil<S>& x) {
        const auto F = [&](const Stencil<S>& y) {
            return vec(paper_shape(kind, y, kDhat).jacobian());
        };
        const Eigen::MatrixXd difference = central_differences(F, x, 1e-4 * kDhat);
        EXPECT_LE(relative_error(change_of_basis(kind, x, kDhat).sum(), difference),
                  1e-7);
    });
}

TEST(ChangeOfBasis, EachTermMatchesDifferencesWithTheOtherFactorFrozen) {
    sweep(2, []<int S>(PairKind kind, const Stencil<S>& x) {
        const Shape<S> here = paper_shape(kind, x, kDhat);
        const auto inverse = here.ideal.inverse().eval();
        const auto moving_current = [&](const Stencil<S>& y) {
            return vec((paper_shape(kind, y, kDhat).current * inverse).eval());
        };
        const auto moving_ideal = [&](const Stencil<S>& y) {
            return vec(
                (here.current * paper_shape(kind, y, kDhat).ideal.inverse()).eval());
        };
        const auto basis = change_of_basis(kind, x, kDhat);
        const double h = 1e-4 * kDhat;
        EXPECT_LE(relative_error(basis.first, central_differences(moving_current, x, h)),
                  1e-7);
        const Eigen::MatrixXd second = central_differences(moving_ideal, x, h);
        EXPECT_LE((basis.second - second).norm(), 1e-7 * basis.first.norm());
    });
}

TEST(ChangeOfBasis, SecondTermVanishesInTheKeptModeButNotElsewhere) {
    sweep(3, []<int S>(PairKind kind, const Stencil<S>& x) {
        const auto basis = change_of_basis(kind, x, kDhat);
        const auto space =
            jacobian_space(paper_shape(kind, x, kDhat), {kDhat, 1.0, 2, 0.0});
        EXPECT_LE((basis.second.transpose() * space.kept).norm(),
                  1e-10 * (basis.first.transpose() * space.kept).norm());
        if (kind == PairKind::PointPoint) {
            // The ideal shape is the constant dhat: there is no second term at all.
            EXPECT_LE(basis.second.norm(), 1e-10 * basis.first.norm());
        } else {
            EXPECT_GE(basis.second.norm(), 1e-2 * basis.first.norm());
        }
    });
}

}  // namespace
}  // namespace noli::test
