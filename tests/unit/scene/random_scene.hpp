// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "noli/scene.hpp"

#include "mesh/source.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace noli::test {

/// Valid scenes that use every field; `tet.mesh` and `triangle.obj` must lie in the base
/// folder.
class RandomScene {
  public:
    explicit RandomScene(unsigned seed) : random_(seed) {}

    Scene make() {
        Scene s;
        s.name = flip() ? "a \"quoted\" name, \u00e4" : "";
        s.description = flip() ? "line one\nline two\t\\" : "";
        s.duration = positive();
        s.dt = s.duration / between(1, 1000);
        s.gravity = flip() ? vector() : s.gravity;
        s.length_scale = flip() ? positive() : 0.0;
        const int num_bodies = between(1, 4);
        for (int i = 0; i < num_bodies; ++i)
            s.bodies.push_back(body(i));
        for (int i = between(0, 2); i > 0; --i)
            s.half_spaces.push_back({"wall" + std::to_string(i),
                                     vector(),
                                     vector(),
                                     flip() ? positive() : 0.0});
        for (int i = between(0, 2); i > 0; --i)
            s.containers.push_back(container(i));
        fill_contact(s);
        fill_solver(s);
        return s;
    }

  private:
    bool flip() { return random_() % 2 == 0; }
    int between(int low, int high) {
        return std::uniform_int_distribution<int>(low, high)(random_);
    }
    double number() {
        if (random_() % 8 == 0) return flip() ? 0.0 : -0.0;
        const double magnitude = std::uniform_real_distribution<double>(-12, 12)(random_);
        return (flip() ? 1 : -1) * std::exp(magnitude);
    }
    double positive() { return std::abs(number()) + 1e-9; }
    Vector3 vector() { return {number(), number(), number() + 0.5}; }
    template <class E>
    E pick(int count) {
        return static_cast<E>(between(0, count - 1));
    }

    Container container(int i) {
        Container c;
        c.name = "drum" + std::to_string(i);
        c.shape = pick<Container::Shape>(2);
        c.center = vector();
        c.radius = positive();
        if (c.shape == Container::Shape::Cylinder) c.axis = vector();
        c.friction = flip() ? positive() : 0.0;
        return c;
    }

    Affine affine() {
        Affine a;
        if (flip()) return a;
        for (auto& row : a.rows)
            for (double& entry : row)
                entry = number();
        const int kind = between(0, 2);
        for (std::size_t i = 0; i < 3 && kind < 2; ++i)  // scale and shift only
            for (std::size_t j = 0; j < 3; ++j)
                a.rows[i][j] = i == j ? (kind == 0 ? 2.5 : positive()) : 0.0;
        return a;
    }

    MeshSource mesh() {
        MeshSource m;
        if (flip()) {
            m.file = flip() ? "tet.mesh" : "triangle.obj";
            m.fix_orientation = flip();
            return m;
        }
        const auto& table = generator_table();
        const GeneratorEntry& entry = table[static_cast<std::size_t>(
            between(0, static_cast<int>(table.size()) - 1))];
        m.generator = entry.name;
        for (const GeneratorParameter& p : entry.parameters)
            if (flip()) m.parameters.emplace_back(p.name, p.fallback);
        std::shuffle(m.parameters.begin(), m.parameters.end(), random_);
        return m;
    }

    Selection selection() {
        Selection s;
        s.kind = pick<Selection::Kind>(3);
        if (s.kind == Selection::Kind::Vertices)
            for (int i = between(1, 200); i > 0; --i)
                s.vertices.push_back(between(0, 100000));
        if (s.kind != Selection::Kind::Box) return s;
        s.frame = pick<Selection::Frame>(2);
        s.surface_only = flip();
        s.box_min = vector();
        for (std::size_t k = 0; k < 3; ++k)
            s.box_max[k] = s.box_min[k] + positive();
        return s;
    }

    BoundaryCondition condition() {
        using Kind = BoundaryCondition::Kind;
        BoundaryCondition c;
        c.kind = pick<Kind>(6);
        c.selection = selection();
        const bool load = c.kind == Kind::Force || c.kind == Kind::Acceleration;
        if (c.kind == Kind::Velocity || load) c.linear = vector();
        if (c.kind == Kind::Velocity) c.angular_deg = vector();
        if ((c.kind == Kind::Velocity || c.kind == Kind::Path) && flip())
            c.center = vector();
        if (c.kind == Kind::Path)
            for (int i = 0, n = between(1, 4); i < n; ++i)
                c.path.push_back({i + 0.1 * i * i, vector(), vector()});
        if (c.kind == Kind::Sequence)
            c.sequence = {"tet.mesh", "triangle.obj", "tet.mesh"};
        if (!load && flip()) c.axes = between(1, 7);
        if (flip()) c.t_begin = positive();
        if (flip()) c.t_end = c.t_begin + 1 + positive();
        if (flip())
            c.until = BoundaryCondition::Until{pick<BoundaryCondition::Until::Subject>(2),
                                               between(0, 2),
                                               flip(),
                                               number(),
                                               flip()};
        return c;
    }

    Body body(int index) {
        Body b;
        b.name = flip() ? "body" + std::to_string(index)
                        : (flip() ? "thing " + std::to_string(index) : "");
        b.mesh = mesh();
        b.transform = affine();
        if (flip()) {
            b.material.model = pick<Material::Model>(3);
            b.material.gipc_lame =
                b.material.model == Material::Model::StableNeoHookean && flip();
            b.material.density = flip() ? positive() : 1000.0;
            b.material.young = positive();
            b.material.poisson =
                std::uniform_real_distribution<double>(-0.99, 0.4999)(random_);
        }
        b.velocity = flip() ? vector() : Vector3{};
        b.angular_velocity_deg = flip() ? vector() : Vector3{};
        b.friction = flip() ? positive() : 0.0;
        for (int i = between(0, 3); i > 0; --i)
            b.boundary.push_back(condition());
        if (flip()) {
            b.grid = {between(1, 3), 1, between(1, 3)};
            b.grid_spacing = {positive(), 0, positive()};
        }
        return b;
    }

    void fill_contact(Scene& s) {
        ContactSettings& c = s.contact;
        if (flip()) return;
        c.enabled = flip();
        c.self_contact = flip();
        c.dhat = positive();
        c.dhat_absolute = flip();
        c.strengthen = flip();
        if (flip()) {
            c.model = ContactFormulation::Ipc;
        } else {
            c.barrier_exponent = between(1, 2);
            c.hessian = pick<ContactModel>(4);
            c.mollifier = pick<MollifierModel>(3);
        }
        c.kappa = flip() ? positive() : 0.0;
        c.kappa_min_multiplier = positive();
        c.epsv = positive();
        c.epsv_absolute = flip();
        c.friction_iterations = between(kFrictionAsNeeded, 4);
        c.friction_tolerance = positive();
        c.friction_hessian = pick<FrictionHessian>(2);
        c.min_separation = positive();
        c.pairs.push_back({"*", "*", 0.25, std::nullopt});
        if (!s.half_spaces.empty())
            c.pairs.push_back({"*", s.half_spaces[0].name, std::nullopt, flip()});
        if (!s.containers.empty())
            c.pairs.push_back({s.containers[0].name, "*", 0.75, std::nullopt});
        const Body& b = s.bodies[0];
        if (!b.name.empty())
            c.pairs.push_back({b.name, b.name + "[0,0,0]", positive(), flip()});
    }

    void fill_solver(Scene& s) {
        if (flip()) s.damping = {positive(), positive()};
        SolverSettings& o = s.solver;
        o.integrator = pick<Integrator>(3);
        if (o.integrator == Integrator::Newmark) {
            o.newmark_beta = 0.3;
            o.newmark_gamma = 0.6;
        }
        o.tolerance = positive();
        o.tolerance_absolute = flip();
        if (flip()) o.gap_tolerance = positive();
        o.projection = pick<HessianProjection>(2);
        o.start = pick<NewtonStart>(2);
        if (flip()) o.gradient_tolerance = positive();
        for (int i = between(0, 30); i > 0; --i)
            o.tolerance_per_step.push_back(positive());
        o.max_newton = between(1, 100000);
        o.linear = pick<LinearSolver>(2);
        o.contact_product = pick<ContactProduct>(2);
        o.pcg_tolerance = 1e-6;
        o.max_pcg = between(1, 100000);
        s.output.every = between(0, 5);
        if (flip()) s.output.formats = {"ply", "vtu"};
        s.output.checkpoint_steps = between(0, 9);
        s.output.hash_every = between(0, 3);
        s.output.checkpoint_seconds = positive();
    }

    std::mt19937 random_;
};

}  // namespace noli::test
