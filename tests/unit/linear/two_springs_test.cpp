// SPDX-License-Identifier: Apache-2.0
/// The supplement's example of a product without a global matrix: two springs in the
/// plane, on the nodes 0-1 and 1-2. Source: supplement section 6, Eqs. (21)-(25), Fig. 4.
/// (Eqs. (24) and (25) give c'_a and c'_b the size 2 x 1; both have two nodes of two
/// components, so 4 x 1.)

#include "linear/warp_product.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <vector>

namespace noli {
namespace {

constexpr double kStiffness[2] = {70.0, 310.0};  // N/m
constexpr double kRestLength[2] = {0.8, 1.7};    // m

/// Gradient of Psi = k/2 (|x1 - x0| - L)^2 with respect to (x0, x1).
Eigen::Vector4d spring_gradient(const Eigen::Vector4d& x, double k, double rest) {
    const Eigen::Vector2d e = x.tail<2>() - x.head<2>();
    const Eigen::Vector2d f = k * (1.0 - rest / e.norm()) * e;
    return (Eigen::Vector4d() << -f, f).finished();
}

/// Its derivative: k (n n^T + (1 - L / |e|)(I - n n^T)) in the blocks [+ -; - +].
Eigen::Matrix4d spring_hessian(const Eigen::Vector4d& x, double k, double rest) {
    const Eigen::Vector2d e = x.tail<2>() - x.head<2>();
    const Eigen::Matrix2d nn = e * e.transpose() / e.squaredNorm();
    const Eigen::Matrix2d block =
        k * (nn + (1.0 - rest / e.norm()) * (Eigen::Matrix2d::Identity() - nn));
    return (Eigen::Matrix4d() << block, -block, -block, block).finished();
}

class TwoSprings : public testing::Test {
  protected:
    Eigen::Matrix<double, 6, 1> x{0.1, 0.2, 1.3, -0.4, 2.1, 1.6};
    Eigen::Matrix<double, 6, 1> c{0.7, -1.1, 0.3, 2.3, -0.9, 0.5};
    Eigen::Matrix4d A = spring_hessian(x.head<4>(), kStiffness[0], kRestLength[0]);
    Eigen::Matrix4d B = spring_hessian(x.tail<4>(), kStiffness[1], kRestLength[1]);
};

TEST_F(TwoSprings, LocalMatricesAreTheHessiansOfTheSprings) {  // Eqs. (21), (22)
    constexpr double h = 1e-6;
    for (int s = 0; s < 2; ++s)
        for (int j = 0; j < 4; ++j) {
            Eigen::Vector4d plus = x.segment<4>(2 * s);
            Eigen::Vector4d minus = plus;
            plus[j] += h;
            minus[j] -= h;
            const Eigen::Vector4d column =
                (spring_gradient(plus, kStiffness[s], kRestLength[s])
                 - spring_gradient(minus, kStiffness[s], kRestLength[s]))
                / (2.0 * h);
            EXPECT_LT((column - (s == 0 ? A : B).col(j)).norm(), 1e-6 * kStiffness[s]);
        }
}

TEST_F(TwoSprings, LocalProductsMergeIntoTheGlobalProduct) {  // Eqs. (23)-(25)
    Eigen::Matrix<double, 6, 6> global = Eigen::Matrix<double, 6, 6>::Zero();
    global.topLeftCorner<4, 4>() += A;
    global.bottomRightCorner<4, 4>() += B;
    const Eigen::Vector4d c_a = A * c.head<4>();
    const Eigen::Vector4d c_b = B * c.tail<4>();
    Eigen::Matrix<double, 6, 1> merged;
    merged << c_a.head<2>(), c_a.tail<2>() + c_b.head<2>(), c_b.tail<2>();
    EXPECT_LT((merged - global * c).norm(), 1e-14 * merged.norm());
}

TEST_F(TwoSprings, WarpProductGivesTheGlobalProduct) {
    const std::vector<int> vertices{0, 1, 1, 2};  // the local-to-global map
    std::vector<double> values;
    for (const Eigen::Matrix4d* block : {&A, &B})
        for (int i = 0; i < 16; ++i)
            values.push_back((*block)(i / 4, i % 4));
    const DenseBlockView<4, 2> blocks{{values.data(), 32}, {vertices.data(), 4}};
    Eigen::Matrix<double, 6, 1> y = Eigen::Matrix<double, 6, 1>::Zero();
    const int writes =
        simulate_warp_product(blocks, {0, 32}, 32, {c.data(), 6}, {y.data(), 6});
    EXPECT_EQ(writes, 8);  // one full warp, one write per row of either block

    Eigen::Matrix<double, 6, 6> global = Eigen::Matrix<double, 6, 6>::Zero();
    global.topLeftCorner<4, 4>() += A;
    global.bottomRightCorner<4, 4>() += B;
    EXPECT_LT((y - global * c).norm(), 1e-14 * y.norm());
}

}  // namespace
}  // namespace noli
