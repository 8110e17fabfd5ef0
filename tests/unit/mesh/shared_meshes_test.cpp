// SPDX-License-Identifier: Apache-2.0
/// Real meshes of the field; skipped where they are not at hand.
#include "mesh/check.hpp"
#include "mesh/topology.hpp"
#include "unit/mesh/test_files.hpp"

#include <map>

namespace noli {
namespace {

namespace fs = std::filesystem;

const fs::path kInput = fs::path(NOLI_SHARED_DIR) / "ipc-scenes" / "input";

TEST(SharedMeshes, AllAreReadAndPassTheCheck) {
    if (!fs::exists(kInput)) GTEST_SKIP() << "no meshes at " << kInput;
    int count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(kInput)) {
        const std::string ext = entry.path().extension().string();
        if (ext != ".msh" && ext != ".obj" && ext != ".seg" && ext != ".pt") continue;
        ++count;
        SCOPED_TRACE(entry.path().filename().string());
        const Mesh mesh = test::read_fine(entry.path().string());
        const MeshReport report = check_mesh(mesh, natural_role(mesh));
        for (const MeshIssue& issue : report.errors)
            ADD_FAILURE() << issue.message;
        EXPECT_EQ(mesh.tets.empty(), ext != ".msh");
        EXPECT_TRUE(ext != ".msh" || report.quality.volume > 0.0);
    }
    EXPECT_GE(count, 229);
}

TEST(SharedMeshes, HaveTheKnownSizes) {
    if (!fs::exists(kInput)) GTEST_SKIP() << "no meshes at " << kInput;
    struct Size {
        std::size_t vertices, tets, triangles;
    };
    const std::map<std::string, Size> known = {
        {"tetMeshes/dolphin5K.msh", {8111, 36304, 10000}},
        {"tetMeshes/cube.msh", {8, 6, 12}},
        {"tetMeshes/tet.msh", {4, 1, 4}},
        {"tetMeshes/mat40x40.msh", {3200, 9126, 6396}},
        {"tetMeshes/Armadillo13K.msh", {13230, 54985, 17296}},
        {"tetMeshes/sphere1K.msh", {1760, 6851, 2474}},
        {"tetMeshes/erleben/spike.msh", {5, 2, 6}}};
    for (const auto& [name, size] : known) {
        const Mesh mesh = test::read_fine((kInput / name).string());
        EXPECT_EQ(mesh.x.size(), size.vertices) << name;
        EXPECT_EQ(mesh.tets.size(), size.tets) << name;
        EXPECT_EQ(boundary_triangles(mesh.tets).size(), size.triangles) << name;
    }
}

TEST(SharedMeshes, MissingSegAndPtFilesComeFromTheObj) {
    if (!fs::exists(kInput)) GTEST_SKIP() << "no meshes at " << kInput;
    const std::string base = (kInput / "triMeshes" / "triangle").string();
    EXPECT_EQ(test::read_fine(base + ".seg").segments.size(), 3U);
    EXPECT_EQ(test::read_fine(base + ".pt").x.size(), 3U);
}

}  // namespace
}  // namespace noli
