// SPDX-License-Identifier: Apache-2.0
#include "sim/run_scene_files.hpp"

#include "output/file.hpp"
#include "unit/output/scratch_folder.hpp"

#include <gtest/gtest.h>

#include <filesystem>

namespace noli {
namespace {

namespace fs = std::filesystem;

/// A scene with one mesh file, "meshes/a.mesh", below the folder.
Scene make_scene(const ScratchFolder& folder, const std::string& mesh = "mesh") {
    fs::create_directories(folder / "meshes");
    EXPECT_TRUE(write_file(folder / "meshes/a.mesh", mesh));
    Scene scene;
    scene.base_folder = folder.path();
    scene.bodies.emplace_back();
    scene.bodies[0].name = "a";
    scene.bodies[0].mesh.file = "meshes/a.mesh";
    return scene;
}

std::uint64_t fingerprint(const Scene& scene) {
    const Result<std::uint64_t> hash = scene_fingerprint(scene);
    EXPECT_TRUE(hash);
    return hash ? hash.value() : 0;
}

TEST(SceneFingerprint, IgnoresPlaceNamesDurationAndOutput) {
    const ScratchFolder here;
    const ScratchFolder there;
    const Scene scene = make_scene(here);
    Scene other = make_scene(there);
    other.name = "renamed";
    other.description = "longer";
    other.duration = 99.0;
    other.output.every = 7;
    other.output.formats = {"ply"};
    EXPECT_EQ(fingerprint(scene), fingerprint(other));
    EXPECT_EQ(fingerprint(scene), fingerprint(with_absolute_files(scene)));
}

TEST(SceneFingerprint, ChangesWithAllThatDecidesTheMotion) {
    const ScratchFolder folder;
    const Scene scene = make_scene(folder);
    const std::uint64_t before = fingerprint(scene);
    Scene other = scene;
    other.dt *= 0.5;
    EXPECT_NE(fingerprint(other), before);
    other = scene;
    other.bodies[0].material.young *= 2.0;
    EXPECT_NE(fingerprint(other), before);
    other = scene;
    other.solver.tolerance *= 0.1;
    EXPECT_NE(fingerprint(other), before);
    EXPECT_TRUE(write_file(folder / "meshes/a.mesh", "mesH"));
    EXPECT_NE(fingerprint(scene), before);
}

TEST(WithAbsoluteFiles, MeansTheSameWithoutABaseFolder) {
    const ScratchFolder folder;
    Scene scene = make_scene(folder);
    scene.bodies[0].boundary.emplace_back();
    scene.bodies[0].boundary[0].sequence = {"meshes/../b.obj", "/c.obj"};
    const Scene out = with_absolute_files(scene);
    EXPECT_EQ(out.base_folder, "");
    EXPECT_EQ(out.bodies[0].mesh.file, folder / "meshes/a.mesh");
    EXPECT_EQ(out.bodies[0].boundary[0].sequence[0], folder / "b.obj");
    EXPECT_EQ(out.bodies[0].boundary[0].sequence[1], "/c.obj");
}

TEST(CompanionFiles, AreThoseThatTheReaderLooksAt) {
    const ScratchFolder folder;
    for (const char* name : {"a.node", "a.ele", "b.seg", "b.obj", "c.msh"})
        ASSERT_TRUE(write_file(folder / name, "x"));
    using Paths = std::vector<std::string>;
    EXPECT_EQ(companion_files(folder / "a.node"),
              (Paths{folder / "a.node", folder / "a.ele"}));
    EXPECT_EQ(companion_files(folder / "a.ele"),
              (Paths{folder / "a.ele", folder / "a.node"}));
    EXPECT_EQ(companion_files(folder / "a"),
              (Paths{folder / "a.node", folder / "a.ele"}));
    EXPECT_EQ(companion_files(folder / "b.seg"),
              (Paths{folder / "b.seg", folder / "b.obj"}));
    EXPECT_EQ(companion_files(folder / "b.pt"), Paths{folder / "b.obj"});
    EXPECT_EQ(companion_files(folder / "c.msh"), Paths{folder / "c.msh"});
    EXPECT_EQ(companion_files(folder / "none.msh"), Paths{});
}

}  // namespace
}  // namespace noli
