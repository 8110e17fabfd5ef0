// SPDX-License-Identifier: Apache-2.0
/// Handwritten files of each dialect other than MSH.
#include "unit/mesh/test_files.hpp"

namespace noli {
namespace {

using test::Bytes;
using test::read_fine;
using test::TempFolder;

TEST(TetgenReader, ReadsOneBasedFilesByAnyOfTheirNames) {
    const TempFolder folder;
    folder.write("ball.node",
                 "# made by hand\n4 3 1 1\n1 0 0 0 7.5 1 # first\n2 1 0 0 7.5 1\n\n3 0 1 "
                 "0 7.5 0\n4 0 0 1 7.5 1\n");
    folder.write("ball.ele", "1 4 1\n  1  1 2 3 4  42\n# end\n");
    for (const char* name : {"ball", "ball.node", "ball.ele"})
        test::expect_same(read_fine(folder / name), test::corner_tet());
}

TEST(TetgenReader, ReadsZeroBasedFilesAndNumberedNames) {
    const TempFolder folder;
    folder.write("ball.1.node", "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n");
    folder.write("ball.1.ele", "1 4 0\n0 0 1 2 3\n");
    for (const char* name : {"ball.1", "ball.1.node", "ball.1.ele"})
        test::expect_same(read_fine(folder / name), test::corner_tet());
}

TEST(TetgenReader, RefusesHalfAPairByNameAndWithTheCure) {
    const TempFolder folder;
    folder.write("a.node", "2 3 0 0\n1 0 0 0\n2 1 2 3\n");
    folder.write("b.ele", "1 4 0\n1 1 2 3 4\n");
    struct Case {
        const char *file, *missing, *holds;
    };
    for (const Case& c : {Case{"a.node", "a.ele", "the tetrahedra that belong to a.node"},
                          Case{"a", "a.ele", "the tetrahedra that belong to a.node"},
                          Case{"b.ele", "b.node", "the points that belong to b.ele"},
                          Case{"b", "b.node", "the points that belong to b.ele"}}) {
        SCOPED_TRACE(c.file);
        const Result<Mesh> mesh = read_mesh(folder / c.file);
        ASSERT_FALSE(mesh);
        EXPECT_EQ(mesh.error().code, Error::Code::FileNotReadable);
        EXPECT_EQ(mesh.error().where, folder / c.missing);
        for (const char* part : {c.holds, "put it beside that file", ".pt"})
            EXPECT_NE(mesh.error().message.find(part), std::string::npos)
                << mesh.error().message;
    }
}

TEST(TetgenReader, FindsThePartnerInUpperCase) {
    const TempFolder folder;
    folder.write("BALL.NODE", "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n");
    folder.write("BALL.ELE", "1 4 0\n0 0 1 2 3\n");
    for (const char* name : {"BALL", "BALL.NODE", "BALL.ELE"})
        test::expect_same(read_fine(folder / name), test::corner_tet());
}

TEST(MeditReader, ReadsAllElementsAndSkipsOtherSections) {
    const TempFolder folder;
    const Mesh mesh = read_fine(
        folder.write("a.mesh",
                     "MeshVersionFormatted 2\n# comment\nDimension\n3\nVertices 4\n"
                     "0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 2.0\nCorners\n2\n1\n2\n"
                     "Normals\n1\n-1.5 .5 0\nQuadrilaterals 0\nEdges\n1\n1 2 5\n"
                     "Triangles\n1\n1 3 2 5\nTetrahedra\n1\n1 2 3 4 9\nEnd\n"));
    test::expect_same(mesh,
                      {test::corner_tet().x, {{0, 1, 2, 3}}, {{0, 2, 1}}, {{0, 1}}});
}

TEST(MeditReader, ReadsSectionsInAnyOrder) {
    const TempFolder folder;
    const std::string head = "MeshVersionFormatted 2\n";
    const std::string tets = "Tetrahedra\n1\n1 2 3 4 9\n";
    const std::string points = "Vertices 4\n0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 1\n";
    test::expect_same(
        read_fine(folder.write("a.mesh", head + tets + points + "Dimension 3\nEnd\n")),
        test::corner_tet());
    const Result<Mesh> wrong = read_mesh(folder.write(
        "b.mesh", head + tets + "Vertices 3\n0 0 0 1\n1 0 0 1\n0 1 0 1\nEnd\n"));
    ASSERT_FALSE(wrong);
    EXPECT_NE(wrong.error().message.find("tetrahedra uses vertex 4, expected 1 to 3"),
              std::string::npos)
        << wrong.error().message;
}

TEST(MeditReader, NeedsNoEndKeyword) {
    const TempFolder folder;
    const Mesh mesh =
        read_fine(folder.write("A.MESH",
                               "MeshVersionFormatted 1 Dimension 3 Vertices 3 0 0 0 0 1 "
                               "0 0 0 0 1 0 0 Triangles 1 1 2 3 0"));
    EXPECT_EQ(mesh.triangles, (std::vector<Int3>{{0, 1, 2}}));
}

TEST(ObjReader, ReadsAllFormsOfIndices) {
    const TempFolder folder;
    const Mesh mesh = read_fine(folder.write(
        "a.obj",
        "# box\nmtllib a.mtl\no part\nf 1 2 3\nv 0 0 0 1.0\nv 1 0 0 0.5 0.5 0.5\n"
        "v 0 1 0\nv 0 0 1\nvt 0 0\nvn 0 0 1\ng a b\nusemtl red\ns off\n"
        "f 1/1 2/1 3/1\nf 1/1/1 3/1/1 4/1/1\nf 1//1 4//1 2//1\nf -3 -2 -1\n"
        "l 1 2 \\\n  3\np 1\n"));
    EXPECT_EQ(mesh.x.size(), 4U);
    EXPECT_EQ(mesh.triangles,
              (std::vector<Int3>{{0, 1, 2}, {0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 2, 3}}));
    EXPECT_EQ(mesh.segments, (std::vector<Int2>{{0, 1}, {1, 2}}));
    EXPECT_EQ(mesh.points, (std::vector<int>{0}));
}

double area_along_z(const Mesh& mesh, double& smallest) {
    double sum = 0;
    smallest = 1e300;
    for (const Int3& t : mesh.triangles) {
        const auto at = [&](int k) { return mesh.x[static_cast<std::size_t>(t[k])]; };
        const double area = 0.5 * cross(at(1) - at(0), at(2) - at(0)).z;
        sum += area;
        smallest = std::min(smallest, area);
    }
    return sum;
}

TEST(ObjReader, CutsQuadsAlongTheGoodDiagonal) {
    const TempFolder folder;
    double smallest = 0;
    // An arrowhead whose dent is corner 2: only the diagonal from it stays inside.
    const Mesh dart = read_fine(
        folder.write("a.obj", "v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nf 1 2 3 4\n"));
    EXPECT_EQ(dart.triangles.size(), 2U);
    EXPECT_DOUBLE_EQ(area_along_z(dart, smallest), 4.0);
    EXPECT_GT(smallest, 0.0);
    const Mesh dart2 = read_fine(
        folder.write("a.obj", "v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nf 2 3 4 1\n"));
    EXPECT_DOUBLE_EQ(area_along_z(dart2, smallest), 4.0);
    EXPECT_GT(smallest, 0.0);
    const Mesh kite = read_fine(
        folder.write("a.obj", "v 0 0 0\nv 2 -1 0\nv 9 0 0\nv 2 1 0\nf 1 2 3 4\n"));
    for (const Int3& t : kite.triangles)  // the short diagonal joins corners 1 and 3
        EXPECT_EQ(std::count(t.v, t.v + 3, 1) + std::count(t.v, t.v + 3, 3), 2);
}

TEST(ObjReader, CutsConcavePolygonsInside) {
    const TempFolder folder;
    const Mesh comb = read_fine(folder.write(
        "a.obj",
        "v 0 0 0\nv 5 0 0\nv 5 3 0\nv 4 3 0\nv 4 1 0\nv 3 1 0\nv 3 3 0\nv 2 3 0\n"
        "v 2 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\nf 1 2 3 4 5 6 7 8 9 10 11 12\n"));
    double smallest = 0;
    EXPECT_EQ(comb.triangles.size(), 10U);
    EXPECT_DOUBLE_EQ(area_along_z(comb, smallest), 11.0);
    EXPECT_GE(smallest, 0.0);
}

TEST(ObjReader, MakesAFanOfHugePolygons) {
    const TempFolder folder;
    std::string text, face = "f";
    for (int i = 0; i < 3000; ++i) {
        const double a = 2.0 * 3.141592653589793 * i / 3000;
        text += "v " + std::to_string(std::cos(a)) + " " + std::to_string(std::sin(a))
              + " 0\n";
        face += " " + std::to_string(i + 1);
    }
    EXPECT_EQ(read_fine(folder.write("a.obj", text + face + "\n")).triangles.size(),
              2998U);
}

constexpr const char* kPlyHeader =
    "comment made by hand\nobj_info none\nelement vertex 4\nproperty double x\nproperty "
    "uchar red\nproperty float y\n"
    "property list uchar short extra\nproperty double z\nelement face 2\nproperty uchar "
    "flag\n"
    "property list uchar int vertex_indices\nelement edge 1\nproperty int "
    "vertex1\nproperty int vertex2\n"
    "element other 1\nproperty list int double data\nend_header\n";

const Mesh& ply_mesh() {
    // The quad is cut along its shorter diagonal, from 1 to 3.
    static const Mesh kMesh{{{0, 0, 0.1}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                            {},
                            {{0, 1, 2}, {3, 0, 1}, {1, 2, 3}},
                            {{2, 3}}};
    return kMesh;
}

TEST(PlyReader, ReadsAscii) {
    const TempFolder folder;
    test::expect_same(read_fine(folder.write(
                          "a.ply",
                          std::string("ply\nformat ascii 1.0\n") + kPlyHeader
                              + "0 255 0 0 0.1\n1 255 0 2 7 8 0\n1 9 1 0 0\n0 9 1 0 0\n"
                                "1 3 0 1 2\n1 4 0 1 2 3\n2 3\n2 1.5 nan\n")),
                      ply_mesh());
}

TEST(PlyReader, ReadsHeadersInEveryLegalOrder) {
    const TempFolder folder;
    const std::string elements =
        "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement "
        "face 1\nproperty list uchar int vertex_indices\n";
    const std::string body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    for (const std::string& header :
         {"comment by hand\nformat ascii 1.0\n" + elements,
          "obj_info scanned\ncomment twice\n\nformat ascii 1.0\n" + elements,
          elements + "format ascii 1.0\ncomment last\n"}) {
        SCOPED_TRACE(header);
        const Mesh mesh =
            read_fine(folder.write("a.ply", "ply\n" + header + "end_header\n" + body));
        EXPECT_EQ(mesh.x.size(), 3U);
        EXPECT_EQ(mesh.triangles, (std::vector<Int3>{{0, 1, 2}}));
    }
}

TEST(PlyReader, ReadsBinaryInBothByteOrders) {
    const TempFolder folder;
    for (const bool big : {false, true}) {
        Bytes b(big);
        b.text(std::string("ply\nformat binary_") + (big ? "big" : "little")
               + "_endian 1.0\n" + kPlyHeader);
        for (const Vec3d& x : ply_mesh().x)
            b.put(x.x)
                .put<std::uint8_t>(255)
                .put(static_cast<float>(x.y))
                .put<std::uint8_t>(1)
                .put<short>(-3)
                .put(x.z);
        b.put<std::uint8_t>(1).put<std::uint8_t>(3).put<int>(0).put<int>(1).put<int>(2);
        b.put<std::uint8_t>(1)
            .put<std::uint8_t>(4)
            .put<int>(0)
            .put<int>(1)
            .put<int>(2)
            .put<int>(3);
        b.put<int>(2).put<int>(3).put<int>(1).put<double>(2.5);
        test::expect_same(read_fine(folder.write("a.ply", b.out)), ply_mesh());
    }
}

Bytes binary_stl(const char* header) {
    Bytes b;
    std::string head(header);
    head.resize(80, ' ');
    b.text(head).put<std::uint32_t>(2);
    const float corners[6][3] = {
        {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0.1F}};
    for (int t = 0; t < 2; ++t) {
        for (int k = 0; k < 3; ++k)
            b.put<float>(0);
        for (int c = 0; c < 3; ++c)
            for (int k = 0; k < 3; ++k)
                b.put(corners[3 * t + c][k]);
        b.put<std::uint16_t>(0);
    }
    return b;
}

TEST(StlReader, MergesCornersOfBinaryFilesEvenWithASolidHeader) {
    const TempFolder folder;
    for (const char* header : {"made by hand", "solid but binary"}) {
        const Mesh mesh = read_fine(folder.write("a.stl", binary_stl(header).out));
        EXPECT_EQ(mesh.x.size(), 4U);
        EXPECT_EQ(mesh.triangles, (std::vector<Int3>{{0, 1, 2}, {2, 1, 3}}));
        EXPECT_EQ(mesh.x[3].z, static_cast<double>(0.1F));
    }
}

TEST(StlReader, ReadsAsciiWithSeveralSolidsAndNanNormals) {
    const TempFolder folder;
    const std::string facet =
        "facet normal nan nan nan\n outer loop\n vertex 0 0 0\n vertex 1 0 0\n vertex 0 "
        "-0.0 1.25\n endloop\nendfacet\n";
    const Mesh mesh = read_fine(folder.write(
        "a.stl",
        "solid a b c\n" + facet + "endsolid a b c\nsolid\n" + facet + "endsolid\n"));
    EXPECT_EQ(mesh.x.size(), 3U);
    EXPECT_EQ(mesh.triangles, (std::vector<Int3>{{0, 1, 2}, {0, 1, 2}}));
}

TEST(SegReader, ReadsPointsAndSegments) {
    const TempFolder folder;
    const Mesh mesh = read_fine(
        folder.write("a.seg", "# rope\nv 0 0 0\nv 1 0 0\nv 1 1 0.5\ns 1 2\ns 2 3\n"));
    EXPECT_EQ(mesh.x.size(), 3U);
    EXPECT_EQ(mesh.segments, (std::vector<Int2>{{0, 1}, {1, 2}}));
}

TEST(SegReader, ReadsSegmentsBeforeTheirVertices) {
    const TempFolder folder;
    const Mesh mesh = read_fine(folder.write("a.seg", "s 1 2\nv 0 0 0\nv 1 0 0\n"));
    EXPECT_EQ(mesh.x.size(), 2U);
    EXPECT_EQ(mesh.segments, (std::vector<Int2>{{0, 1}}));
}

TEST(SegReader, FallsBackToTheEdgesOfTheObjIfMissingOrEmpty) {
    const TempFolder folder;
    folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 3 2 4\n");
    const std::vector<Int2> edges{{0, 1}, {0, 2}, {1, 2}, {1, 3}, {2, 3}};
    EXPECT_EQ(read_fine(folder / "a.seg").segments, edges);
    EXPECT_EQ(read_fine(folder.write("a.seg", "\n# nothing\n")).segments, edges);
    EXPECT_FALSE(read_mesh(folder / "a.seg", {.fall_back_to_obj = false}));
}

TEST(PtReader, ReadsPointsAndFallsBackToTheVerticesOfTheObj) {
    const TempFolder folder;
    EXPECT_EQ(read_fine(folder.write("b.pt", "v 1 2 3\nvn 0 0 1\nv 4 5 6\n")).x.size(),
              2U);
    folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const Mesh mesh = read_fine(folder / "a.pt");
    EXPECT_EQ(mesh.x.size(), 3U);
    EXPECT_TRUE(mesh.triangles.empty() && mesh.segments.empty());
}

}  // namespace
}  // namespace noli
