// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Deformation gradients that elastic formulas must survive, and conversions to Eigen.

#include "energy/tet.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <random>
#include <string>
#include <vector>

namespace noli::elastic_test {

inline Eigen::Matrix3d to_eigen(const Mat3d& m) {
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(m.a);
}

inline Mat3d from_eigen(const Eigen::Matrix3d& m) {
    Mat3d out;
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(out.a) = m;
    return out;
}

class Random {
  public:
    explicit Random(unsigned seed) : rng_(seed) {}

    double in(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(rng_);
    }
    Eigen::Matrix3d matrix(double size) {
        return Eigen::Matrix3d::NullaryExpr([&] { return in(-size, size); });
    }
    Eigen::Matrix3d rotation() {
        Eigen::Quaterniond q(in(-1, 1), in(-1, 1), in(-1, 1), in(-1, 1));
        return q.normalized().toRotationMatrix();
    }
    /// U diag(s) V^T with random rotations.
    Mat3d with_singular_values(double a, double b, double c) {
        return from_eigen(rotation() * Eigen::Vector3d(a, b, c).asDiagonal()
                          * rotation().transpose());
    }

  private:
    std::mt19937 rng_;
};

struct DeformationCase {
    std::string name;
    std::array<double, 3> sigma;
    Mat3d F;
};

/// Rest, random, stretched, compressed, nearly flat, repeated singular values; also
/// inverted ones when `inverted`.
inline std::vector<DeformationCase> deformation_cases(bool inverted) {
    const std::vector<std::pair<std::string, std::array<double, 3>>> named = {
        {"rigid rotation", {1, 1, 1}},
        {"slightly strained", {1.001, 1.0002, 0.9996}},
        {"moderately strained", {1.3, 1.05, 0.7}},
        {"stretched along one axis", {9, 0.6, 0.5}},
        {"stretched in a plane", {6, 5, 0.1}},
        {"stretched in all directions", {3.1, 2.9, 2.5}},
        {"compressed along one axis", {1.1, 1.05, 0.02}},
        {"compressed in all directions", {0.12, 0.1, 0.09}},
        {"nearly flat", {1.2, 0.9, 1e-4}},
        {"all equal, large", {1.6, 1.6, 1.6}},
        {"all equal, small", {0.6, 0.6, 0.6}},
        {"two largest equal", {1.3, 1.3, 0.7}},
        {"two smallest equal", {1.4, 0.8, 0.8}},
        {"two equal to 1e-9", {1.4, 0.8 + 1e-9, 0.8}},
        {"slightly inverted", {1.1, 0.9, -1e-3}},
        {"inverted", {1.2, 0.9, -0.4}},
        {"inverted and stretched", {4, 2, -1.5}},
        {"inverted, two largest equal", {1.1, 1.1, -0.5}},
    };
    Random random(11);
    std::vector<DeformationCase> cases{{"rest", {1, 1, 1}, identity3()}};
    for (const auto& [name, s] : named) {
        if (s[2] > 0.0 || inverted)
            cases.push_back({name, s, random.with_singular_values(s[0], s[1], s[2])});
    }
    for (int k = 0; k < 20; ++k) {
        const double c = random.in(0.2, 0.9) * (inverted && k % 2 == 1 ? -1.0 : 1.0);
        const double b = random.in(1.0, 1.3);
        const double a = random.in(1.3, 2.5);
        cases.push_back({"random " + std::to_string(k),
                         {a, b, c},
                         random.with_singular_values(a, b, c)});
    }
    return cases;
}

/// A tetrahedron of unit weight whose edge vectors from vertex 0 are the columns of F
/// D_m; x_0 is not the origin.
inline TetShape<double> tet_with(const Mat3d& F, const Mat3d& dm_inv, double weight) {
    const Mat3d ds = F * inverse(dm_inv);
    const Vec3d x0{0.3, -0.2, 0.5};
    return {{x0, x0 + ds.col(0), x0 + ds.col(1), x0 + ds.col(2)}, dm_inv, weight};
}

using Matrix12 = Eigen::Matrix<double, 12, 12>;
using Matrix9 = Eigen::Matrix<double, 9, 9>;

inline Matrix12 to_eigen(const TetHessian<double>& h) {
    Matrix12 out;
    int k = 0;
    for (int a = 0; a < 4; ++a) {
        for (int b = a; b < 4; ++b, ++k) {
            out.block<3, 3>(3 * a, 3 * b) = to_eigen(h.block[k]);
            out.block<3, 3>(3 * b, 3 * a) = to_eigen(h.block[k]).transpose();
        }
    }
    return out;
}

/// d2Psi/dF2 on vec(F) (columns stacked): what tet_hessian gives for D_m = identity.
template <ElasticModel M>
Matrix9 density_hessian(const Mat3d& F,
                        const LameParameters<double>& lame,
                        bool project) {
    const TetShape<double> tet = tet_with(F, identity3(), 1.0);
    const Matrix12 hessian = to_eigen(tet_hessian<M>(tet, lame, project));
    return hessian.bottomRightCorner<9, 9>();
}

}  // namespace noli::elastic_test
