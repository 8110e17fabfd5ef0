// SPDX-License-Identifier: Apache-2.0
/// Supplement 1: the explicit E, Ebar and F of every pair type, and the library's closed
/// forms built from them. Reference: support/paper_constructions.hpp.
#include "derivative/contact_oracle.hpp"
#include "support/paper_constructions.hpp"

#include <gtest/gtest.h>

namespace noli::test {
namespace {

constexpr double kDhat = 1e-2;
constexpr double kKappa = 3.0;

/// f(kind, stencil, s = d / dhat) over sizes and gaps of random pairs of every kind.
template <class F>
void sweep(unsigned seed, const F& f) {
    PairSampler sampler(seed);
    for (double size : {2.0, 10.0, 100.0})
        for (double s : {0.05, 0.3, 0.7, 0.95})
            for (int k = 0; k < 20; ++k)
                for_each_kind(
                    sampler, s * kDhat, size * kDhat, [&](PairKind kind, auto x) {
                        SCOPED_TRACE(testing::Message()
                                     << "kind " << int(kind) << ", size " << size
                                     << ", s " << s);
                        f(kind, x, s);
                    });
}

TEST(PaperConstruction, MeasuresTheDistanceOfThePair) {
    sweep(1, []<int S>(PairKind kind, const Stencil<S>& x, double s) {
        const Shape<S> shape = paper_shape(kind, x, kDhat);
        EXPECT_NEAR(shape.d / kDhat, s, 1e-9);
        EXPECT_NEAR(shape.d / pair_geometry(kind, x).d, 1.0, 1e-9);
        EXPECT_NEAR(shape.normal.norm(), 1.0, 1e-12);
    });
}

TEST(PaperConstruction, IdealShapeIsThePairAtDistanceDhat) {
    sweep(2, []<int S>(PairKind kind, const Stencil<S>& x, double) {
        const Shape<S> shape = paper_shape(kind, x, kDhat);
        // Normal component of the ideal gap: x_1 against the others (PT, PE, PP), or the
        // second edge against the first.
        const auto heights = (shape.normal.transpose() * shape.ideal).eval();
        if (kind == PairKind::EdgeEdge) {
            EXPECT_NEAR(heights[0], 0.0, 1e-9 * kDhat);
            EXPECT_NEAR(heights[1] / kDhat, 1.0, 1e-9);
            EXPECT_NEAR(heights[2] / kDhat, 1.0, 1e-9);
            return;
        }
        for (int i = 0; i < S - 1; ++i)
            EXPECT_NEAR(heights[i] / kDhat, -1.0, 1e-9);
    });
}

TEST(PaperConstruction, StretchIsDiagonalWithTheGapAlongTheNormal) {
    sweep(3, []<int S>(PairKind kind, const Stencil<S>& x, double s) {
        const Shape<S> shape = paper_shape(kind, x, kDhat);
        const auto F = shape.jacobian().eval();
        const auto identity = Eigen::Matrix<double, S - 1, S - 1>::Identity();
        const auto normal_part = (shape.normal * shape.normal.transpose()).eval();
        EXPECT_LE((F.transpose() * F - identity - (s * s - 1.0) * normal_part).norm(),
                  1e-8);
        EXPECT_NEAR((F * shape.normal).squaredNorm(), s * s, 1e-9);
        if constexpr (S == 4) {
            EXPECT_LE((F - identity - (s - 1.0) * normal_part).norm(), 1e-8);
        }
    });
}

TEST(PaperConstruction, NormalIsThatOfTheLibrary) {
    sweep(4, []<int S>(PairKind kind, const Stencil<S>& x, double s) {
        const Shape<S> shape = paper_shape(kind, x, kDhat);
        const Eigen::Vector3d stretched = shape.jacobian() * shape.normal;
        const Vec3d n = pair_geometry(kind, x).n;
        // The supplement's edge-edge normal points from the first edge to the second.
        const double sign = kind == PairKind::EdgeEdge ? -1.0 : 1.0;
        EXPECT_LE((sign / s * stretched - Eigen::Vector3d(n.x, n.y, n.z)).norm(), 1e-9);
    });
}

TEST(PaperConstruction, GradientThroughFIsTheClosedForm) {
    sweep(5, []<int S>(PairKind kind, const Stencil<S>& x, double) {
        for (int r : {1, 2}) {
            const BarrierParams params{kDhat, kKappa, r, 0.0};
            const auto space = jacobian_space(paper_shape(kind, x, kDhat), params);
            const auto basis = change_of_basis(kind, x, kDhat);
            const auto closed = flat(pair_gradient(kind, x, params).g);
            EXPECT_LE(
                relative_error((basis.sum().transpose() * space.stress).eval(), closed),
                1e-8);
            EXPECT_LE(
                relative_error((basis.first.transpose() * space.stress).eval(), closed),
                1e-8);
        }
    });
}

TEST(PaperConstruction, KeptModeThroughFIsTheGaussNewtonHessian) {
    sweep(6, []<int S>(PairKind kind, const Stencil<S>& x, double) {
        for (int r : {1, 2}) {
            const BarrierParams params{kDhat, kKappa, r, 0.0};
            const auto space = jacobian_space(paper_shape(kind, x, kDhat), params);
            const auto basis = change_of_basis(kind, x, kDhat);
            const auto closed =
                dense(pair_hessian(ContactHessian::GaussNewton, kind, x, params));
            for (const auto& tensor : {basis.sum(), basis.first}) {
                const auto q = (tensor.transpose() * space.kept).eval();
                EXPECT_LE(
                    relative_error((space.lambda1 * q * q.transpose()).eval(), closed),
                    1e-8);
            }
        }
    });
}

}  // namespace
}  // namespace noli::test
