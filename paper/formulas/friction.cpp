// SPDX-License-Identifier: Apache-2.0
#include "energy/friction_hessian.hpp"
#include "tables.hpp"

#include <Eigen/Dense>

#include <cmath>
#include <random>

namespace noli::paper {
namespace {

constexpr double kEps = 1e-5;  // eps_v dt, m

/// mu lambda times Eq. (20) as printed, f_1 of Eq. (17).
Eigen::Matrix2d printed_block(const Eigen::Vector2d& u, double mu_lambda) {
    const double y = u.norm();
    const double f1 = y < kEps ? -y * y / (kEps * kEps) + 2.0 * y / kEps : 1.0;
    const double df1 = y < kEps ? -2.0 * y / (kEps * kEps) + 2.0 / kEps : 0.0;
    return mu_lambda
         * ((df1 * y - f1) / (y * y * y) * u * u.transpose()
            + f1 / y * Eigen::Matrix2d::Identity());
}

/// The library's block: a point on the plane z = 0 slides by u.
Eigen::Matrix2d library_block(const Eigen::Vector2d& u, double mu, double normal_force) {
    const FrictionBasis<1> basis{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {1.0}, normal_force};
    const auto modes = friction_hessian(basis, {{{u[0], u[1], 0.0}}}, mu, kEps);
    Eigen::Matrix2d out = Eigen::Matrix2d::Zero();
    for (int k = 0; k < modes.rank; ++k) {
        const Eigen::Vector2d q(modes.q[k][0].x, modes.q[k][0].y);
        out += q * q.transpose();
    }
    return out;
}

/// min and max eigenvalue of both blocks and what projecting the printed one changes.
struct BlockRow {
    Eigen::Vector2d printed, library;
    double difference, projection;  ///< relative to the printed block
};

BlockRow row_of(const Eigen::Vector2d& u, double mu, double normal_force) {
    using Eigensolver = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>;
    const Eigen::Matrix2d printed = printed_block(u, mu * normal_force);
    const Eigen::Matrix2d library = library_block(u, mu, normal_force);
    const Eigensolver eigen(printed);
    const Eigen::Matrix2d projected = eigen.eigenvectors()
                                    * eigen.eigenvalues().cwiseMax(0.0).asDiagonal()
                                    * eigen.eigenvectors().transpose();
    return {eigen.eigenvalues(),
            Eigensolver(library).eigenvalues(),
            (library - printed).norm() / printed.norm(),
            (projected - printed).norm() / printed.norm()};
}

}  // namespace

/// Eigenvalues are in units of mu lambda / eps.
void print_friction(const SampleOptions& options) {
    std::printf(
        "u_over_eps,mu_lambda,printed_min,printed_max,library_min,library_max,f1,f0_over_"
        "eps,"
        "difference,projection\n");
    std::mt19937_64 rng(options.seed);
    std::uniform_real_distribution<> unit(0.0, 1.0);
    constexpr double kMu = 0.4;
    constexpr double kPi = 3.14159265358979323846;
    for (int i = 0; i < options.samples; ++i) {
        const double slip = std::pow(10.0, -4.0 + 6.0 * (i + 0.5) / options.samples);
        const double normal_force = std::pow(10.0, -6.0 + 12.0 * unit(rng));
        const double angle = 2.0 * kPi * unit(rng);
        const Eigen::Vector2d u =
            slip * kEps * Eigen::Vector2d(std::cos(angle), std::sin(angle));
        const BlockRow row = row_of(u, kMu, normal_force);
        const double scale = kEps / (kMu * normal_force);
        const FrictionJet law = friction_law(u.norm(), kEps);
        std::printf("%.10g,%.10g,%.10g,%.10g,%.10g,%.10g,%.10g,%.10g,%.3g,%.3g\n",
                    slip,
                    kMu * normal_force,
                    scale * row.printed[0],
                    scale * row.printed[1],
                    scale * row.library[0],
                    scale * row.library[1],
                    law.f1,
                    law.f0 / kEps,
                    row.difference,
                    row.projection);
    }
}

}  // namespace noli::paper
