// SPDX-License-Identifier: Apache-2.0
#include "unit/mesh/test_files.hpp"

namespace noli {
namespace {

using test::Bytes;
using test::read_fine;
using test::TempFolder;

constexpr const char* kNodes22 =
    "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n";

TEST(MshReader, Reads22AsciiWithAllKeptTypes) {
    const TempFolder folder;
    const Mesh mesh = read_fine(folder.write(
        "a.msh",
        std::string("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
                    "$PhysicalNames\n1\n3 1 \"body of work\"\n$EndPhysicalNames\n")
            + kNodes22
            + "$Elements\n4\n1 15 2 0 1 1\n2 1 2 0 1 1 2\n3 2 3 0 1 7 1 3 2\n"
              "4 4 0 1 2 3 4\n$EndElements\n"));
    EXPECT_TRUE(test::same_points(mesh.x, test::corner_tet().x));
    EXPECT_EQ(mesh.segments, (std::vector<Int2>{{0, 1}}));
    EXPECT_EQ(mesh.triangles, (std::vector<Int3>{{0, 2, 1}}));
    EXPECT_EQ(mesh.tets, (std::vector<Int4>{{0, 1, 2, 3}}));
}

TEST(MshReader, Reads41AsciiWithSeveralBlocksAndParametricNodes) {
    const TempFolder folder;
    const Mesh mesh = read_fine(folder.write(
        "a.msh",
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
        "$Entities\n0 0 0 1\n1 0 0 0 1 1 1 0 0\n$EndEntities\n"
        "$Nodes\n3 4 1 4\n"
        "0 1 0 1\n1\n0 0 0\n"
        "2 1 1 2\n2\n3\n1 0 0 0.5 0.25\n0 1 0 0.5 0.75\n"
        "3 1 0 1\n4\n0 0 1\n$EndNodes\n"
        "$Elements\n2 2 1 2\n2 1 2 1\n1 1 3 2\n3 1 4 1\n2 1 2 3 4\n$EndElements\n"
        "$Periodic\n0\n$EndPeriodic\n"));
    test::expect_same(mesh, {test::corner_tet().x, {{0, 1, 2, 3}}, {{0, 2, 1}}, {}});
}

TEST(MshReader, Reads40Ascii) {
    const TempFolder folder;
    const Mesh mesh =
        read_fine(folder.write("a.msh",
                               "$MeshFormat\n4 0 8\n$EndMeshFormat\n$Nodes\n2 4\n1 3 0 "
                               "3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n"
                               "1 2 1 1\n4 0 0 1 0.1 0.2\n$EndNodes\n$Elements\n1 1\n1 3 "
                               "4 1\n1 1 2 3 4\n$EndElements\n"));
    test::expect_same(mesh, test::corner_tet());
}

TEST(MshReader, RenumbersSparseAndLargeTags) {
    const TempFolder folder;
    for (const std::string big : {"70", "9000000000000"}) {
        const Mesh mesh = read_fine(
            folder.write("a.msh",
                         "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 5 " + big
                             + "\n3 1 0 4\n" + big
                             + "\n5\n30\n20\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n"
                               "$Elements\n1 1 1 1\n3 1 4 1\n1 "
                             + big + " 5 30 20\n$EndElements\n"));
        test::expect_same(mesh, test::corner_tet());
    }
}

TEST(MshReader, IgnoresForeignTrailingSections) {
    const TempFolder folder;
    const std::string body = std::string("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n")
                           + kNodes22 + "$Elements\n1\n1 4 0 1 2 3 4\n$EndElements\n";
    for (const char* tail :
         {"$Surface\n1\n1 2 3\n$EndSurface\n", "$Surface\n1\n1 2 3\n", "\r\n\r\n"})
        test::expect_same(read_fine(folder.write("a.msh", body + tail)),
                          test::corner_tet());
}

TEST(MshReader, PassesOverSectionsBeforeTheFormat) {
    const TempFolder folder;
    const std::string body = std::string("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n")
                           + kNodes22 + "$Elements\n1\n1 4 0 1 2 3 4\n$EndElements\n";
    test::expect_same(
        read_fine(folder.write("a.msh", "$Comments\nby $hand\n$EndComments\n" + body)),
        test::corner_tet());
}

TEST(MshReader, AcceptsWindowsLineEndsAndByteOrderMark) {
    const TempFolder folder;
    std::string text = std::string("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n") + kNodes22
                     + "$Elements\n1\n1 4 0 1 2 3 4\n$EndElements\n";
    for (std::size_t i = 0; (i = text.find('\n', i)) != std::string::npos; i += 2)
        text.replace(i, 1, "\r\n");
    test::expect_same(read_fine(folder.write("a.msh", "\xEF\xBB\xBF" + text)),
                      test::corner_tet());
}

template <class Size>
std::string binary_41(bool big_endian) {
    Bytes b(big_endian);
    b.text("$MeshFormat\n4.1 1 " + std::to_string(sizeof(Size)) + "\n")
        .put<int>(1)
        .text("\n$EndMeshFormat\n$Nodes\n");
    for (const Size v : {1, 4, 1, 4})
        b.put<Size>(v);
    b.put<int>(3).put<int>(1).put<int>(0).put<Size>(4);
    for (const Size tag : {1, 2, 3, 4})
        b.put<Size>(tag);
    for (const Vec3d& x : test::corner_tet().x)
        b.put(x.x).put(x.y).put(x.z);
    b.text("\n$EndNodes\n$Elements\n");
    for (const Size v : {1, 1, 1, 1})
        b.put<Size>(v);
    b.put<int>(3).put<int>(1).put<int>(4).put<Size>(1);
    for (const Size v : {1, 1, 2, 3, 4})
        b.put<Size>(v);
    return b.text("\n$EndElements\n").out;
}

TEST(MshReader, Reads41BinaryInBothByteOrdersAndSizeWidths) {
    const TempFolder folder;
    for (const bool big_endian : {false, true}) {
        test::expect_same(
            read_fine(folder.write("a.msh", binary_41<std::uint64_t>(big_endian))),
            test::corner_tet());
        test::expect_same(
            read_fine(folder.write("b.msh", binary_41<std::uint32_t>(big_endian))),
            test::corner_tet());
    }
}

TEST(MshReader, Reads40Binary) {
    const TempFolder folder;
    Bytes b;
    b.text("$MeshFormat\n4.0 1 8\n").put<int>(1).text("\n$EndMeshFormat\n$Nodes\n");
    b.put<std::uint64_t>(1)
        .put<std::uint64_t>(4)
        .put<int>(1)
        .put<int>(3)
        .put<int>(0)
        .put<std::uint64_t>(4);
    int tag = 0;
    for (const Vec3d& x : test::corner_tet().x)
        b.put<int>(++tag).put(x.x).put(x.y).put(x.z);
    b.text("\n$EndNodes\n$Elements\n").put<std::uint64_t>(1).put<std::uint64_t>(1);
    b.put<int>(1).put<int>(3).put<int>(4).put<std::uint64_t>(1);
    for (const int v : {1, 1, 2, 3, 4})
        b.put<int>(v);
    test::expect_same(read_fine(folder.write("a.msh", b.text("\n$EndElements\n").out)),
                      test::corner_tet());
}

TEST(MshReader, Reads22BinaryWithRunsOfElementsAndBinaryForeignSection) {
    const TempFolder folder;
    Bytes b;
    b.text("$MeshFormat\n2.2 1 8\n").put<int>(1).text("\n$EndMeshFormat\n");
    b.text("$Foreign\n")
        .put<int>(0x0a240a24)
        .put<double>(1.5)
        .text("\n$EndForeign\n$Nodes\n4\n");
    int tag = 0;
    for (const Vec3d& x : test::corner_tet().x)
        b.put<int>(++tag).put(x.x).put(x.y).put(x.z);
    b.text("\n$EndNodes\n$Elements\n3\n");
    b.put<int>(2).put<int>(2).put<int>(1);  // two triangles with one tag each
    for (const int v : {1, 99, 1, 3, 2, 2, 99, 1, 2, 4})
        b.put<int>(v);
    b.put<int>(4).put<int>(1).put<int>(0);
    for (const int v : {3, 1, 2, 3, 4})
        b.put<int>(v);
    test::expect_same(read_fine(folder.write("a.msh", b.text("\n$EndElements\n").out)),
                      {test::corner_tet().x, {{0, 1, 2, 3}}, {{0, 2, 1}, {0, 1, 3}}, {}});
}

TEST(MshReader, KeepsEveryDigitAndReadsSubnormals) {
    const TempFolder folder;
    const Mesh mesh = read_fine(folder.write(
        "a.msh",
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n"
        "1 0.1 +2.5 1e-320\n2 0.30000000000000004 1E3 1e-400\n"
        "3 9007199254740993 -0.0 .5\n4 5. 1e22 123456789.12345678\n$EndNodes\n"
        "$Elements\n1\n1 4 0 1 2 3 4\n$EndElements\n"));
    ASSERT_EQ(mesh.x.size(), 4U);
    EXPECT_EQ(mesh.x[0].x, 0.1);
    EXPECT_EQ(mesh.x[0].y, 2.5);
    EXPECT_EQ(mesh.x[0].z, 1e-320);
    EXPECT_EQ(mesh.x[1].x, 0.1 + 0.2);
    EXPECT_EQ(mesh.x[1].z, 0.0);
    EXPECT_EQ(mesh.x[2].x, 9007199254740992.0);
    EXPECT_EQ(mesh.x[3].x, 5.0);
    EXPECT_EQ(mesh.x[3].z, 123456789.12345678);
}

}  // namespace
}  // namespace noli
