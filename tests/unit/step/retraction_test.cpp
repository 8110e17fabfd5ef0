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
    std::vector<double> weight = std::vector<double>(9, 1.0);
    std::vector<Vec3d> x_tilde;
    std::vector<int> body{0, 0, 0, 0, 1, 1, 1, 1, 1};
    std::vector<std::uint8_t> touched{1, 1};
    double share = 1.0;

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
        const RetractionInput in{{{model.mass.data(), 9},
                                  {weight.data(), 9},
                                  {fixed.data(), 9},
                                  {x_tilde.empty() ? x.data() : x_tilde.data(), 9},
                                  {x.data(), 9},
                                  0.0},
                                 {fixed.data(), 9},
                                 {body.data(), 9},
                                 {touched.data(), 2}};
        retraction.correct(exec, in, {x.data(), 9}, share, {p.data(), 9});
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
        if (before > 0.0) {
            EXPECT_NEAR(before / change, 100.0, 5.0);
        }
        before = change;
    }
}

/// A direction that turns the first piece by `turn` about its first vertex and moves it
/// by `shift`.
std::vector<Vec3d> turned_about_first(TwoPieces& pieces,
                                      const Vec3d& turn,
                                      const Vec3d& shift) {
    std::vector<Vec3d> p(9, {0.0, 0.0, 0.0});
    for (std::size_t v = 0; v < 4; ++v)
        p[v] = shift + cross(turn, pieces.x[v] - pieces.x[0]);
    return p;
}

double largest_stretch(const TwoPieces& pieces, const std::vector<Vec3d>& p) {
    double largest = 0.0;
    for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t b = 0; b < a; ++b)
            largest = std::max(largest,
                               std::fabs(norm(pieces.x[a] + p[a] - pieces.x[b] - p[b])
                                         - norm(pieces.x[a] - pieces.x[b])));
    return largest;
}

TEST(Retraction, TurnsAPieceAboutTheVertexThatIsHeld) {
    TwoPieces pieces;
    pieces.fixed[0] = 1;
    const Vec3d shift{0.2, 0.1, -0.3};
    const auto p = turned_about_first(pieces, {0.3, -0.5, 0.2}, shift);
    EXPECT_GT(largest_stretch(pieces, p), 1e-2);
    const auto out = pieces.corrected(p);
    EXPECT_LT(largest_stretch(pieces, out), 1e-13);
    EXPECT_EQ(norm(out[0] - shift), 0.0);
}

TEST(Retraction, TurnsAPieceAboutTheEdgeThatIsHeldAndNoOtherWay) {
    TwoPieces pieces;
    pieces.fixed[0] = pieces.fixed[1] = 1;
    Vec3d axis = pieces.x[1] - pieces.x[0];
    axis = (1.0 / norm(axis)) * axis;
    const auto out = pieces.corrected(turned_about_first(pieces, 0.6 * axis, {0, 0, 0}));
    EXPECT_LT(largest_stretch(pieces, out), 1e-13);
    // A direction that would move the edge is bent about the edge alone.
    std::vector<Vec3d> p = turned_about_first(pieces, {0.3, -0.5, 0.2}, {0, 0, 0});
    p[0] = p[1] = {0, 0, 0};
    const auto bent = pieces.corrected(p);
    EXPECT_EQ(norm(bent[0]) + norm(bent[1]), 0.0);
}

TEST(Retraction, LeavesAPieceAloneThatCannotTurn) {
    TwoPieces pieces;
    pieces.fixed[0] = pieces.fixed[1] = pieces.fixed[2] = 1;
    const auto p = turned_about_first(pieces, {0.3, -0.5, 0.2}, {0, 0, 0});
    const auto out = pieces.corrected(p);
    for (std::size_t v = 0; v < 4; ++v)
        EXPECT_EQ(norm(out[v] - p[v]), 0.0);
    // A hinge that turns itself is none.
    pieces.fixed[2] = 0;
    const auto turning = pieces.corrected(p);
    for (std::size_t v = 0; v < 4; ++v)
        EXPECT_EQ(norm(turning[v] - p[v]), 0.0);
}

TEST(Retraction, LeavesTurnsAloneThatStretchByLessThanRounding) {
    TwoPieces pieces;
    const auto p = turned_about_first(pieces, {3e-6, -5e-6, 2e-6}, {0.1, 0, 0});
    const auto out = pieces.corrected(p);
    for (std::size_t v = 0; v < 4; ++v)
        EXPECT_EQ(norm(out[v] - p[v]), 0.0);
}

/// Places of the first piece turned about `center` by `turn` (exactly) and shifted.
std::vector<Vec3d> moved(const TwoPieces& pieces,
                         const Vec3d& center,
                         const Vec3d& turn,
                         const Vec3d& shift) {
    const Eigen::AngleAxisd rotation(
        norm(turn), Eigen::Vector3d(turn.x, turn.y, turn.z).normalized());
    std::vector<Vec3d> out = pieces.x;
    for (std::size_t v = 0; v < 4; ++v) {
        const Vec3d r = pieces.x[v] - center;
        const Eigen::Vector3d to = rotation * Eigen::Vector3d(r.x, r.y, r.z);
        out[v] = center + shift + Vec3d{to.x(), to.y(), to.z()};
    }
    return out;
}

double distance_to(const TwoPieces& pieces, const std::vector<Vec3d>& to) {
    double largest = 0.0;
    for (std::size_t v = 0; v < 4; ++v)
        largest = std::max(largest, norm(pieces.x[v] - to[v]));
    return largest;
}

TEST(Retraction, MovesAPieceThatNothingTouchesToWhereInertiaWantsIt) {
    TwoPieces pieces;
    pieces.touched = {0, 1};
    pieces.x_tilde =
        moved(pieces, pieces.center(0), {0.15, -0.25, 0.1}, {0.1, 0.2, -0.3});
    const std::vector<Vec3d> goal = pieces.x_tilde;
    const std::vector<Vec3d> none(9, {0.0, 0.0, 0.0});
    double before = distance_to(pieces, goal);
    for (int k = 0; k < 5; ++k) {
        const auto p = pieces.corrected(none);
        EXPECT_LT(largest_stretch(pieces, p), 1e-13);
        for (std::size_t v = 4; v < 8; ++v)
            EXPECT_EQ(norm(p[v]), 0.0);  // contacts act on the other one
        for (std::size_t v = 0; v < 4; ++v)
            pieces.x[v] += p[v];
        const double now = distance_to(pieces, goal);
        EXPECT_LT(now, std::max(before * before, 1e-9)) << k;  // as Newton's method does
        before = now;
    }
    EXPECT_LT(before, 1e-9);
}

TEST(Retraction, DoesNotOvershootWhereAPullStiffensTheTurn) {
    // One vertex is wanted a hundred sizes away: a pendulum in strong gravity, for which
    // inertia alone would turn a hundred times too far.
    TwoPieces pieces;
    pieces.touched = {0, 1};
    pieces.x_tilde = pieces.x;
    const Vec3d arm = pieces.x[1] - pieces.center(0);
    pieces.x_tilde[1] += 100.0 * arm + Vec3d{0.5, -0.2, 0.3};
    const std::vector<Vec3d> none(9, {0.0, 0.0, 0.0});
    for (int k = 0; k < 8; ++k) {
        const auto p = pieces.corrected(none);
        for (std::size_t v = 0; v < 4; ++v)
            pieces.x[v] += p[v];
    }
    const auto last = pieces.corrected(none);
    for (std::size_t v = 0; v < 4; ++v)
        EXPECT_LT(norm(last[v]), 1e-4);
}

}  // namespace
}  // namespace noli
