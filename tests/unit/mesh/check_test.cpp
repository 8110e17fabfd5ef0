// SPDX-License-Identifier: Apache-2.0
#include "mesh/check.hpp"

#include "mesh/generate.hpp"
#include "unit/mesh/test_files.hpp"

#include <limits>

namespace noli {
namespace {

using Kind = MeshIssue::Kind;

const MeshIssue* find(const std::vector<MeshIssue>& issues, Kind kind) {
    for (const MeshIssue& issue : issues)
        if (issue.kind == kind) return &issue;
    return nullptr;
}

TEST(CheckMesh, FindsNothingInAFineMesh) {
    const MeshReport report = check_mesh(make_box().value(), MeshRole::Solid);
    EXPECT_TRUE(report.ok());
    EXPECT_TRUE(report.warnings.empty());
    EXPECT_NEAR(report.quality.volume, 1.0, 1e-14);
    EXPECT_NEAR(report.quality.area, 6.0, 1e-14);
}

TEST(CheckMesh, ReportsNanAndInfinityInMemory) {
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
        Mesh mesh = test::corner_tet();
        mesh.x[2].z = bad;
        const MeshReport report = check_mesh(mesh, MeshRole::Solid);
        const MeshIssue* issue = find(report.errors, Kind::NonFinite);
        ASSERT_NE(issue, nullptr);
        EXPECT_EQ(issue->first, 2);
        EXPECT_EQ(issue->count, 1);
    }
}

TEST(CheckMesh, ReportsIndicesOutOfRangeWithoutFollowingThem) {
    for (const int bad :
         {-1, 4, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()}) {
        Mesh mesh = test::corner_tet();
        mesh.tets.push_back({0, 1, 2, bad});
        const MeshReport report = check_mesh(mesh, MeshRole::Solid);
        ASSERT_NE(find(report.errors, Kind::IndexOutOfRange), nullptr);
        EXPECT_EQ(find(report.errors, Kind::IndexOutOfRange)->first, 1);
    }
}

TEST(CheckMesh, MeasuresFlatnessWithoutScale) {
    for (const double scale : {1e-60, 1e-6, 1.0, 1e6, 1e60}) {
        Mesh mesh = test::corner_tet();
        for (Vec3d& x : mesh.x)
            x *= scale;
        EXPECT_TRUE(check_mesh(mesh, MeshRole::Solid).ok()) << scale;
        mesh.x[3] = scale * Vec3d{0.3, 0.3, 1e-12};
        const MeshReport report = check_mesh(mesh, MeshRole::Solid);
        EXPECT_NE(find(report.errors, Kind::Degenerate), nullptr) << scale;
        EXPECT_EQ(find(report.errors, Kind::Inverted), nullptr);
        mesh.x[3] = scale * Vec3d{0.3, 0.3, 1e-5};
        EXPECT_NE(find(check_mesh(mesh, MeshRole::Solid).warnings, Kind::PoorShape),
                  nullptr)
            << scale;
    }
}

TEST(CheckMesh, WarnsOfVerticesThatAreUnusedOrInOnePlace) {
    Mesh mesh = test::corner_tet();
    mesh.x.insert(mesh.x.begin(), {0, 1, -0.0});
    for (int& v : mesh.tets[0].v)
        ++v;
    MeshReport report = check_mesh(mesh, MeshRole::Solid);
    EXPECT_TRUE(report.ok());
    ASSERT_NE(find(report.warnings, Kind::UnreferencedVertex), nullptr);
    EXPECT_EQ(find(report.warnings, Kind::UnreferencedVertex)->first, 0);
    ASSERT_NE(find(report.warnings, Kind::DuplicateVertex), nullptr);
    EXPECT_EQ(find(report.warnings, Kind::DuplicateVertex)->first, 3);
    report = check_mesh(mesh, MeshRole::Solid, {.duplicate_vertices_are_errors = true});
    EXPECT_NE(find(report.errors, Kind::DuplicateVertex), nullptr);
}

TEST(CheckMesh, FindsOverlappingTetrahedra) {
    Mesh mesh = test::corner_tet();
    mesh.x.push_back({0.1, 0.1, 2});  // on the same side of face 0 1 2
    mesh.tets.push_back({0, 1, 2, 4});
    EXPECT_NE(find(check_mesh(mesh, MeshRole::Solid).errors, Kind::OverlappingTets),
              nullptr);
    mesh.x[4].z = -2;
    mesh.tets[1] = {0, 2, 1, 4};
    EXPECT_TRUE(check_mesh(mesh, MeshRole::Solid).ok());
    mesh.x.push_back({0.2, 0.1, -3});
    mesh.tets.push_back({0, 2, 1, 5});
    EXPECT_NE(find(check_mesh(mesh, MeshRole::Solid).errors, Kind::OverlappingTets),
              nullptr);
}

TEST(CheckMesh, TellsEdgeContactFromVertexContactOfSolids) {
    Mesh edge = test::corner_tet();  // a second tetrahedron that shares the edge 0 1 only
    edge.x.push_back({0, -1, 0});
    edge.x.push_back({0, 0, -1});
    edge.tets.push_back({0, 1, 4, 5});
    const MeshReport report = check_mesh(edge, MeshRole::Solid);
    ASSERT_NE(find(report.errors, Kind::NonManifoldEdge), nullptr);
    EXPECT_TRUE(check_mesh(edge, MeshRole::Solid, {.allow_non_manifold = true}).ok());

    Mesh vertex = test::corner_tet();
    vertex.x.insert(vertex.x.end(), {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}});
    vertex.tets.push_back({0, 5, 4, 6});
    const MeshReport at_vertex = check_mesh(vertex, MeshRole::Solid);
    EXPECT_TRUE(at_vertex.ok());
    ASSERT_NE(find(at_vertex.warnings, Kind::NonManifoldVertex), nullptr);
    EXPECT_EQ(find(at_vertex.warnings, Kind::NonManifoldVertex)->first, 0);
    EXPECT_EQ(find(at_vertex.warnings, Kind::NonManifoldVertex)->count, 1);
}

TEST(CheckMesh, WarnsOfTrianglesTurnedAgainstEachOther) {
    Mesh mesh = make_box_surface().value();
    EXPECT_TRUE(check_mesh(mesh, MeshRole::Surface).warnings.empty());
    std::swap(mesh.triangles[5].v[1], mesh.triangles[5].v[2]);
    const MeshReport report = check_mesh(mesh, MeshRole::Surface);
    EXPECT_TRUE(report.ok());
    ASSERT_NE(find(report.warnings, Kind::InconsistentOrientation), nullptr);
    EXPECT_EQ(find(report.warnings, Kind::InconsistentOrientation)->count, 3);
}

TEST(CheckMesh, WarnsOfDoubledTrianglesAndSegments) {
    const Mesh mesh{
        {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}, {{0, 1, 2}, {2, 1, 0}}, {{0, 1}, {1, 0}}};
    EXPECT_NE(find(check_mesh(mesh, MeshRole::Surface).warnings, Kind::DuplicateElement),
              nullptr);
    EXPECT_NE(find(check_mesh(mesh, MeshRole::Segments).warnings, Kind::DuplicateElement),
              nullptr);
    EXPECT_TRUE(check_mesh(mesh, MeshRole::Points).warnings.empty());
}

TEST(CheckMesh, TakesAFanWithManyTrianglesInLinearTime) {
    Mesh fan{{{0, 0, 0}}, {}, {}, {}};
    constexpr int kCount = 100000;
    for (int i = 0; i < kCount; ++i) {
        const double a = 2.0 * 3.141592653589793 * i / kCount;
        fan.x.push_back({std::cos(a), std::sin(a), 0});
        fan.triangles.push_back({0, 1 + i, 1 + (i + 1) % kCount});
    }
    EXPECT_TRUE(check_mesh(fan, MeshRole::Surface, {.poor_below = 0}).warnings.empty());
}

TEST(Checked, FlipsInvertedTetrahedraOnRequest) {
    Mesh mesh = make_box().value();
    for (std::size_t t = 0; t < mesh.tets.size(); t += 3)
        std::swap(mesh.tets[t].v[0], mesh.tets[t].v[1]);
    EXPECT_FALSE(checked(mesh, "box.msh", MeshRole::Solid));
    Result<Mesh> fixed =
        checked(mesh, "box.msh", MeshRole::Solid, {.fix_orientation = true});
    ASSERT_TRUE(fixed);
    EXPECT_NEAR(check_mesh(fixed.value(), MeshRole::Solid).quality.volume, 1.0, 1e-14);
}

TEST(CheckMesh, TheBoxHoldsOnlyVerticesWithAnElement) {
    Mesh mesh = test::corner_tet();
    mesh.x.insert(mesh.x.begin(), {9, 9, 9});
    mesh.tets[0] = {1, 2, 3, 4};
    const MeshReport report = check_mesh(mesh, MeshRole::Solid);
    EXPECT_EQ(max_abs(report.quality.lo), 0.0);
    EXPECT_EQ(max_abs(report.quality.hi), 1.0);
}

TEST(CheckMesh, SegmentsAndPointsBesideTrianglesAreChecked) {
    Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 2, 2}, {3, 3, 3}},
              {},
              {{0, 1, 2}},
              {{1, 3}},
              {4}};
    EXPECT_TRUE(check_mesh(mesh, MeshRole::Surface).warnings.empty());
    mesh.segments[0] = {1, 5};
    EXPECT_FALSE(check_mesh(mesh, MeshRole::Surface).ok());
    mesh.segments[0] = {1, 3};
    mesh.points[0] = -1;
    EXPECT_FALSE(check_mesh(mesh, MeshRole::Surface).ok());
}

TEST(Checked, DropsUnusedVerticesAndOtherElementsAndSaysWhichStayed) {
    Mesh mesh = test::corner_tet();
    mesh.x.insert(mesh.x.begin() + 1, {9, 9, 9});
    mesh.tets[0] = {0, 2, 3, 4};
    mesh.triangles = {{0, 1, 2}};
    MeshReport report;
    Result<Mesh> fine = checked(mesh, "a.msh", MeshRole::Solid, {}, &report);
    ASSERT_TRUE(fine);
    test::expect_same(fine.value(), test::corner_tet());
    EXPECT_EQ(report.kept_vertices, (std::vector<int>{0, 2, 3, 4}));
    EXPECT_EQ(report.warnings.size(), 1U);
    fine = checked(mesh, "a.msh", MeshRole::Solid, {.drop_unreferenced = false}, &report);
    EXPECT_EQ(fine.value().x.size(), 5U);
    EXPECT_TRUE(report.kept_vertices.empty());
}

TEST(Checked, CountsFurtherKindsOfErrors) {
    Mesh mesh = test::corner_tet();
    mesh.tets.push_back({0, 2, 1, 3});
    const Result<Mesh> result = checked(mesh, "a.msh", MeshRole::Solid);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().where, "a.msh");
    EXPECT_EQ(result.error().code, Error::Code::BadMesh);
    EXPECT_NE(result.error().message.find("(and 1 more kinds of error)"),
              std::string::npos)
        << result.error().message;
}

}  // namespace
}  // namespace noli
