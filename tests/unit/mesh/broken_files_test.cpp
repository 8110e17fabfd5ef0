// SPDX-License-Identifier: Apache-2.0
/// Every broken file gives an error that names the file, the place in it, what was found
/// and a cure.
#include "mesh/check.hpp"
#include "mesh/generate.hpp"
#include "mesh/write.hpp"
#include "unit/mesh/test_files.hpp"

#include <random>

namespace noli {
namespace {

using test::Bytes;
using test::TempFolder;

struct BrokenFile {
    const char* name;  // of the case
    const char* file;  // its extension picks the reader
    std::string bytes;
    const char* place;                 // in Error::where, behind the folder
    std::vector<const char*> message;  // parts: what was found, expected, the cure
    MeshRole role = MeshRole::Solid;
};

std::string msh22(const std::string& nodes, const std::string& elements) {
    return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" + nodes
         + "$EndNodes\n$Elements\n" + elements + "$EndElements\n";
}

const std::string kFourNodes = "4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n";
const std::string kOneTet = "1\n1 4 0 1 2 3 4\n";

std::string binary_msh(bool truncated) {
    const TempFolder folder;
    EXPECT_FALSE(write_mesh(folder / "a.msh", test::corner_tet(), {.binary = true}));
    std::ifstream in(folder / "a.msh", std::ios::binary);
    std::string bytes((std::istreambuf_iterator<char>(in)), {});
    if (truncated) bytes.resize(bytes.find("$Nodes") + 90);
    return bytes;
}

std::string binary_stl(std::uint32_t announced, std::size_t size) {
    Bytes b;
    b.text(std::string(80, ' ')).put(announced);
    b.out.resize(size, '\0');
    return b.out;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

// One case per line reads best here.
// clang-format off
std::vector<BrokenFile> broken_msh() {
    const std::string fine = msh22(kFourNodes, kOneTet);
    const std::string v41 =
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 "
        "0\n1 0 0\n0 1 0\n"
        "0 0 1\n$EndNodes\n$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n";
    return {
        {"empty", "a.msh", "", "a.msh:1", {"$MeshFormat", "check its extension"}},
        {"garbage", "a.msh", "\x01\x02\xff garbage", "a.msh:1", {"???", "expected \"$MeshFormat\""}},
        {"version 1", "a.msh", "$NOD\n1\n", "a.msh:1", {"version 1", "msh41"}},
        {"unknown version", "a.msh", "$MeshFormat\n5.0 0 8\n", "a.msh:2", {"\"5.0\"", "2.2, 4.0 or 4.1", "msh41"}},
        {"bad file type", "a.msh", "$MeshFormat\n4.1 7 8\n", "a.msh:2", {"file type 7", "write the file again"}},
        {"bad data size", "a.msh", "$MeshFormat\n2.2 0 4\n", "a.msh:2", {"data size 4", "double precision"}},
        {"header cut", "a.msh", "$MeshFormat\n4.1 0", "a.msh:2", {"data size", "truncated"}},
        {"ASCII under a binary flag", "a.msh", replaced(v41, "4.1 0 8", "4.1 1 8"), "a.msh (byte", {"binary number 1", "set it to 0"}},
        {"binary under an ASCII flag", "a.msh", replaced(binary_msh(false), "4.1 1 8", "4.1 0 8"), "a.msh:3", {"$EndMeshFormat", "binary under an ASCII flag"}},
        {"binary cut", "a.msh", binary_msh(true), "a.msh (byte", {"4 nodes", "hold at most 2", "truncated"}},
        {"only a header", "a.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n", "a.msh:4", {"$Nodes", "write it again"}},
        {"nodes cut", "a.msh", fine.substr(0, fine.find("3 0 1")), "a.msh:", {"4 nodes", "hold at most 2", "truncated"}},
        {"elements missing", "a.msh", fine.substr(0, fine.find("$Elements")), "a.msh:", {"$Elements", "truncated"}},
        {"absurd node count", "a.msh", replaced(fine, "4\n1 0", "4000000000\n1 0"), "a.msh:5", {"4000000000 nodes", "hold at most", "count is wrong"}},
        {"node count too large by one", "a.msh", replaced(fine, "4\n1 0", "5\n1 0"), "a.msh:10", {"$EndNodes", "whole number"}},
        {"node count too small", "a.msh", replaced(fine, "4\n1 0", "3\n1 0"), "a.msh:9", {"expected \"$EndNodes\"", "count in this section"}},
        {"negative count", "a.msh", replaced(fine, "4\n1 0", "-4\n1 0"), "a.msh:5", {"-4", "0 or more"}},
        {"absurd element count", "a.msh", replaced(v41, "1 1 1 1\n", "1 99999999999 1 1\n"), "a.msh:17", {"99999999999 elements", "truncated"}},
        {"absurd block count", "a.msh", replaced(v41, "$Nodes\n1 4", "$Nodes\n9999999999999 4"), "a.msh:15", {"$EndNodes", "whole number"}},
        {"nan coordinate", "a.msh", replaced(fine, "3 0 1 0", "3 0 nan 0"), "a.msh:8", {"y coordinate", "\"nan\"", "finite"}},
        {"infinite coordinate", "a.msh", replaced(fine, "3 0 1 0", "3 -1e999 1 0"), "a.msh:8", {"\"-1e999\"", "finite", "remove this point"}},
        {"word as a coordinate", "a.msh", replaced(fine, "3 0 1 0", "3 0 one 0"), "a.msh:8", {"\"one\"", "expected a number"}},
        {"node 0", "a.msh", replaced(fine, "1 2 3 4\n$EndE", "0 2 3 4\n$EndE"), "a.msh:13", {"element 1 uses node 0", "correct the element"}},
        {"node out of range", "a.msh", replaced(fine, "1 2 3 4\n$EndE", "1 2 3 9\n$EndE"), "a.msh:13", {"uses node 9", "4 nodes"}},
        {"same tag twice", "a.msh", replaced(fine, "3 0 1 0", "2 0 1 0"), "a.msh:10", {"node tag 2 occurs twice", "renumber"}},
        {"elements first", "a.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Elements\n0\n", "a.msh:4", {"before $Nodes"}},
        {"nodes twice", "a.msh", replaced(fine, "$Elements", "$Nodes\n0\n$EndNodes\n$Elements"), "a.msh:11", {"second $Nodes", "merge"}},
        {"second order", "a.msh", msh22(kFourNodes, "1\n1 11 0 1 2 3 4 1 2 3 4 1 2\n"), "a.msh:13", {"second-order tetrahedra", "-order 1"}},
        {"hexahedron", "a.msh", msh22(kFourNodes, "1\n1 5 0 1 2 3 4 1 2 3 4\n"), "a.msh:13", {"8-node hexahedra", "tetrahedra"}},
        {"impossible type", "a.msh", msh22(kFourNodes, "1\n1 -3 0 1 2 3 4\n"), "a.msh:13", {"element type -3", "damaged"}},
        {"text between sections", "a.msh", replaced(fine, "$Elements", "hello\n$Elements"), "a.msh:11", {"\"hello\"", "between sections"}},
        {"section without end", "a.msh", replaced(fine, "$Nodes", "$Foreign\n1 2 3\n$Nodes"), "a.msh:4", {"$EndForeign", "truncated"}},
        {"inverted", "a.msh", replaced(fine, "1 2 3 4\n$EndE", "1 3 2 4\n$EndE"), "a.msh", {"1 inverted tetrahedra (first: 0)", "\"fix_orientation\": true"}},
        {"degenerate", "a.msh", replaced(fine, "4 0 0 1\n", "4 0.5 0.5 0\n"), "a.msh", {"1 degenerate tetrahedra (first: 0", "longest edge 1.41", "mesh again"}},
        {"repeated vertex", "a.msh", replaced(fine, "1 2 3 4\n$EndE", "1 2 3 3\n$EndE"), "a.msh", {"tetrahedron 0 uses a vertex twice", "remove"}},
        {"doubled element", "a.msh", msh22(kFourNodes, "2\n1 4 0 1 2 3 4\n2 4 0 2 3 1 4\n"), "a.msh", {"doubled elements (first: tetrahedron 1", "remove the copies"}},
        {"surface as a body", "a.msh", msh22(kFourNodes, "1\n1 2 0 1 2 3\n"), "a.msh", {"0 tetrahedra, 1 triangles", "mesh its inside"}},
        {"no elements", "a.msh", msh22("0\n", "0\n"), "a.msh", {"0 vertices", "expected tetrahedra"}},
    };
}

std::vector<BrokenFile> broken_others() {
    return {
        {"MEDIT: other format", "a.mesh", "MFEM mesh v1.0\n", "a.mesh:1", {"\"MFEM\"", "MeshVersionFormatted", "convert"}},
        {"MEDIT: 2D", "a.mesh", "MeshVersionFormatted 2 Dimension 2", "a.mesh:1", {"dimension 2", "expected 3"}},
        {"MEDIT: index 0", "a.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices 1\n0 0 0 0\nEdges 1\n0 1 0\n", "a.mesh:6", {"uses vertex 0", "1 to 1"}},
        {"MEDIT: absurd count", "a.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices 123456789\n0 0 0 0\n", "a.mesh:3", {"123456789 vertices"}},
        {"MEDIT: cut", "a.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices 2\n0 0 0 0 1 0 2e0", "a.mesh:4", {"truncated"}},
        {"MEDIT: hexahedra", "a.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices 1\n0 0 0 0\nHexahedra 1\n", "a.mesh:5", {"Hexahedra", "split"}},
        {"MEDIT: no vertices", "a.mesh", "MeshVersionFormatted 2\nDimension 3\nEnd\n", "a.mesh:3", {"no Vertices section"}},
        {"MEDIT: count too small", "a.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices 1\n0 0 0 0\n1 1 1 0\n", "a.mesh:5", {"where a keyword", "count before it"}},
        {"OBJ: empty", "a.obj", "", "a.obj:1", {"no \"v x y z\" line", "write the file again"}, MeshRole::Surface},
        {"OBJ: garbage", "a.obj", "v 0 0 0\n\xfe\xed\n", "a.obj:2", {"\"??\"", "OBJ keyword"}, MeshRole::Surface},
        {"OBJ: index 0", "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "a.obj:4", {"vertex number 0", "1 or more"}, MeshRole::Surface},
        {"OBJ: index too large", "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n", "a.obj:5", {"vertex 4", "1 to 3", "correct the line"}, MeshRole::Surface},
        {"OBJ: index too negative", "a.obj", "v 0 0 0\nv 1 0 0\nf -1 -2 -3\n", "a.obj:3", {"vertex number -3", "-1 to -2"}, MeshRole::Surface},
        {"OBJ: index beyond an int", "a.obj", "v 0 0 0\nf 1 1 99999999999\n", "a.obj:2", {"99999999999"}, MeshRole::Surface},
        {"OBJ: short vertex", "a.obj", "v 0 0\nf 1 1 1\n", "a.obj:1", {"line ends where the z coordinate"}, MeshRole::Surface},
        {"OBJ: face with two corners", "a.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n", "a.obj:3", {"2 corners", "3 or more"}, MeshRole::Surface},
        {"OBJ: three triangles at an edge", "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nf 1 2 3\nf 2 1 4\nf 1 2 5\n", "a.obj", {"1 non-manifold edges", "vertices 0 and 1", "allow_non_manifold"}, MeshRole::Surface},
        {"OBJ: triangle without area", "a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "a.obj", {"1 degenerate triangles (first: 0)", "without area"}, MeshRole::Surface},
        {"PLY: no magic", "a.ply", "plx\n", "a.ply:1", {"\"plx\"", "check its extension"}, MeshRole::Surface},
        {"PLY: format", "a.ply", "ply\nformat text 1.0\n", "a.ply:2", {"\"text\"", "binary_little_endian"}, MeshRole::Surface},
        {"PLY: no format", "a.ply", "ply\nelement vertex 0\nend_header\n", "a.ply:3", {"without a format line", "format ascii 1.0"}, MeshRole::Surface},
        {"PLY: two formats", "a.ply", "ply\nformat ascii 1.0\nformat ascii 1.0\n", "a.ply:3", {"second format line", "remove"}, MeshRole::Surface},
        {"PLY: header cut", "a.ply", "ply\nformat ascii 1.0\nelement vertex 3\n", "a.ply:", {"end_header", "truncated"}, MeshRole::Surface},
        {"PLY: no z", "a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float " "y\nend_header\n0 0\n", "a.ply:6", {"no property z", "correct the header"}, MeshRole::Surface},
        {"PLY: unknown type", "a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\n", "a.ply:4", {"\"half\"", "float or"}, MeshRole::Surface},
        {"PLY: absurd count", "a.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 99999999\nproperty double " "x\nproperty double y\nproperty double z\nend_header\n", "a.ply (byte", {"99999999 vertex", "truncated"}, MeshRole::Surface},
        {"PLY: index out of range", "a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float " "y\nproperty float z\nelement face 1\nproperty list uchar int " "vertex_indices\nend_header\n0 0 0\n3 0 0 1\n", "a.ply", {"face 0", "uses vertex 1", "0 to 0"}, MeshRole::Surface},
        {"PLY: negative index", "a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float " "y\nproperty float z\nelement face 1\nproperty list uchar int " "vertex_indices\nend_header\n0 0 0\n3 0 0 -1\n", "a.ply", {"face 0", "impossible number"}, MeshRole::Surface},
        {"PLY: absurd list", "a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float " "y\nproperty float z\nelement face 1\nproperty list uint int " "vertex_indices\nend_header\n0 0 0\n3999999999 0 0 0\n", "a.ply:11", {"3999999999 entries"}, MeshRole::Surface},
        {"STL: garbage", "a.stl", "hello", "a.stl (byte 0)", {"80-byte header", "truncated"}, MeshRole::Surface},
        {"STL: cut", "a.stl", binary_stl(2, 84 + 60), "a.stl (byte 80)", {"2 triangles", "at most 1", "truncated"}, MeshRole::Surface},
        {"STL: absurd count", "a.stl", binary_stl(0xffffffffU, 200), "a.stl (byte 80)", {"4294967295 triangles"}, MeshRole::Surface},
        {"STL: ASCII cut", "a.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0", "a.stl:4", {"z coordinate", "truncated"}, MeshRole::Surface},
        {"STL: wrong word", "a.stl", "solid a\nfacet normal 0 0 1\nouter ring\n", "a.stl:3", {"\"ring\"", "\"loop\""}, MeshRole::Surface},
        {"STL: no triangles", "a.stl", "solid a\nendsolid a\n", "a.stl", {"expected triangles"}, MeshRole::Surface},
        {"seg: index too large", "a.seg", "v 0 0 0\ns 1 3\nv 1 0 0\n", "a.seg:2", {"vertex 3", "1 to 2", "add the missing"}, MeshRole::Segments},
        {"seg: index 0", "a.seg", "v 0 0 0\ns 0 1\nv 1 0 0\n", "a.seg:2", {"vertex 0", "1 or more"}, MeshRole::Segments},
        {"seg: empty and no obj", "a.seg", "", "a.seg:1", {"\"v x y z\"", "a.obj"}, MeshRole::Segments},
        {"seg: zero length", "a.seg", "v 0 0 0\nv 0 0 0\ns 1 2\n", "a.seg", {"length 0 (first: 0)", "remove"}, MeshRole::Segments},
        {"seg: unknown line", "a.seg", "v 0 0 0\nq 1 2\n", "a.seg:2", {"\"q\"", "\"s i j\""}, MeshRole::Segments},
        {"pt: word", "a.pt", "v 0 x 0\n", "a.pt:1", {"\"x\"", "expected a number"}, MeshRole::Points},
        {"unknown extension", "a.step", "ISO-10303-21;", "a.step", {"\".step\"", ".msh", "convert"}},
    };
}
// clang-format on

void expect_error(const BrokenFile& c,
                  const std::string& path,
                  const std::string& folder) {
    SCOPED_TRACE(c.name);
    Result<Mesh> mesh = read_mesh(path);
    if (mesh) mesh = checked(std::move(mesh.value()), path, c.role);
    ASSERT_FALSE(mesh);
    const Error& error = mesh.error();
    EXPECT_EQ(error.where.rfind(folder + "/" + c.place, 0), 0U)
        << error.where << ": " << error.message;
    for (const char* part : c.message)
        EXPECT_NE(error.message.find(part), std::string::npos)
            << part << "\nin: " << error.where << ": " << error.message;
    EXPECT_TRUE(error.message.find("; ") != std::string::npos
                || error.message.find(": ") != std::string::npos)
        << "no cure in: " << error.message;
}

TEST(BrokenMesh, EveryFileNamesPlaceCauseAndCure) {
    std::vector<BrokenFile> cases = broken_msh();
    for (BrokenFile& c : broken_others())
        cases.push_back(std::move(c));
    EXPECT_GE(cases.size(), 75U);
    for (const BrokenFile& c : cases) {
        const TempFolder folder;
        expect_error(c, folder.write(c.file, c.bytes), folder.path());
    }
}

TEST(BrokenMesh, TetgenFilesNamePlaceCauseAndCure) {
    struct Case {
        const char *name, *node, *ele, *place;
        std::vector<const char*> message;
    };
    const char* fine = "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n";
    const Case cases[] = {
        {"no points", "", "1 4 0\n", "a.node:1", {"<points>", "truncated"}},
        {"2D", "4 2 0 0\n", "1 4 0\n", "a.node:1", {"dimension \"2\"", "expected 3"}},
        {"cut",
         "4 3 0 0\n1 0 0 0\n2 1 0 0\n      #          \n",
         "1 4 0\n",
         "a.node:5",
         {"a point", "truncated"}},
        {"gap",
         "2 3 0 0\n1 0 0 0\n3 1 0 0\n",
         "1 4 0\n",
         "a.node:3",
         {"point number 3", "expected 2"}},
        {"short line",
         "2 3 0 0\n1 0 0 0\n2 1 0\n",
         "1 4 0\n",
         "a.node:3",
         {"line ends", "z coordinate"}},
        {"absurd",
         "99999999 3 0 0\n1 0 0 0\n",
         "1 4 0\n",
         "a.node:1",
         {"99999999 points"}},
        {"second order",
         fine,
         "1 10 0\n1 1 2 3 4 1 2 3 4 1 2\n",
         "a.ele:1",
         {"10 nodes", "-o2"}},
        {"out of range",
         fine,
         "1 4 0\n1 1 2 3 5\n",
         "a.ele:2",
         {"uses point 5", "1 to 4", "belong together"}},
        {"zero in a file from one",
         fine,
         "1 4 0\n1 0 1 2 3\n",
         "a.ele:2",
         {"uses point 0", "1 to 4"}},
        {"elements cut",
         fine,
         "2 4 0\n1 1 2 3 4\n      \n",
         "a.ele:4",
         {"a tetrahedron", "truncated"}},
    };
    for (const Case& c : cases) {
        SCOPED_TRACE(c.name);
        const TempFolder folder;
        folder.write("a.node", c.node);
        const Result<Mesh> mesh = read_mesh(folder.write("a.ele", c.ele));
        ASSERT_FALSE(mesh);
        EXPECT_NE(mesh.error().where.find(c.place), std::string::npos)
            << mesh.error().where;
        for (const char* part : c.message)
            EXPECT_NE(mesh.error().message.find(part), std::string::npos)
                << mesh.error().message;
    }
}

TEST(BrokenMesh, MissingFilesAndFoldersAreNamed) {
    const TempFolder folder;
    std::filesystem::create_directory(folder / "d.msh");
    folder.write("half.node", "1 3 0 0\n1 0 0 0\n");
    struct Case {
        const char *file, *where, *message;
    };
    for (const Case& c :
         {Case{"none.msh", "none.msh", "no such file; check the path"},
          Case{"none", "none.node", "no such file"},
          Case{"half.ele", "half.ele", "no such file"},
          Case{"none.pt", "none.pt", "no such file"},
          Case{"none.seg", "none.seg", "no such file"},
          Case{
              "d.msh", "d.msh", "directory, expected a mesh file; name a file inside"}}) {
        const Result<Mesh> mesh = read_mesh(folder / c.file);
        ASSERT_FALSE(mesh) << c.file;
        EXPECT_EQ(mesh.error().code, Error::Code::FileNotReadable);
        EXPECT_NE(mesh.error().where.find(c.where), std::string::npos)
            << mesh.error().where;
        EXPECT_NE(mesh.error().message.find(c.message), std::string::npos)
            << mesh.error().message;
    }
}

TEST(BrokenMesh, NothingIsReadFromDevices) {
    if (!std::filesystem::exists("/dev/zero"))
        GTEST_SKIP() << "this system has no /dev/zero";
    const TempFolder folder;
    std::filesystem::create_symlink("/dev/zero", folder / "a.msh");
    const Result<Mesh> mesh = read_mesh(folder / "a.msh");
    ASSERT_FALSE(mesh);
    EXPECT_NE(mesh.error().message.find("regular file"), std::string::npos);
}

/// Cuts and random changes of fine files: an answer or an error with a place, never a
/// crash.
TEST(BrokenMesh, DamagedFilesNeverCrash) {
    const TempFolder folder;
    const Mesh solid = make_box({.nx = 2, .ny = 2, .nz = 1}).value();
    const Mesh surface = make_box_surface().value();
    Mesh ropes{surface.x, {}, {}, {{0, 1}, {1, 2}}};
    struct Source {
        std::string file;
        const Mesh* mesh;
        WriteOptions options;
    };
    const std::vector<Source> sources = {
        {"a.msh", &solid, {}},
        {"b.msh", &solid, {.binary = true}},
        {"c.msh", &solid, {.msh = WriteOptions::Msh::V22}},
        {"d.msh", &solid, {.binary = true, .msh = WriteOptions::Msh::V22}},
        {"e.mesh", &solid, {}},
        {"f.node", &solid, {}},
        {"g.obj", &surface, {}},
        {"h.ply", &surface, {}},
        {"i.ply", &surface, {.binary = true}},
        {"j.stl", &surface, {}},
        {"k.seg", &ropes, {}}};
    std::mt19937 random(5);
    int errors = 0;
    for (const Source& source : sources) {
        ASSERT_FALSE(write_mesh(folder / source.file, *source.mesh, source.options))
            << source.file;
        std::ifstream in(folder / source.file, std::ios::binary);
        const std::string fine((std::istreambuf_iterator<char>(in)), {});
        for (int trial = 0; trial < 300; ++trial) {
            std::string bytes = fine;
            if (trial % 3 == 0) bytes.resize(random() % bytes.size());
            for (unsigned k = trial % 3 == 0 ? 0 : 1 + random() % 8; k > 0; --k) {
                constexpr char kLikely[] = "0123456789-+.e$ \n\xff\x7f#/";
                const char c = trial % 3 == 1 ? kLikely[random() % (sizeof(kLikely) - 1)]
                                              : static_cast<char>(random());
                bytes[random() % bytes.size()] = c;
            }
            Result<Mesh> mesh = read_mesh(folder.write(source.file, bytes));
            if (mesh)
                mesh = checked(mesh.value(), source.file, natural_role(mesh.value()));
            if (mesh) continue;
            ++errors;
            EXPECT_FALSE(mesh.error().where.empty());
            EXPECT_FALSE(mesh.error().message.empty());
        }
    }
    EXPECT_GT(errors, 1000);
}

}  // namespace
}  // namespace noli
