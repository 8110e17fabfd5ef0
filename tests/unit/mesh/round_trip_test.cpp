// SPDX-License-Identifier: Apache-2.0
#include "mesh/generate.hpp"
#include "mesh/topology.hpp"
#include "mesh/write.hpp"
#include "unit/mesh/test_files.hpp"

#include <random>

namespace noli {
namespace {

using test::read_fine;
using test::TempFolder;

/// Numbers that need all their digits, of all sizes.
Mesh random_mesh(bool tets, bool triangles, bool segments) {
    std::mt19937_64 random(17);
    std::uniform_real_distribution<double> mantissa(-1, 1);
    std::uniform_int_distribution<int> exponent(-40, 40), vertex(0, 199);
    Mesh mesh;
    for (int i = 0; i < 200; ++i)
        mesh.x.push_back({std::ldexp(mantissa(random), exponent(random)),
                          std::ldexp(mantissa(random), exponent(random)),
                          mantissa(random)});
    mesh.x[7] = {5e-324, 1.7976931348623157e308, -0.0};
    for (int i = 0; i < 150; ++i) {
        if (tets)
            mesh.tets.push_back(
                {vertex(random), vertex(random), vertex(random), vertex(random)});
        if (triangles)
            mesh.triangles.push_back({vertex(random), vertex(random), vertex(random)});
        if (segments) mesh.segments.push_back({vertex(random), vertex(random)});
    }
    return mesh;
}

void expect_round_trip(const std::string& name,
                       const Mesh& mesh,
                       const WriteOptions& options = {}) {
    const TempFolder folder;
    const auto failed = write_mesh(folder / name, mesh, options);
    ASSERT_FALSE(failed) << failed->where << failed->message;
    SCOPED_TRACE(name);
    test::expect_same(read_fine(folder / name), mesh);
}

TEST(RoundTrip, MshKeepsEveryBitInAllVersions) {
    for (const bool binary : {false, true})
        for (const auto version : {WriteOptions::Msh::V22, WriteOptions::Msh::V41}) {
            expect_round_trip("a.msh", random_mesh(true, true, true), {binary, version});
            expect_round_trip(
                "a.msh", random_mesh(true, false, false), {binary, version});
            expect_round_trip(
                "a.msh", random_mesh(false, false, false), {binary, version});
        }
}

TEST(RoundTrip, OtherFormatsKeepEveryBit) {
    expect_round_trip("a.mesh", random_mesh(true, true, true));
    expect_round_trip("a.node", random_mesh(true, false, false));
    expect_round_trip("a.obj", random_mesh(false, true, true));
    expect_round_trip("a.ply", random_mesh(false, true, true));
    expect_round_trip("a.ply", random_mesh(false, true, true), {.binary = true});
    expect_round_trip("a.seg", random_mesh(false, false, true));
    expect_round_trip("a.pt", random_mesh(false, false, false));
}

TEST(RoundTrip, ObjKeepsPointsAndOtherFormatsRefuseThem) {
    const TempFolder folder;
    Mesh mesh = random_mesh(false, true, true);
    mesh.points = {3, 1, 4};
    ASSERT_FALSE(write_mesh(folder / "a.obj", mesh));
    EXPECT_EQ(read_fine(folder / "a.obj").points, mesh.points);
    const auto failed = write_mesh(folder / "a.ply", mesh);
    ASSERT_TRUE(failed);
    EXPECT_NE(failed->message.find("points"), std::string::npos);
}

TEST(RoundTrip, StlKeepsTrianglesAndPositions) {
    const TempFolder folder;
    Mesh ball = make_sphere_surface({.radius = 0.3, .edge_length = 0.1}).value();
    ASSERT_FALSE(write_mesh(folder / "a.stl", ball));
    const Mesh back = read_fine(folder / "a.stl");
    ASSERT_EQ(back.x.size(), ball.x.size());
    ASSERT_EQ(back.triangles.size(), ball.triangles.size());
    for (std::size_t t = 0; t < ball.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            const Vec3d a = ball.x[static_cast<std::size_t>(ball.triangles[t][k])];
            const Vec3d b = back.x[static_cast<std::size_t>(back.triangles[t][k])];
            EXPECT_TRUE(a.x == b.x && a.y == b.y && a.z == b.z);
        }
}

TEST(WriteMesh, RefusesWhatAFormatCannotHold) {
    const TempFolder folder;
    const Mesh mesh = random_mesh(true, true, true);
    for (const char* name :
         {"a.obj", "a.ply", "a.stl", "a.seg", "a.pt", "a.node", "a.xyz"}) {
        const auto failed = write_mesh(folder / name, mesh);
        ASSERT_TRUE(failed) << name;
        EXPECT_NE(failed->where.find(name), std::string::npos);
        EXPECT_NE(failed->message.find("cannot hold"), std::string::npos);
        EXPECT_FALSE(std::filesystem::exists(folder / name));
    }
}

TEST(WriteMesh, ReportsAFolderThatDoesNotExist) {
    const TempFolder folder;
    const auto failed =
        write_mesh(folder / "missing/a.obj", random_mesh(false, true, false));
    ASSERT_TRUE(failed);
    EXPECT_NE(failed->message.find("folder exists"), std::string::npos);
}

TEST(WriteMesh, ReportsAFullDisk) {
    if (!std::filesystem::exists("/dev/full"))
        GTEST_SKIP() << "this system has no /dev/full";
    const TempFolder folder;
    std::filesystem::create_symlink("/dev/full", folder / "a.obj");
    EXPECT_TRUE(write_mesh(folder / "a.obj", random_mesh(false, true, false)));
}

}  // namespace
}  // namespace noli
