// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Small scenes that a device is compared with the CPU on: every kind of pair, friction,
/// moving boundaries, an obstacle, all elastic models and integrators.

#include "noli/scene.hpp"

#include <cmath>
#include <string>
#include <vector>

namespace noli::test {

inline Body parity_body(const std::string& name, const std::string& generator, double y) {
    Body body;
    body.name = name;
    body.mesh.generator = generator;
    body.transform.rows[1][3] = y;
    body.friction = 0.3;
    return body;
}

/// A box that lands askew on another one, which stands on the ground.
inline Scene pile_of_boxes() {
    Scene scene;
    scene.name = "pile";
    scene.dt = 0.01;
    scene.damping.stiffness = 1e-3;
    const Body below = parity_body("below", "box", 0.501);
    Body above = parity_body("above", "box", 1.503);
    above.transform.rows = {{{0.8, 0, 0.6, 0.2}, {0, 1, 0, 1.503}, {-0.6, 0, 0.8, 0.1}}};
    above.velocity = {0.1, -1.0, 0};
    above.material.model = Material::Model::FixedCorotated;
    scene.bodies = {below, above};
    HalfSpace ground;
    ground.name = "ground";
    ground.friction = 0.3;
    scene.half_spaces = {ground};
    return scene;
}

/// A box on a box, their edges parallel: mollified pairs.
inline Scene tower_of_boxes() {
    Scene scene = pile_of_boxes();
    scene.name = "tower";
    scene.bodies[1].transform.rows = {{{1, 0, 0, 0.1}, {0, 1, 0, 1.502}, {0, 0, 1, 0.1}}};
    scene.bodies[1].velocity = {0, -0.1, 0};
    return scene;
}

/// The same, turned by no simple angle: edges are parallel up to rounding, and doubles do
/// not suffice.
inline Scene turned_tower() {
    Scene scene = tower_of_boxes();
    scene.name = "turned";
    const double c = std::cos(0.7);
    const double s = std::sin(0.7);
    for (Body& body : scene.bodies) {
        auto& rows = body.transform.rows;
        rows = {{{c, 0, s, rows[0][3]}, {0, 1, 0, rows[1][3]}, {-s, 0, c, rows[2][3]}}};
    }
    return scene;
}

/// A bar whose ends turn against each other.
inline Scene twisted_bar() {
    Scene scene;
    scene.name = "twist";
    scene.dt = 0.04;
    scene.gravity = {0, 0, 0};
    Body bar = parity_body("bar", "box", 0.0);
    bar.mesh.parameters = {{"size", {1, 0.2, 0.2}}, {"cells", {12, 3, 3}}};
    for (const double side : {0.0, 1.0}) {
        BoundaryCondition turn;
        turn.kind = BoundaryCondition::Kind::Velocity;
        turn.angular_deg = {side > 0 ? 120.0 : -120.0, 0, 0};
        turn.selection.kind = Selection::Kind::Box;
        turn.selection.box_min = {side - 0.01, -1, -1};
        turn.selection.box_max = {side + 0.01, 2, 2};
        bar.boundary.push_back(turn);
    }
    scene.bodies = {bar};
    return scene;
}

/// A ball under a lid that comes down and moves on.
inline Scene squeezed_ball() {
    Scene scene;
    scene.name = "squeeze";
    scene.dt = 0.02;
    scene.solver.integrator = Integrator::Bdf2;
    Body ball = parity_body("ball", "sphere", 0.52);
    ball.mesh.parameters = {{"edge_length", {0.2}}};
    ball.material.model = Material::Model::NeoHookean;
    Body lid = parity_body("lid", "plane_surface", 1.1);
    lid.mesh.parameters = {{"width", {2}}, {"depth", {2}}};
    BoundaryCondition press;
    press.kind = BoundaryCondition::Kind::Velocity;
    press.linear = {0.3, -0.5, 0};
    lid.boundary = {press};
    scene.bodies = {ball, lid};
    HalfSpace ground;
    ground.name = "ground";
    ground.friction = 0.3;
    scene.half_spaces = {ground};
    return scene;
}

/// A ball against the wall of a drum, at a spherical lid and on the ground.
inline Scene ball_in_a_drum() {
    Scene scene;
    scene.name = "drum";
    scene.dt = 0.01;
    Body ball = parity_body("ball", "sphere", 0.501);
    ball.mesh.parameters = {{"edge_length", {0.2}}};
    ball.velocity = {1.0, 0.2, 0.3};
    scene.bodies = {ball};
    HalfSpace ground;
    ground.name = "ground";
    ground.friction = 0.3;
    scene.half_spaces = {ground};
    Container drum;
    drum.name = "drum";
    drum.shape = Container::Shape::Cylinder;
    drum.center = {-0.2, 0, 0};
    drum.radius = 0.703;
    drum.friction = 0.4;
    Container lid;
    lid.name = "lid";
    lid.radius = 1.003;
    lid.friction = 0.2;
    scene.containers = {drum, lid};
    return scene;
}

/// A bar on rollers: one end is pulled along x, the other keeps its x, and gravity bends
/// it onto the ground.
inline Scene bar_on_rollers() {
    Scene scene = twisted_bar();
    scene.name = "rollers";
    scene.dt = 0.02;
    scene.gravity = {0, -9.81, 0};
    scene.solver.integrator = Integrator::Newmark;
    for (BoundaryCondition& end : scene.bodies[0].boundary) {
        end.angular_deg = {0, 0, 0};
        end.linear = {end.selection.box_min[0] > 0.5 ? 0.5 : 0.0, 0, 0};
        end.axes = 1;
    }
    scene.bodies[0].transform.rows[1][3] = 0.102;
    HalfSpace ground;
    ground.name = "ground";
    ground.friction = 0.3;
    scene.half_spaces = {ground};
    return scene;
}

inline constexpr int kNumParityScenes = 6;
inline std::vector<Scene> parity_scenes() {
    return {pile_of_boxes(),
            tower_of_boxes(),
            turned_tower(),
            twisted_bar(),
            squeezed_ball(),
            ball_in_a_drum(),
            bar_on_rollers()};
}

}  // namespace noli::test
