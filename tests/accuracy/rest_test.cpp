// SPDX-License-Identifier: Apache-2.0
/// Bodies at rest: contact carries their weight.

#include "check.hpp"
#include "discrete.hpp"
#include "settle.hpp"

namespace noli::accuracy {
namespace {

const char* const kWeight = "contact force = weight";
const char* const kSettledOnly =
    "none at rest; only where a body comes to rest in 60 steps (not under Newmark, which "
    "damps nothing)";

/// Puts the bodies of a scene, piled up along y, at rest on y = 0.
bool start_pile(Lab& lab, Scene& scene, const std::vector<double>& heights) {
    if (!lab.start(scene)) return false;
    std::vector<double> gaps(scene.bodies.size());
    double carried = 0.0;
    for (std::size_t k = gaps.size(); k-- > 0;) {
        carried += lab.motion(static_cast<int>(k)).mass;
        gaps[k] = lab.resting_gap(carried, lab.vertices_of_face());
    }
    double floor = 0.0;
    for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
        floor += gaps[k];
        Affine& place = scene.bodies[k].transform;
        place.rows[1][3] = floor + 0.5 * heights[k];
        floor += heights[k];
    }
    return lab.start(scene);
}

TEST(Rest, BlockOnAHalfSpace) {
    check({"a block rests on a half-space",
           kWeight,
           kSettledOnly,
           settling(1.0),
           Cover::Pairs,
           [](Lab& lab) {
               Scene scene = lab.scene();
               scene.half_spaces = {plane(0.3)};
               scene.bodies = {lab.block("block", placed({0, lab.size(), 0}))};
               if (!start_pile(lab, scene, {lab.size()}) || !lab.run(60)) return;
               const double weight = lab.motion().mass * kGravity;
               lab.expect("force", weight, lab.force(lab.vertices(0))[1]);
           },
           8});
}

TEST(Rest, BlockOnATiltedHalfSpace) {
    // On a plane of slope atan 0.25 and mu 0.6 the block stays: contact and friction
    // together carry its weight.
    check(
        {"a block rests on a slope",
         kWeight,
         kSettledOnly,
         settling(1.0),
         Cover::Values,
         [](Lab& lab) {
             Scene scene = lab.scene();
             const double angle = std::atan(0.25);
             scene.gravity = {kGravity * std::sin(angle), -kGravity * std::cos(angle), 0};
             scene.half_spaces = {plane(0.6)};
             scene.bodies = {lab.block("block", placed({0, lab.size(), 0}))};
             if (!start_pile(lab, scene, {lab.size()}) || !lab.run(60)) return;
             const double weight = lab.motion().mass * kGravity;
             lab.expect(
                 "normal force", weight * std::cos(angle), lab.force(lab.vertices(0))[1]);
             lab.expect(
                 "friction", -weight * std::sin(angle), lab.force(lab.vertices(0))[0]);
         }});
}

TEST(Rest, BallOnAHalfSpace) {
    Domain domain = settling(1.0);
    domain.meshes = {0, 1};
    check({"a ball rests on a half-space",
           kWeight,
           kSettledOnly,
           domain,
           Cover::Values,
           [](Lab& lab) {
               Scene scene = lab.scene();
               scene.half_spaces = {plane(0.5)};
               scene.bodies = {lab.ball("ball", placed({0, lab.size(), 0}))};
               if (!lab.start(scene)) return;
               double low = HUGE_VAL;
               for (const Vector3& x : lab.simulator().positions())
                   low = std::min(low, x[1]);
               if (!start_pile(lab, scene, {2 * (lab.size() - low)}) || !lab.run(60))
                   return;
               // A ball of facets may still rock: m g less what its centre accelerates.
               const double before = lab.motion().v[1];
               if (!lab.run(1)) return;
               const double a = (lab.motion().v[1] - before) / lab.at.dt;
               lab.expect("force",
                          lab.motion().mass * (kGravity + a),
                          lab.force(lab.vertices(0))[1],
                          lab.motion().mass * kGravity);
           }});
}

TEST(Rest, BlockOnAPlate) {
    Domain domain = settling(1.0);
    domain.meshes = {0, 1};
    check({"a block rests on an obstacle",
           kWeight,
           kSettledOnly,
           domain,
           Cover::Values,
           [](Lab& lab) {
               const double L = lab.size();
               Scene scene = lab.scene();
               Body plate = lab.body(
                   "plate",
                   "plane_surface",
                   {{"width", {3 * L}}, {"depth", {2.5 * L}}, {"cells", {2, 2}}});
               scene.bodies = {lab.block("block", placed({0.1 * L, L, 0.05 * L})), plate};
               if (!lab.start(scene)) return;
               const double gap =
                   lab.resting_gap(lab.motion(0).mass, lab.vertices_of_face());
               scene.bodies[0].transform = placed({0.1 * L, 0.5 * L + gap, 0.05 * L});
               if (!lab.start(scene) || !lab.run(60)) return;
               lab.expect(
                   "force", lab.motion(0).mass * kGravity, lab.force(lab.vertices(0))[1]);
           }});
}

/// Vertices of a body that lie lowest.
std::vector<std::size_t> underside(Lab& lab, int body) {
    const std::vector<Vector3> x = lab.simulator().positions();
    const std::vector<std::size_t> all = lab.vertices(body);
    double low = HUGE_VAL;
    for (const std::size_t v : all)
        low = std::min(low, x[v][1]);
    std::vector<std::size_t> out;
    for (const std::size_t v : all)
        if (x[v][1] < low + 0.05 * lab.size()) out.push_back(v);
    return out;
}

/// Each underside carries the bodies above it.
void expect_stack(Lab& lab, const std::vector<std::string>& presets, double offset) {
    const double L = lab.size();
    Scene scene = lab.scene();
    scene.half_spaces = {plane(0.5)};
    for (std::size_t k = 0; k < presets.size(); ++k) {
        const double shift = k % 2 == 1 ? offset * L : 0.0;
        Body block = lab.block("block" + std::to_string(k),
                               placed({shift, (2.0 * k + 1) * L, shift}));
        block.material = preset(presets[k]);
        block.friction = 0.5;  // without it a column is in no stable balance
        scene.bodies.push_back(block);
    }
    const std::vector<double> heights(presets.size(), L);
    if (!start_pile(lab, scene, heights) || !lab.run(60)) return;
    double weight = 0.0;
    for (int k = static_cast<int>(presets.size()); k-- > 0;) {
        weight += lab.motion(k).mass * kGravity;
        lab.expect(
            "under block " + std::to_string(k), weight, lab.force(underside(lab, k))[1]);
    }
}

TEST(Stack, ThreeAlike) {
    Domain domain = settling(3.0);
    domain.meshes = {0, 1};
    check({"a stack of three cubes",
           "each interface carries the weight above",
           kSettledOnly,
           domain,
           Cover::Values,
           [](Lab& lab) {
               expect_stack(lab, {lab.at.preset, lab.at.preset, lab.at.preset}, 0.1);
           }});
}

TEST(Stack, HeavyOnLight) {
    Domain domain = settling(3.0);
    domain.meshes = {0, 1};
    domain.holds = [holds = domain.holds](const Case& at) {
        Case cork = at;
        cork.preset = "cork";
        return holds(at) && holds(cork);
    };
    check({"a stack with cork in the middle",
           "each interface carries the weight above",
           kSettledOnly,
           domain,
           Cover::Values,
           [](Lab& lab) {
               expect_stack(lab, {lab.at.preset, "cork", lab.at.preset}, 0.1);
           }});
}

TEST(Stack, FiveInLine) {
    Domain domain = settling(5.0);
    domain.meshes = {0};
    check({"a column of five cubes",
           "each interface carries the weight above",
           kSettledOnly,
           domain,
           Cover::Values,
           [](Lab& lab) {
               expect_stack(lab, std::vector<std::string>(5, lab.at.preset), 0.0);
           }});
}

TEST(Rest, TwoBlocks300MetresApart) {
    Domain domain = settling(1.0);
    domain.meshes = {0, 1};
    domain.sizes = {1e-2, 0.1, 1.0};
    check({"two blocks rest 300 m apart",
           kWeight,
           kSettledOnly,
           domain,
           Cover::Values,
           [](Lab& lab) {
               Scene scene = lab.scene();
               const double L = lab.size();
               scene.half_spaces = {plane(0.5)};
               scene.bodies = {lab.block("near", placed({0, L, 0})),
                               lab.block("far", placed({300, L, 0}))};
               if (!lab.start(scene)) return;
               const double dhat = lab.simulator().resolved().dhat;
               const double gap = 0.5 * dhat;
               for (Body& body : scene.bodies)
                   body.transform.rows[1][3] = 0.5 * L + gap;
               if (!lab.start(scene) || !lab.run(60)) return;
               for (const int body : {0, 1})
                   lab.expect("force",
                              lab.motion(body).mass * kGravity,
                              lab.force(lab.vertices(body))[1]);
               // Not the distance between the blocks counts: dhat is at most 2 % of the
               // diagonal of one.
               const double most = 0.02 * std::sqrt(3.0) * L;
               lab.expect_at_most("gap", most, lab.motion(0).x[1] - 0.5 * L, L);
           }});
}

TEST(Rest, FarFromTheOrigin) {
    Domain domain = settling(1.0);
    domain.meshes = {0};
    domain.sizes = {1e-2, 0.1, 1.0, 10.0};
    // dhat is 1.7e-3 sizes; positions at 1e5 m are known to 1.5e-11 m.
    check({"a block rests 1e5 m from the origin",
           kWeight,
           kSettledOnly,
           domain,
           Cover::Values,
           [](Lab& lab) {
               Scene scene = lab.scene();
               const double L = lab.size();
               const double far = 1e5;
               HalfSpace floor = plane(0.5);
               floor.point = {far, far, -far};
               scene.half_spaces = {floor};
               scene.bodies = {lab.block("block", placed({far, far + L, -far}))};
               if (!lab.start(scene)) return;
               const double gap =
                   lab.resting_gap(lab.motion().mass, lab.vertices_of_face());
               scene.bodies[0].transform = placed({far, far + 0.5 * L + gap, -far});
               if (!lab.start(scene) || !lab.run(60)) return;
               lab.expect(
                   "force", lab.motion().mass * kGravity, lab.force(lab.vertices(0))[1]);
           }});
}

TEST(Rest, NothingHappensWithoutForces) {
    check({"a box at rest without gravity",
           "stays, in one Newton iteration a step",
           "none",
           {},
           Cover::Values,
           [](Lab& lab) {
               Scene scene = lab.scene();
               scene.gravity = {0, 0, 0};
               scene.bodies = {lab.block("block", {})};
               if (!lab.start(scene)) return;
               const std::vector<Vector3> x0 = lab.simulator().positions();
               if (!lab.run(5)) return;
               const std::vector<Vector3> x = lab.simulator().positions();
               double most = 0.0;
               for (std::size_t v = 0; v < x.size(); ++v)
                   for (std::size_t k = 0; k < 3; ++k)
                       most = std::max(most, std::abs(x[v][k] - x0[v][k]));
               lab.expect("moved", 0.0, most, lab.size());
               lab.expect_at_most("Newton iterations", 5, lab.newton, 5);
           }});
}

}  // namespace
}  // namespace noli::accuracy
