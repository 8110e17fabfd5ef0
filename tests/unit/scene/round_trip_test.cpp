// SPDX-License-Identifier: Apache-2.0
#include "noli/scene.hpp"

#include "unit/scene/flatten.hpp"
#include "unit/scene/random_scene.hpp"
#include "unit/scene/scratch_folder.hpp"

#include <gtest/gtest.h>

namespace noli {
namespace {

using test::Flat;
using test::ScratchFolder;

TEST(SceneToJson, ReadsBackBitForBit) {
    const ScratchFolder folder;
    folder.write("tet.mesh", test::kTetMesh);
    folder.write("triangle.obj", test::kTriangleObj);
    for (unsigned seed = 0; seed < 300; ++seed) {
        Scene scene = test::RandomScene(seed).make();
        scene.base_folder = folder.path();
        const std::string text = scene_to_json(scene);
        const Result<Scene> back = read_scene(folder.write("scene.json", text));
        ASSERT_TRUE(back) << seed << "\n"
                          << back.error().where << ": " << back.error().message << "\n"
                          << text;
        ASSERT_EQ(Flat(back.value()).items(), Flat(scene).items()) << seed << "\n"
                                                                   << text;
        ASSERT_EQ(scene_to_json(back.value()), text) << seed;
    }
}

TEST(SceneToJson, LeavesOutDefaultsButNamesTimeStepAndMaterial) {
    Scene scene;
    scene.name = "drop";
    Body body;
    body.name = "ball";
    body.mesh.generator = "sphere";
    body.mesh.parameters = {{"radius", {0.25}}};
    body.material.young = 2e6;
    scene.bodies.push_back(body);
    scene.half_spaces.push_back({"floor", {}, {0, 1, 0}, 0.5});
    EXPECT_EQ(scene_to_json(scene), R"({
  "format_version": 1,
  "name": "drop",
  "duration": 5,
  "dt": 0.025,
  "bodies": [
    {
      "name": "ball",
      "mesh": { "generator": "sphere", "radius": 0.25 },
      "material": { "density": 1000, "young": 2000000, "poisson": 0.4 }
    }
  ],
  "half_spaces": [{ "name": "floor", "friction": 0.5 }]
}
)");
}

Scene read_text_scene(const ScratchFolder& folder, const std::string& text) {
    const Result<Scene> scene = read_scene(folder.write("scene.json", text));
    EXPECT_TRUE(scene) << scene.error().where << ": " << scene.error().message;
    return scene ? scene.value() : Scene{};
}

TEST(ReadScene, FillsInNamesAndBaseFolder) {
    const ScratchFolder folder;
    const Scene scene = read_text_scene(folder, R"({ "format_version": 1,
        "bodies": [{ "mesh": { "generator": "box" } }, { "name": "b", "mesh": { "generator": "box" } }],
        "half_spaces": [{}] })");
    EXPECT_EQ(scene.name, "scene");
    EXPECT_EQ(scene.bodies[0].name, "body0");
    EXPECT_EQ(scene.bodies[1].name, "b");
    EXPECT_EQ(scene.half_spaces[0].name, "plane0");
    EXPECT_EQ(scene.base_folder, folder.path());
}

TEST(ReadScene, TakesContainers) {
    const ScratchFolder folder;
    const Scene scene = read_text_scene(folder, R"({ "format_version": 1,
        "bodies": [{ "mesh": { "generator": "box" } }],
        "containers": [{ "shape": "sphere", "radius": "20 cm", "friction": 0.3 },
                       { "name": "pipe", "shape": "cylinder", "radius": 2,
                         "center": [0, "1 mm", 0], "axis": [1, 1, 0] }],
        "contact": { "pairs": [{ "a": "body0", "b": "pipe", "enabled": false }] } })");
    ASSERT_EQ(scene.containers.size(), 2U);
    EXPECT_EQ(scene.containers[0].name, "container0");
    EXPECT_EQ(scene.containers[0].shape, Container::Shape::Sphere);
    EXPECT_EQ(scene.containers[0].radius, 0.2);
    EXPECT_EQ(scene.containers[0].friction, 0.3);
    EXPECT_EQ(scene.containers[1].name, "pipe");
    EXPECT_EQ(scene.containers[1].shape, Container::Shape::Cylinder);
    EXPECT_EQ(scene.containers[1].center, (Vector3{0, 1e-3, 0}));
    EXPECT_EQ(scene.containers[1].axis, (Vector3{1, 1, 0}));
}

TEST(ReadScene, UnderstandsUnitsAndAbsoluteSettings) {
    const ScratchFolder folder;
    const Scene scene = read_text_scene(
        folder, R"({ "format_version": 1, "duration": "500 ms", "dt": "5 ms",
        "gravity": [0, "-981 cm/s^2", 0],
        "bodies": [{ "mesh": { "generator": "box", "size": ["10 cm", 0.2, "30 mm"] },
                     "material": { "preset": "rubber", "young": "5 MPa" },
                     "angular_velocity_deg": ["0.5 rev/s", 0, 0] }],
        "contact": { "dhat": "2 mm", "epsv": 0.01, "epsv_absolute": true },
        "solver": { "tolerance": "1 mm/s" } })");
    EXPECT_EQ(scene.duration, 0.5);
    EXPECT_EQ(scene.num_steps(), 100);
    EXPECT_EQ(scene.gravity[1], -9.81);
    EXPECT_EQ(scene.bodies[0].mesh.parameters[0].second,
              (std::vector<double>{0.1, 0.2, 0.03}));
    EXPECT_EQ(scene.bodies[0].material.young, 5e6);
    EXPECT_EQ(scene.bodies[0].material.density, 950);
    EXPECT_EQ(scene.bodies[0].angular_velocity_deg[0], 180);
    EXPECT_TRUE(scene.contact.dhat_absolute);
    EXPECT_EQ(scene.contact.dhat, 0.002);
    EXPECT_TRUE(scene.contact.epsv_absolute);
    EXPECT_EQ(scene.contact.epsv, 0.01);
    EXPECT_TRUE(scene.solver.tolerance_absolute);
    EXPECT_EQ(scene.solver.tolerance, 0.001);
}

TEST(ReadScene, ComposesTransforms) {
    const ScratchFolder folder;
    const Scene scene = read_text_scene(folder, R"({ "format_version": 1, "bodies": [
        { "mesh": { "generator": "box" },
          "transform": { "scale": [1, 2, 3], "rotate_deg": [0, 90, 90], "translate": [5, 6, 7] } },
        { "mesh": { "generator": "box" }, "transform": { "matrix": [[0, 1, 0, "1 cm"], [-1, 0, 0, 2], [0, 0, 1, 3]] } }
    ] })");
    // z by 90: x -> y, y -> -x; then y by 90: z -> x, x -> -z. So x -> y, y -> z, z -> x.
    const auto& m = scene.bodies[0].transform.rows;
    EXPECT_EQ(m[0], (std::array<double, 4>{0, 0, 3, 5}));
    EXPECT_EQ(m[1], (std::array<double, 4>{1, 0, 0, 6}));
    EXPECT_EQ(m[2], (std::array<double, 4>{0, 2, 0, 7}));
    EXPECT_EQ(scene.bodies[1].transform.rows[0], (std::array<double, 4>{0, 1, 0, 0.01}));
}

TEST(ReadScene, UnderstandsShorthands) {
    const ScratchFolder folder;
    folder.write("meshes/tet.mesh", test::kTetMesh);
    const Scene scene = read_text_scene(
        folder, R"({ "format_version": 1, "base_folder": "meshes", // relative
        "bodies": [{ "mesh": "tet.mesh", "material": "steel", "boundary": [{ "kind": "fixed", "select": "all" }] }] })");
    EXPECT_EQ(scene.bodies[0].mesh.file, "tet.mesh");
    EXPECT_EQ(scene.bodies[0].material.young, 2.1e11);
    EXPECT_EQ(scene.base_folder, folder.path() + "/meshes");
    EXPECT_EQ(scene.bodies[0].boundary[0].selection.kind, Selection::Kind::All);
}

TEST(Scene, CountsStepsDespiteRounding) {
    Scene scene;
    const auto steps = [&](double duration, double dt) {
        scene.duration = duration;
        scene.dt = dt;
        return scene.num_steps();
    };
    EXPECT_EQ(steps(5, 0.025), 200);
    EXPECT_EQ(steps(0.3, 0.1), 3);  // 0.3 / 0.1 is a little less than 3
    EXPECT_EQ(steps(0.7, 0.1), 7);  // and 0.7 / 0.1 likewise
    EXPECT_EQ(steps(1, 0.3), 4);
    EXPECT_EQ(steps(0.001, 1), 1);
    EXPECT_EQ(steps(6, 0.002), 3000);
}

}  // namespace
}  // namespace noli
