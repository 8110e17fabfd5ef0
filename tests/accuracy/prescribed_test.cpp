// SPDX-License-Identifier: Apache-2.0
/// Prescribed motion is exact: vertices are where they were told to be.

#include "check.hpp"

namespace noli::accuracy {
namespace {

constexpr int kStepsHere = 10;

/// Worst distance of some vertices from where `map` takes their start.
double worst_distance(Lab& lab,
                      const std::vector<Vector3>& x0,
                      const std::vector<std::size_t>& of,
                      const std::function<Vector3(const Vector3&)>& map) {
    const std::vector<Vector3> x = lab.simulator().positions();
    double worst = 0.0;
    for (const std::size_t v : of) {
        const Vector3 wanted = map(x0[v]);
        Vector3 off{};
        for (std::size_t k = 0; k < 3; ++k)
            off[k] = x[v][k] - wanted[k];
        worst = std::max(worst, norm(off));
    }
    return worst;
}

/// All of a body, by the condition given.
void drive(Lab& lab,
           Body body,
           const BoundaryCondition& how,
           const std::function<Vector3(const Vector3&)>& map) {
    body.boundary = {how};
    Scene scene = lab.scene();
    scene.bodies = {body};
    if (!lab.start(scene)) return;
    const std::vector<Vector3> x0 = lab.simulator().positions();
    if (!lab.run(kStepsHere)) return;
    lab.expect("worst vertex",
               0.0,
               worst_distance(lab, x0, lab.vertices(0), map),
               0.01 * lab.size());
}

Vector3 velocity_of(const Lab& lab) {
    const double v = 0.05 * lab.size() / lab.at.dt;
    return {v, -2 * v, 0.5 * v};
}

Vector3 shifted(const Lab& lab, const Vector3& x, double steps) {
    Vector3 out = x;
    for (std::size_t k = 0; k < 3; ++k)
        out[k] += steps * lab.at.dt * velocity_of(lab)[k];
    return out;
}

TEST(Prescribed, AllVertices) {
    check({"all vertices prescribed",
           "x = x0 + v t",
           "none",
           {},
           Cover::Pairs,
           [](Lab& lab) {
               drive(lab,
                     lab.block("block", {}),
                     condition(BoundaryCondition::Kind::Velocity, velocity_of(lab)),
                     [&](const Vector3& x) { return shifted(lab, x, kStepsHere); });
           }});
}

TEST(Prescribed, ObstaclesOnly) {
    Domain domain;
    domain.presets = {"rubber"};
    domain.meshes = {0, 1};
    check({"only an obstacle, moved",
           "x = x0 + v t",
           "none",
           domain,
           Cover::Pairs,
           [](Lab& lab) {
               const double edge = lab.at.mesh == 0 ? 0.5 : 0.2;
               Body ball = lab.body("ball",
                                    "sphere_surface",
                                    {{"radius", {0.5 * lab.size()}},
                                     {"edge_length", {edge * lab.size()}}});
               drive(lab,
                     ball,
                     condition(BoundaryCondition::Kind::Velocity, velocity_of(lab)),
                     [&](const Vector3& x) { return shifted(lab, x, kStepsHere); });
           }});
}

TEST(Prescribed, OneFace) {
    check({"one face prescribed, the rest follows",
           "x = x0 + v t on the face",
           "none",
           {},
           Cover::Pairs,
           [](Lab& lab) {
               Scene scene = lab.scene();
               Body block = lab.block("block", {});
               auto pull = condition(BoundaryCondition::Kind::Velocity, velocity_of(lab));
               pull.selection = part({0, 0, 0}, {0, 1, 1});
               block.boundary = {pull};
               scene.bodies = {block};
               if (!lab.start(scene)) return;
               const std::vector<Vector3> x0 = lab.simulator().positions();
               std::vector<std::size_t> face;
               for (std::size_t v = 0; v < x0.size(); ++v)
                   if (x0[v][0] < -0.499 * lab.size()) face.push_back(v);
               if (!lab.run(kStepsHere)) return;
               lab.expect("worst vertex",
                          0.0,
                          worst_distance(lab,
                                         x0,
                                         face,
                                         [&](const Vector3& x) {
                                             return shifted(lab, x, kStepsHere);
                                         }),
                          0.01 * lab.size());
           }});
}

TEST(Prescribed, Turn) {
    // 3 degrees a step about z and the centre.
    check({"a body turned as told",
           "x = R(w t) x0",
           "none",
           {},
           Cover::Pairs,
           [](Lab& lab) {
               auto turn = condition(BoundaryCondition::Kind::Velocity);
               turn.angular_deg = {0, 0, 3 / lab.at.dt};
               const double angle = 3 * kStepsHere * 0.017453292519943295;
               drive(lab, lab.block("block", {}), turn, [=](const Vector3& x) {
                   return Vector3{std::cos(angle) * x[0] - std::sin(angle) * x[1],
                                  std::sin(angle) * x[0] + std::cos(angle) * x[1],
                                  x[2]};
               });
           }});
}

TEST(Prescribed, Path) {
    // Linear between key frames at steps 0, 5 and 20, so half of the first leg and a
    // third of the second one at step 10.
    check({"a path with key frames",
           "linear between key frames",
           "none",
           {},
           Cover::Pairs,
           [](Lab& lab) {
               const double L = lab.size();
               BoundaryCondition path = condition(BoundaryCondition::Kind::Path);
               path.path = {{},
                            {5 * lab.at.dt, {0, 0.3 * L, 0}, {}},
                            {20 * lab.at.dt, {0.6 * L, 0.3 * L, 0}, {}}};
               drive(lab, lab.block("block", {}), path, [=](const Vector3& x) {
                   return Vector3{x[0] + 0.2 * L, x[1] + 0.3 * L, x[2]};
               });
           }});
}

TEST(Prescribed, UntilAPlaneThenFalls) {
    // Raised by 0.05 sizes a step until its underside is at or above 0.19 sizes from its
    // start, at the end of step 4; from the fifth step on it flies as thrown.
    Domain domain;
    domain.integrators = {Integrator::ImplicitEuler};
    check({"raised until a plane, then released",
           "v = v0 + g (t - t0)",
           "none",
           domain,
           Cover::Pairs,
           [](Lab& lab) {
               const double L = lab.size();
               const double v = 0.05 * L / lab.at.dt;
               auto raise = condition(BoundaryCondition::Kind::Velocity, {0, v, 0});
               raise.until = BoundaryCondition::Until{};
               raise.until->axis = 1;
               raise.until->value = -0.5 * L + 0.19 * L;
               Body block = lab.block("block", {});
               block.boundary = {raise};
               Scene scene = lab.scene();
               scene.bodies = {block};
               if (!lab.start(scene) || !lab.run(kStepsHere)) return;
               const double fallen = (kStepsHere - 4) * kGravity * lab.at.dt;
               lab.expect("velocity", v - fallen, lab.motion().v[1], v + fallen);
           }});
}

}  // namespace
}  // namespace noli::accuracy
