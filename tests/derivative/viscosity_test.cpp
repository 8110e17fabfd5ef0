// SPDX-License-Identifier: Apache-2.0
/// Viscosity of a tetrahedron: derivatives, and what it does not feel.
#include "energy/viscosity.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <random>

namespace noli::test {
namespace {

/// A tetrahedron of a few centimetres, moved by up to `by` metres since the step's start.
ViscousTet sample(std::mt19937& random, double by) {
    std::uniform_real_distribution<double> one(-1.0, 1.0);
    const auto jitter = [&](double size) {
        return size * Vec3d{one(random), one(random), one(random)};
    };
    Vec3d start[4] = {{0, 0, 0}, {0.05, 0, 0}, {0, 0.05, 0}, {0, 0, 0.05}};
    ViscousTet tet{};
    for (int c = 0; c < 4; ++c) {
        start[c] += jitter(0.01);
        tet.x[c] = start[c] + jitter(by);
    }
    const Mat3d d =
        from_columns(start[1] - start[0], start[2] - start[0], start[3] - start[0]);
    tet.d_inv = inverse(d);
    tet.volume = det(d) / 6.0;
    tet.mu = 3e5;
    tet.lambda = 8e5;
    return tet;
}

double& coordinate(ViscousTet& tet, int k) {
    Vec3d& x = tet.x[k / 3];
    return k % 3 == 0 ? x.x : k % 3 == 1 ? x.y : x.z;
}

TEST(Viscosity, GradientMatchesCentralDifferences) {
    std::mt19937 random(1);
    for (int n = 0; n < 20; ++n) {
        ViscousTet tet = sample(random, 0.01);
        Vec3d g[4];
        viscous_gradient(tet, g);
        const double h = 1e-7;
        double largest = 0.0;
        for (const Vec3d& corner : g)
            largest = std::max(largest, max_abs(corner));
        for (int k = 0; k < 12; ++k) {
            double& x = coordinate(tet, k);
            const double at = x;
            x = at + h;
            const double above = viscous_energy(tet);
            x = at - h;
            const double below = viscous_energy(tet);
            x = at;
            const Vec3d& corner = g[k / 3];
            const double exact = k % 3 == 0 ? corner.x : k % 3 == 1 ? corner.y : corner.z;
            EXPECT_NEAR((above - below) / (2 * h), exact, 1e-6 * largest);
        }
    }
}

TEST(Viscosity, DoesNotFeelARigidMotionHoweverFarItTurns) {
    std::mt19937 random(2);
    for (double angle : {0.01, 0.5, 2.5}) {
        ViscousTet tet = sample(random, 0.0);
        const Eigen::AngleAxisd turn(angle, Eigen::Vector3d(1, 2, -1).normalized());
        for (Vec3d& x : tet.x) {
            const Eigen::Vector3d to = turn * Eigen::Vector3d(x.x, x.y, x.z);
            x = {to.x() + 0.3, to.y() - 0.2, to.z() + 5.0};
        }
        EXPECT_LE(viscous_energy(tet), 1e-18 * tet.mu * tet.volume + 1e-20) << angle;
    }
}

TEST(Viscosity, OfSmallStrainsIsThatOfLinearElasticity) {
    // Stretched by s along x: mu s^2 + lambda / 2 s^2 per volume.
    std::mt19937 random(3);
    ViscousTet tet = sample(random, 0.0);
    const double s = 1e-5;
    for (Vec3d& x : tet.x)
        x.x *= 1.0 + s;
    const double expected = tet.volume * (tet.mu + 0.5 * tet.lambda) * s * s;
    EXPECT_NEAR(viscous_energy(tet), expected, 2e-5 * expected);
}

}  // namespace
}  // namespace noli::test
