// SPDX-License-Identifier: Apache-2.0
/// Rotations in a Newton direction are carried out as rotations.
#include "step/retraction.hpp"

#include "exec/cpu.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <random>

namespace noli {
namespace {

/// Two tetrahedra apart from each other, and a vertex of none.
struct TwoPieces {
    CpuExec exec;
    Model model;
    std::vector<Vec3d> x;
    std::vector<std::uint8_t> fixed;

    TwoPieces() {
        std::mt19937 random(1);
        std::uniform_real_distribution<double> one(-1.0, 1.0);
        model.num_vertices = 9;
        model.tets = {{{0, 1, 2, 3}}, {{4, 5, 6, 7}}};
        for (int v = 0; v < 9; ++v) {
            x.push_back({one(random) + (v < 4 ? 0.0 : 50.0), one(random), one(random)});
            model.mass.push_back(v < 8 ? 1.0 + 0.5 * one(random) : 0.0);
        }
        model.x0 = x;
        fixed.assign(9, 0);
        fixed[8] = 1;
    }

    std::vector<Vec3d> corrected(std::vector<Vec3d> p) {
        Retraction<CpuExec> retraction(exec, model);
        retraction.correct(exec,
                           {model.mass.data(), 9},
                           {fixed.data(), 9},
                           {x.data(), 9},
                           {p.data(), 9});
        return p;
    }

    Vec3d center(int first) const {
        Vec3d sum{0, 0, 0};
        double mass = 0.0;
        for (int v = first; v < first + 4; ++v) {
            sum +=
                model.mass[static_cast<std::size_t>(v)] * x[static_cast<std::size_t>(v)];
            mass += model.mass[static_cast<std::size_t>(v)];
        }
        return (1.0 / mass) * sum;
    }
};

TEST(Retraction, CarriesOutATurnWithoutStretchingThePiece) {
    TwoPieces pieces;
    const Vec3d turn{0.3, -0.5, 0.2};
    std::vector<Vec3d> p(9, {0.0, 0.0, 0.0});
    for (std::size_t v = 0; v < 4; ++v)
        p[v] = Vec3d{1.0, 2.0, 3.0} + cross(turn, pieces.x[v] - pieces.center(0));
    const std::vector<Vec3d> out = pieces.corrected(p);
    for (std::size_t a = 0; a < 4; ++a) {
        for (std::size_t b = 0; b < a; ++b)
            EXPECT_NEAR(norm(pieces.x[a] + out[a] - pieces.x[b] - out[b]),
                        norm(pieces.x[a] - pieces.x[b]),
                        1e-13);
        const Vec3d r = pieces.x[a] - pieces.center(0);
        const Eigen::AngleAxisd rotation(
            norm(turn), Eigen::Vector3d(turn.x, turn.y, turn.z).normalized());
        const Eigen::Vector3d to = rotation * Eigen::Vector3d(r.x, r.y, r.z);
        EXPECT_NEAR(norm(r + out[a] - Vec3d{to.x() + 1.0, to.y() + 2.0, to.z() + 3.0}),
                    0.0,
                    1e-12);
    }
    for (std::size_t v = 4; v < 9; ++v)
        EXPECT_EQ(norm(out[v]), 0.0) << v;
}

TEST(Retraction, ChangesADirectionToSecondOrderAndNotItsMomentum) {
    TwoPieces pieces;
    std::mt19937 random(2);
    std::uniform_real_distribution<double> one(-1.0, 1.0);
    std::vector<Vec3d> p(9, {0.0, 0.0, 0.0});
    for (std::size_t v = 0; v < 8; ++v)
        p[v] = {one(random), one(random), one(random)};
    double before = 0.0;
    for (const double size : {1e-2, 1e-3}) {
        std::vector<Vec3d> small = p;
        for (Vec3d& q : small)
            q = size * q;
        const std::vector<Vec3d> out = pieces.corrected(small);
        double change = 0.0;
        Vec3d momentum{0, 0, 0};
        for (std::size_t v = 0; v < 4; ++v) {
            change = std::max(change, norm(out[v] - small[v]));
            momentum += pieces.model.mass[v] * (out[v] - small[v]);
        }
        EXPECT_LE(norm(momentum), 1e-14 * size);
        if (before > 0.0) EXPECT_NEAR(before / change, 100.0, 5.0);
        before = change;
    }
}

TEST(Retraction, LeavesPiecesWithPrescribedVerticesAlone) {
    TwoPieces pieces;
    pieces.fixed[2] = 1;
    std::vector<Vec3d> p(9, {0.0, 0.0, 0.0});
    for (std::size_t v = 0; v < 8; ++v)
        p[v] = cross(Vec3d{0.3, 0.0, 0.2}, pieces.x[v]);
    const std::vector<Vec3d> out = pieces.corrected(p);
    for (std::size_t v = 0; v < 4; ++v)
        EXPECT_EQ(norm(out[v] - p[v]), 0.0);
    EXPECT_GT(norm(out[5] - p[5]), 1e-3);
}

}  // namespace
}  // namespace noli
