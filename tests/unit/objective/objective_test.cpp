// SPDX-License-Identifier: Apache-2.0
/// The incremental potential as a whole, with every term at work: its gradient against
/// differences of the energy, its Hessian against differences of the gradient.

#include "objective/objective.hpp"

#include "exec/cpu.hpp"
#include "model/model.hpp"
#include "step/collision.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

namespace noli {
namespace {

using Exec = SerialExec;

double dot_of(View<const Vec3d> a, View<const Vec3d> b) {
    double sum = 0.0;
    for (int i = 0; i < a.size; ++i)
        sum += dot(a[i], b[i]);
    return sum;
}

Body box(const std::string& name, double y, double turn_deg) {
    Body body;
    body.name = name;
    body.mesh.generator = "box";
    body.mesh.parameters = {{"size", {1, 1, 1}}, {"cells", {2, 2, 2}}};
    const double c = std::cos(turn_deg * 3.14159265358979 / 180.0);
    const double s = std::sin(turn_deg * 3.14159265358979 / 180.0);
    body.transform.rows = {{{c, 0, s, 0.1}, {0, 1, 0, y}, {-s, 0, c, 0.05}}};
    body.material.young = 1e4;
    return body;
}

/// Two boxes on each other and on the ground, inside dhat of each other, rattled.
struct Stack {
    Exec exec;
    Scene scene;
    Model model;
    BlockPattern pattern;
    std::unique_ptr<Objective<Exec>> objective;
    Collision<Exec> collision;
    PairSet<Exec> pairs;
    ContactLaw law;
    std::vector<Vec3d> x, x_start;
    std::vector<double> weight;  ///< of inertia
    std::vector<std::uint8_t> fixed;
    std::mt19937 random{7};

    explicit Stack(ContactHessian hessian) {
        scene.bodies = {box("lower", 0.51, 0.0), box("upper", 1.52, 20.0)};
        scene.bodies[0].friction = 0.3;
        scene.half_spaces = {HalfSpace{"ground", {0, 0, 0}, {0, 1, 0}, 0.4}};
        scene.contact.dhat = 0.05;
        scene.contact.dhat_absolute = true;
        Result<Model> built = build_model(scene);
        EXPECT_TRUE(built);
        model = built.value();
        pattern = build_block_pattern(model.num_vertices, model.tets);
        objective = std::make_unique<Objective<Exec>>(exec, model, pattern);
        law = {.barrier = {.dhat = model.dhat, .kappa = 1e5, .exponent = 2},
               .hessian = hessian,
               .mollified = MollifiedHessian::Exact};
        x_start = rattled(model.x0, 1e-3);
        x = rattled(x_start, 1e-3);
        fixed.assign(model.x0.size(), 0);
        fixed[3] = 1;
        begin();
    }

    std::vector<Vec3d> rattled(const std::vector<Vec3d>& from, double size) {
        std::uniform_real_distribution<double> by(-size, size);
        std::vector<Vec3d> out = from;
        for (Vec3d& p : out)
            p += Vec3d{by(random), by(random), by(random)};
        return out;
    }

    static View<const Vec3d> view(const std::vector<Vec3d>& a) {
        return {a.data(), static_cast<int>(a.size())};
    }

    void begin() {
        const StepScales scales{.h_sq = 1e-4,
                                .mass_damping = 1e-3,
                                .stiffness_damping = 0.02,
                                .friction_eps = 1e-3};
        weight.assign(x_start.size(), 2.25);
        objective->begin_step(exec,
                              scales,
                              view(x_start),
                              view(rattled(x_start, 1e-2)),
                              {weight.data(), model.num_vertices},
                              {fixed.data(), model.num_vertices});
        collision.begin_step(exec, model, model.obstacle);
        collision.find_candidates_along(exec, view(x_start), {}, 0.0, 2.0 * model.dhat);
        collision.find_pairs_at(exec, view(x_start), model.dhat, pairs);
        objective->lag_friction_at(exec, pairs, view(x_start), law);
    }

    double energy(const std::vector<Vec3d>& at) {
        collision.find_pairs_at(exec, view(at), model.dhat, pairs);
        return objective->energy(exec, view(at), pairs, law);
    }
    std::vector<Vec3d> gradient(const std::vector<Vec3d>& at) {
        collision.find_pairs_at(exec, view(at), model.dhat, pairs);
        objective->assemble(exec, view(at), pairs, law);
        return {objective->gradient().begin(), objective->gradient().end()};
    }
    std::vector<Vec3d> along(const std::vector<Vec3d>& p, double t) const {
        std::vector<Vec3d> out = x;
        for (std::size_t i = 0; i < x.size(); ++i)
            out[i] += t * p[i];
        return out;
    }
    /// A direction in which the prescribed vertex rests.
    std::vector<Vec3d> direction() {
        std::vector<Vec3d> p = rattled(std::vector<Vec3d>(x.size()), 1.0);
        p[3] = {0, 0, 0};
        return p;
    }
};

TEST(Objective, EveryKindOfTermIsAtWork) {
    Stack s(ContactHessian::Exact);
    s.energy(s.x);
    EXPECT_GT(s.pairs.pt.size(), 0);
    EXPECT_GT(s.pairs.ee.size() + s.pairs.mollified.size(), 0);
    EXPECT_GT(s.pairs.walls.size(), 0);
    EXPECT_GT(s.objective->num_friction_terms(), s.pairs.walls.size());
}

TEST(Objective, GradientIsTheSlopeOfTheEnergy) {
    Stack s(ContactHessian::GaussNewtonPlus);
    const std::vector<Vec3d> g = s.gradient(s.x);
    for (int k = 0; k < 10; ++k) {
        const std::vector<Vec3d> p = s.direction();
        const double h = 1e-6;
        const double slope =
            (8.0 * (s.energy(s.along(p, h)) - s.energy(s.along(p, -h)))
             - (s.energy(s.along(p, 2 * h)) - s.energy(s.along(p, -2 * h))))
            / (12.0 * h);
        const double expected = dot_of(Stack::view(g), Stack::view(p));
        EXPECT_NEAR(slope, expected, 1e-6 * std::fabs(expected) + 1e-9);
    }
}

TEST(Objective, ProjectedHessianIsAtLeastTheSlopeOfTheGradient) {
    // Projection term by term only raises p^T H p, and it is never negative.
    Stack s(ContactHessian::Exact);
    for (int k = 0; k < 10; ++k) {
        const std::vector<Vec3d> p = s.direction();
        const double h = 1e-6;
        const std::vector<Vec3d> plus = s.gradient(s.along(p, h));
        const std::vector<Vec3d> minus = s.gradient(s.along(p, -h));
        const double true_form = (dot_of(Stack::view(plus), Stack::view(p))
                                  - dot_of(Stack::view(minus), Stack::view(p)))
                               / (2.0 * h);
        s.gradient(s.x);
        std::vector<Vec3d> hp(p.size());
        const View<Vec3d> out{hp.data(), static_cast<int>(hp.size())};
        s.objective->matrix().multiply(s.exec, Stack::view(p), out);
        s.objective->terms().multiply_add(s.exec, Stack::view(p), out);
        const double form = dot_of(out, Stack::view(p));
        EXPECT_GT(form, 0.0);
        EXPECT_GE(form, true_form - 1e-6 * std::fabs(true_form));
    }
}

TEST(Objective, SplitGradientsAddUpToTheWhole) {
    Stack s(ContactHessian::GaussNewtonPlus);
    s.objective->begin_step(
        s.exec,
        {.h_sq = 1e-4, .stiffness_damping = 0.02, .friction_eps = 1e-3},
        Stack::view(s.x_start),
        Stack::view(s.x_start),
        {s.weight.data(), s.model.num_vertices},
        {s.fixed.data(), s.model.num_vertices});
    const std::vector<Vec3d> whole = s.gradient(s.x);  // no friction lagged
    std::vector<Vec3d> other(whole.size());
    std::vector<Vec3d> barrier(whole.size());
    s.objective->split_gradients(s.exec,
                                 Stack::view(s.x),
                                 s.pairs,
                                 s.law,
                                 {other.data(), s.model.num_vertices},
                                 {barrier.data(), s.model.num_vertices});
    double largest = 0.0;
    for (const Vec3d& g : barrier)
        largest = std::max(largest, s.law.barrier.kappa * max_abs(g));
    for (std::size_t i = 0; i < whole.size(); ++i)
        EXPECT_LT(max_abs(whole[i] - other[i] - s.law.barrier.kappa * barrier[i]),
                  1e-14 * largest);
}

TEST(Objective, ContactForcesOfAPairCancelAndThePlanesCarryTheRest) {
    Stack s(ContactHessian::GaussNewtonPlus);
    s.energy(s.x);
    std::vector<Vec3d> forces(s.x.size());
    s.objective->contact_forces(
        s.exec, Stack::view(s.x), s.pairs, s.law, {forces.data(), s.model.num_vertices});
    Vec3d sum{0, 0, 0};
    Vec3d upper{0, 0, 0};
    for (std::size_t i = 0; i < forces.size(); ++i) {
        sum += forces[i];
        if (s.model.body[i] == 1) upper += forces[i];
    }
    EXPECT_GT(sum.y, 0.0);    // only the ground pushes the whole stack
    EXPECT_GT(upper.y, 0.0);  // and the lower box the upper one
}

}  // namespace
}  // namespace noli
