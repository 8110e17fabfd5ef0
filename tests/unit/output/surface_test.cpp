// SPDX-License-Identifier: Apache-2.0
#include "output/surface.hpp"

#include "unit/output/small_frame.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <sstream>

namespace noli {
namespace {

template <class T>
T take(std::string_view& bytes) {
    T value{};
    std::memcpy(&value, bytes.data(), sizeof value);
    bytes.remove_prefix(sizeof value);
    return value;
}

TEST(SurfaceWriter, LeavesInnerVerticesOut) {
    const SmallFrame small;
    EXPECT_EQ(SurfaceWriter(small.mesh()).num_vertices(), 10);
}

TEST(SurfaceWriter, WritesObjWithOneObjectPerBody) {
    const SmallFrame small;
    std::istringstream in(SurfaceWriter(small.mesh()).encode_obj(small.frame()));
    std::vector<Vector3> vertices;
    std::vector<std::string> rest;
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with("v ")) {
            std::istringstream numbers(line.substr(2));
            Vector3 x{};
            numbers >> x[0] >> x[1] >> x[2];
            vertices.push_back(x);
        } else if (!line.starts_with('#')) {
            rest.push_back(line);
        }
    }
    std::vector<Vector3> expected = small.positions;
    expected.erase(expected.begin() + 4);  // the unused inner vertex
    EXPECT_EQ(vertices, expected);
    const std::vector<std::string> cells{"o jelly",
                                         "f 1 3 2",
                                         "f 1 2 4",
                                         "f 2 3 4",
                                         "f 1 4 3",
                                         "o my_floor",
                                         "f 5 6 7",
                                         "o rod",
                                         "l 8 9",
                                         "o pin",
                                         "p 10"};
    EXPECT_EQ(rest, cells);
}

TEST(SurfaceWriter, WritesPlyThatReadsBackBitForBit) {
    const SmallFrame small;
    const std::string text = SurfaceWriter(small.mesh()).encode_ply(small.frame());
    const std::string end = "end_header\n";
    const size_t header = text.find(end) + end.size();
    EXPECT_NE(text.find("element vertex 10\n"), std::string::npos);
    EXPECT_NE(text.find("element face 5\n"), std::string::npos);
    EXPECT_NE(text.find("element edge 1\n"), std::string::npos);
    std::string_view data = std::string_view(text).substr(header);
    for (size_t v = 0; v < small.positions.size(); ++v) {
        if (v == 4) continue;
        for (size_t k = 0; k < 3; ++k)
            EXPECT_EQ(take<double>(data), small.positions[v][k]);
        for (size_t k = 0; k < 3; ++k)
            EXPECT_EQ(take<double>(data), small.velocities[v][k]);
        EXPECT_EQ(take<std::int32_t>(data), small.body[v]);
    }
    EXPECT_EQ(data.size(), 5u * (1 + 3 * 4) + 2 * 4);
    EXPECT_EQ(take<std::uint8_t>(data), 3);
    const std::array<std::int32_t, 3> first{0, 2, 1};
    for (const std::int32_t corner : first)
        EXPECT_EQ(take<std::int32_t>(data), corner);
}

}  // namespace
}  // namespace noli
