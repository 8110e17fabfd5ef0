// SPDX-License-Identifier: Apache-2.0
#include "output/vtu.hpp"

#include "output/file.hpp"
#include "unit/output/scratch_folder.hpp"
#include "unit/output/small_frame.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

namespace noli {
namespace {

/// The arrays of a VTU text as an independent reader (Python's XML, base64 and zlib) sees
/// them; null if it could not read them.
nlohmann::json read_by_python(const std::string& vtu) {
    const ScratchFolder scratch;
    if (!write_file(scratch / "frame.vtu", vtu)) return nullptr;
    const std::string command = std::string("python3 ") + NOLI_SOURCE_DIR
                              + "/tests/cli/vtu_reader.py " + (scratch / "frame.vtu")
                              + " > " + (scratch / "out.json");
    if (std::system(command.c_str()) != 0) return nullptr;
    return nlohmann::json::parse(read_file(scratch / "out.json").value(), nullptr, false);
}

TEST(EncodeBase64, MatchesRfc4648) {
    EXPECT_EQ(encode_base64(""), "");
    EXPECT_EQ(encode_base64("f"), "Zg==");
    EXPECT_EQ(encode_base64("fo"), "Zm8=");
    EXPECT_EQ(encode_base64("foo"), "Zm9v");
    EXPECT_EQ(encode_base64("foob"), "Zm9vYg==");
    EXPECT_EQ(encode_base64("fooba"), "Zm9vYmE=");
    EXPECT_EQ(encode_base64("foobar"), "Zm9vYmFy");
    EXPECT_EQ(encode_base64("\xff\xfe\xfd"), "//79");
}

TEST(VtuWriter, GivesAnIndependentReaderEveryBitBack) {
    const SmallFrame small;
    const nlohmann::json read =
        read_by_python(VtuWriter(small.mesh()).encode(small.frame()));
    ASSERT_TRUE(read.is_object());
    EXPECT_EQ(read.at("time").get<double>(), small.frame().time);
    EXPECT_EQ(read.at("points").get<std::vector<Vector3>>(), small.positions);
    const auto& points = read.at("point_data");
    EXPECT_EQ(points.at("velocity").get<std::vector<Vector3>>(), small.velocities);
    EXPECT_EQ(points.at("contact_force").get<std::vector<Vector3>>(), small.force);
    EXPECT_EQ(points.at("body_id").get<std::vector<int>>(), small.body);
    const auto displacement = points.at("displacement").get<std::vector<Vector3>>();
    for (size_t i = 0; i < displacement.size(); ++i)
        for (size_t k = 0; k < 3; ++k)
            EXPECT_EQ(displacement[i][k], small.positions[i][k] - small.initial[i][k]);
}

TEST(VtuWriter, WritesTetsObstaclesSegmentsAndPointsAsCells) {
    const SmallFrame small;
    const nlohmann::json read =
        read_by_python(VtuWriter(small.mesh()).encode(small.frame()));
    ASSERT_TRUE(read.is_object());
    using Cell = std::pair<int, std::vector<int>>;
    const std::vector<Cell> expected{
        {10, {0, 1, 2, 3}}, {5, {5, 6, 7}}, {3, {8, 9}}, {1, {10}}};
    EXPECT_EQ(read.at("cells").get<std::vector<Cell>>(), expected);
    const auto& cells = read.at("cell_data");
    EXPECT_EQ(cells.at("body_id").get<std::vector<int>>(),
              (std::vector<int>{0, 1, 2, 3}));
    EXPECT_EQ(cells.at("von_mises").get<std::vector<double>>(),
              (std::vector<double>{1.0 / 3.0, 0, 0, 0}));
    using Tensor = std::array<double, 6>;
    EXPECT_EQ(cells.at("stress").get<std::vector<Tensor>>(),
              (std::vector<Tensor>{{1, 4, 6, 2, 5, 3}, Tensor{}, Tensor{}, Tensor{}}));
}

TEST(LonePoints, AreNoVerticesWithoutAnElement) {
    const SmallFrame small;
    FrameMesh mesh = small.mesh();
    EXPECT_EQ(lone_points(mesh), (std::vector<int>{10}));
    const std::vector<int> unreferenced{10};
    mesh.unreferenced = unreferenced;
    EXPECT_TRUE(lone_points(mesh).empty());
}

TEST(VtuWriter, SplitsLargeArraysIntoBlocks) {
    // 30,000 points are 720,000 bytes: two full blocks of 256 KiB and a part.
    SmallFrame small;
    small.positions.resize(30000);
    small.body.resize(30000, 0);
    for (size_t i = 0; i < small.positions.size(); ++i)
        small.positions[i] = {
            0.1 * static_cast<double>(i), 1.0 / static_cast<double>(i + 1), 0};
    Frame frame = small.frame();
    frame.velocities = {};
    frame.contact_force = {};
    const nlohmann::json read = read_by_python(VtuWriter(small.mesh()).encode(frame));
    ASSERT_TRUE(read.is_object());
    EXPECT_EQ(read.at("points").get<std::vector<Vector3>>(), small.positions);
    EXPECT_FALSE(read.at("point_data").contains("velocity"));
}

TEST(VtuWriter, HoldsAnEmptyMesh) {
    const nlohmann::json read = read_by_python(VtuWriter(FrameMesh{}).encode(Frame{}));
    ASSERT_TRUE(read.is_object());
    EXPECT_TRUE(read.at("points").empty());
    EXPECT_TRUE(read.at("cells").empty());
}

TEST(VtuWriter, GivesEqualTextForEqualFrames) {
    const SmallFrame small;
    EXPECT_EQ(VtuWriter(small.mesh()).encode(small.frame()),
              VtuWriter(small.mesh()).encode(small.frame()));
}

TEST(EncodePvd, ListsFramesWithTheirTimes) {
    const std::string text = encode_pvd({{0.0, "frames/a.vtu"}, {0.1, "frames/b.vtu"}});
    EXPECT_NE(text.find("timestep=\"0\" part=\"0\" file=\"frames/a.vtu\""),
              std::string::npos);
    EXPECT_NE(text.find("timestep=\"0.10000000000000001\""), std::string::npos);
}

TEST(FrameFileName, GivesItsStepBack) {
    EXPECT_EQ(frame_file_name(12, "vtu"), "frame_000012.vtu");
    for (const int step : {0, 7, 999999, 1234567})
        EXPECT_EQ(step_of_frame_file(frame_file_name(step, "ply")), step);
    for (const char* name : {"frame_.vtu", "frame_1", "frame_1x.vtu", "other_000001.vtu"})
        EXPECT_EQ(step_of_frame_file(name), -1);
}

}  // namespace
}  // namespace noli
