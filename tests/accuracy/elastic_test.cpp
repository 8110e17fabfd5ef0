// SPDX-License-Identifier: Apache-2.0
/// Elastic bodies under load, where linear tetrahedra have the closed answer: states of
/// uniform stress are exact on any mesh. Bending is not (linear tetrahedra lock), so the
/// sag of a beam is compared with a tight run and its distance from beam theory is said.

#include "check.hpp"
#include "discrete.hpp"
#include "settle.hpp"

namespace noli::accuracy {
namespace {

/// Comes to rest: only the waves of a bar of that length must be damped.
Domain quiet(double length) {
    Domain domain;
    domain.integrators = {Integrator::ImplicitEuler, Integrator::Bdf2};
    domain.holds = [=](const Case& at) {
        const double wave = 1.5708 * sound_speed(preset(at.preset)) / (length * at.size);
        return wave * at.dt >= damps_from(at.integrator);
    };
    return domain;
}

double mean_y(Lab& lab, const std::vector<std::size_t>& of) {
    const std::vector<Vector3> x = lab.simulator().positions();
    double sum = 0.0;
    for (const std::size_t v : of)
        sum += x[v][1];
    return sum / static_cast<double>(of.size());
}

/// Vertices at a height of the start.
std::vector<std::size_t> level(Lab& lab, double y) {
    const std::vector<Vector3> x = lab.simulator().positions();
    std::vector<std::size_t> out;
    for (std::size_t v = 0; v < x.size(); ++v)
        if (std::abs(x[v][1] - y) < 1e-3 * lab.size()) out.push_back(v);
    return out;
}

TEST(Elastic, HangingBarStretches) {
    // u = rho g L^2 / (2 E) for Poisson's ratio 0 (else the clamp hinders the lateral
    // contraction). One-dimensional linear elements are exact at their nodes; across the
    // bar tetrahedra spread the load unevenly, which evens out over a width.
    Domain domain = quiet(1.0);
    domain.meshes = {0, 1};
    domain.holds = [holds = domain.holds](const Case& at) {
        const Material m = preset(at.preset);
        return holds(at) && m.density * kGravity * at.size <= 0.01 * m.young;
    };
    check(
        {"a hanging bar stretches, Poisson's ratio 0",
         "u = rho g L^2 / 2E",
         "large strain, rho g L/E at most 1 %",
         domain,
         Cover::Pairs,
         [](Lab& lab) {
             const double L = lab.size();
             const double n = lab.at.mesh == 0 ? 1 : 2;
             Scene scene = lab.scene();
             Body bar = lab.body(
                 "bar", "box", {{"size", {L / 8, L, L / 8}}, {"cells", {n, 8 * n, n}}});
             bar.material.poisson = 0.0;
             auto clamp = condition(BoundaryCondition::Kind::Fixed);
             clamp.selection = part({0, 1, 0}, {1, 1, 1});
             bar.boundary = {clamp};
             scene.bodies = {bar};
             if (!lab.start(scene)) return;
             const std::vector<std::size_t> tip = level(lab, -0.5 * L);
             if (!lab.run(60)) return;
             const double strain =
                 lab.material.density * kGravity * L / lab.material.young;
             lab.expect(
                 "extension", 0.5 * strain * L, -0.5 * L - mean_y(lab, tip), 0.0, strain);
         }});
}

TEST(Elastic, StretchedBarIsUniform) {
    // Both ends prescribed 5 % apart, Poisson's ratio 0: x = 1.05 x0 everywhere.
    Domain domain = quiet(0.5);
    domain.meshes = {0, 1};
    check({"a bar stretched at its ends, Poisson's ratio 0",
           "x = 1.05 x0",
           "none",
           domain,
           Cover::Pairs,
           [](Lab& lab) {
               const double L = lab.size();
               const double n = lab.at.mesh == 0 ? 1 : 2;
               Scene scene = lab.scene();
               scene.gravity = {0, 0, 0};
               Body bar = lab.body(
                   "bar", "box", {{"size", {L / 4, L, L / 4}}, {"cells", {n, 4 * n, n}}});
               bar.material.poisson = 0.0;
               for (const double end : {0.0, 1.0}) {
                   const double v = (end - 0.5) * 0.05 * L / (10 * lab.at.dt);
                   auto pull = condition(BoundaryCondition::Kind::Velocity, {0, v, 0});
                   pull.selection = part({0, end, 0}, {1, end, 1});
                   pull.t_end = 9.5 * lab.at.dt;
                   auto hold = condition(BoundaryCondition::Kind::Fixed);
                   hold.selection = pull.selection;
                   hold.t_begin = 9.5 * lab.at.dt;
                   bar.boundary.push_back(pull);
                   bar.boundary.push_back(hold);
               }
               scene.bodies = {bar};
               if (!lab.start(scene)) return;
               const std::vector<Vector3> x0 = lab.simulator().positions();
               if (!lab.run(60)) return;
               const std::vector<Vector3> x = lab.simulator().positions();
               double worst = 0.0;
               for (std::size_t v = 0; v < x.size(); ++v)
                   worst = std::max(worst, std::abs(x[v][1] - 1.05 * x0[v][1]));
               lab.expect("worst height", 0.0, worst, 0.025 * L);
           }});
}

TEST(Elastic, PatchTest) {
    // The outer vertices of a cube follow an affine map; at rest the inner ones do too.
    Domain domain = quiet(0.5);
    domain.meshes = {1};
    check({"patch test: outer vertices follow an affine map",
           "x = A x0 inside as well",
           "none",
           domain,
           Cover::Pairs,
           [](Lab& lab) {
               const double L = lab.size();
               Scene scene = lab.scene();
               scene.gravity = {0, 0, 0};
               scene.bodies = {lab.block("block", {})};
               if (!lab.start(scene)) return;
               const std::vector<Vector3> x0 = lab.simulator().positions();
               const auto shift = [](const Vector3& x) {
                   return Vector3{
                       0.04 * x[1] + 0.02 * x[0], 0.03 * x[2] - 0.02 * x[1], 0.01 * x[0]};
               };
               std::vector<std::size_t> inner;
               for (std::size_t v = 0; v < x0.size(); ++v) {
                   double out = 0.0;
                   for (const double c : x0[v])
                       out = std::max(out, std::abs(c));
                   if (out < 0.49 * L) {
                       inner.push_back(v);
                       continue;
                   }
                   BoundaryCondition path = condition(BoundaryCondition::Kind::Path);
                   path.selection.kind = Selection::Kind::Vertices;
                   path.selection.vertices = {static_cast<int>(v)};
                   path.path = {{}, {10 * lab.at.dt, shift(x0[v]), {}}};
                   scene.bodies[0].boundary.push_back(path);
               }
               if (!lab.start(scene) || !lab.run(60)) return;
               const std::vector<Vector3> x = lab.simulator().positions();
               double worst = 0.0;
               for (const std::size_t v : inner) {
                   const Vector3 by = shift(x0[v]);
                   for (std::size_t k = 0; k < 3; ++k)
                       worst = std::max(worst, std::abs(x[v][k] - x0[v][k] - by[k]));
               }
               lab.expect("worst inner vertex", 0.0, worst, 0.04 * L);
           }});
}

/// Nominal stress of the neo-Hookean law at an axial stretch, free to contract: lateral
/// stretch a from mu (a - 1/a) + lambda ln(s a^2) / a = 0 (docs/theory/neo_hookean.md).
double uniaxial_stress(const Material& m, double stretch) {
    const double mu = m.young / (2 * (1 + m.poisson));
    const double lambda = m.young * m.poisson / ((1 + m.poisson) * (1 - 2 * m.poisson));
    const double a = root_of_rising(
        [&](double side) {
            return mu * (side * side - 1) + lambda * std::log(stretch * side * side);
        },
        0.5,
        2.0);
    return mu * (stretch - 1 / stretch) + lambda * std::log(stretch * a * a) / stretch;
}

/// Mean height of some vertices by the contact forces on them: force times this is the
/// work that contact has done, so uneven gaps count in second order only.
double height_by_force(Lab& lab, const std::vector<std::size_t>& of) {
    const Fields fields = lab.simulator().fields();
    const std::vector<Vector3> x = lab.simulator().positions();
    double sum = 0.0;
    double weight = 0.0;
    for (const std::size_t v : of) {
        sum += fields.contact_force[v][1] * x[v][1];
        weight += fields.contact_force[v][1];
    }
    return sum / weight;
}

TEST(Elastic, BlockUnderAPlate) {
    // A plate presses a block by about 4 % without friction; the block may spread. Both
    // sides carry the stress of the strain that it has.
    Domain domain = settling(1.0);
    domain.meshes = {0, 1};
    check({"a block pressed by a plate",
           "F = A P(strain) of uniaxial neo-Hooke",
           "uneven gaps, up to a few hundredths of the strain, in second order",
           domain,
           Cover::Pairs,
           [](Lab& lab) {
               const double L = lab.size();
               Scene scene = lab.scene();
               scene.gravity = {0, 0, 0};
               scene.half_spaces = {plane(0.0)};
               Body plate = lab.body(
                   "plate", "plane_surface", {{"width", {3 * L}}, {"depth", {2.5 * L}}});
               BoundaryCondition press = condition(BoundaryCondition::Kind::Path);
               press.path = {{}, {20 * lab.at.dt, {0, -0.04 * L, 0}, {}}};
               plate.boundary = {press};
               scene.bodies = {lab.block("block", placed({0, 0.502 * L, 0})), plate};
               scene.bodies[1].transform = placed({0, 1.004 * L, 0});
               scene.bodies[1].transform.rows[1][1] = 1;
               if (!lab.start(scene)) return;
               std::vector<std::size_t> top;
               std::vector<std::size_t> bottom;
               const std::vector<Vector3> x0 = lab.simulator().positions();
               for (const std::size_t v : lab.vertices(0)) {
                   if (x0[v][1] > L) top.push_back(v);
                   if (x0[v][1] < 0.01 * L) bottom.push_back(v);
               }
               if (!lab.run(80)) return;
               const double stretch =
                   (height_by_force(lab, top) - height_by_force(lab, bottom)) / L;
               const double force = -uniaxial_stress(lab.material, stretch) * L * L;
               lab.expect("above", force, -lab.force(top)[1]);
               lab.expect("below", force, lab.force(bottom)[1]);
           }});
}

/// Tip sag of a clamped beam of length 1 and width 1/5 sizes.
void sag(Lab& lab, Scene scene) {
    const double L = lab.size();
    const double n = lab.at.mesh == 0 ? 1 : 2;
    Body bar =
        lab.body("bar", "box", {{"size", {L, L / 5, L / 5}}, {"cells", {5 * n, n, n}}});
    auto clamp = condition(BoundaryCondition::Kind::Fixed);
    clamp.selection = part({0, 0, 0}, {0, 1, 1});
    bar.boundary = {clamp};
    scene.bodies = {bar};
    if (!lab.start(scene)) return;
    const std::vector<Vector3> x0 = lab.simulator().positions();
    std::vector<std::size_t> tip;
    for (std::size_t v = 0; v < x0.size(); ++v)
        if (x0[v][0] > 0.499 * L) tip.push_back(v);
    const double start = mean_y(lab, tip);
    if (!lab.run(60)) return;
    lab.expect("sag", 0.0, start - mean_y(lab, tip), 1.0);
}

TEST(Elastic, BeamSags) {
    // Timoshenko: q L^4 / 8EI + 1.2 q L^2 / 2GA, q = rho g A. Linear tetrahedra of this
    // mesh are far stiffer, so the answer is that of a run with all tolerances far down.
    Domain domain = quiet(25.0);
    domain.meshes = {0, 1};
    domain.holds = [holds = domain.holds](const Case& at) {
        const Material m = preset(at.preset);
        return holds(at) && 40 * m.density * kGravity * at.size <= 0.1 * m.young;
    };
    check({"a clamped beam sags",
           "the same mesh to convergence; beam theory where the mesh resolves it",
           "linear tetrahedra lock in bending",
           domain,
           Cover::Pairs,
           [](Lab& lab) {
               Lab exact(lab.at, true);
               Scene tight = exact.scene();
               tight.solver.tolerance = 1e-9;
               tight.solver.pcg_tolerance = 1e-18;
               sag(exact, tight);
               sag(lab, lab.scene());
               if (!exact.failed.empty()) lab.failed = "tight run: " + exact.failed;
               if (!lab.failed.empty()) return;
               lab.measured[0].expected = exact.measured[0].found;
               lab.measured[0].scale = exact.measured[0].found;
           }});
}

TEST(Elastic, MovingEndCarriesTheRest) {
    // A bar drawn along by one end at constant speed: the mean of its free part follows,
    // at rest relative to the end after its waves are damped.
    Domain domain = quiet(1.0);
    domain.meshes = {0, 1};
    check({"a bar drawn by one end",
           "v = v of the end",
           "none once waves are damped",
           domain,
           Cover::Pairs,
           [](Lab& lab) {
               const double L = lab.size();
               Scene scene = lab.scene();
               scene.gravity = {0, 0, 0};
               Body bar = lab.block("bar", {}, {1, 1, 1});
               const double v = 0.01 * L / lab.at.dt;
               auto pull = condition(BoundaryCondition::Kind::Velocity, {0, v, 0});
               pull.selection = part({0, 1, 0}, {1, 1, 1});
               bar.velocity = {0, v, 0};
               bar.boundary = {pull};
               scene.bodies = {bar};
               if (!lab.start(scene) || !lab.run(60)) return;
               lab.expect("velocity", v, lab.motion().v[1]);
           }});
}

}  // namespace
}  // namespace noli::accuracy
