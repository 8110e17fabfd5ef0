// SPDX-License-Identifier: Apache-2.0
/// Which vertices of a mesh file count: those with an element, and no others.

#include "mesh/generate.hpp"
#include "mesh/write.hpp"
#include "model/boundary.hpp"
#include "model/model.hpp"
#include "unit/mesh/test_files.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace noli {
namespace {

using test::TempFolder;

constexpr Vec3d kFarAway{100, -50, 30};

Mesh box_mesh() {
    return make_box({.nx = 2, .ny = 2, .nz = 2}).value();
}

/// The mesh with a vertex of no element before all others, and one after them.
Mesh with_strays(Mesh mesh) {
    mesh.x.insert(mesh.x.begin(), kFarAway);
    mesh.x.push_back(-1.0 * kFarAway);
    const auto shift = [](auto& elements) {
        for (auto& e : elements)
            for (int& v : e.v)
                ++v;
    };
    shift(mesh.tets);
    shift(mesh.triangles);
    shift(mesh.segments);
    return mesh;
}

/// A spinning body whose conditions select in every way.
Body body_of(const std::string& file, std::vector<int> chosen) {
    using Kind = BoundaryCondition::Kind;
    Body body;
    body.name = "body";
    body.mesh.file = file;
    body.angular_velocity_deg = {10, 20, 30};
    BoundaryCondition left;
    left.kind = Kind::Velocity;
    left.selection.kind = Selection::Kind::Box;
    left.selection.box_min = {-0.1, -0.1, -0.1};
    left.selection.box_max = {0.1, 1.1, 1.1};
    BoundaryCondition everywhere = left;
    everywhere.selection.frame = Selection::Frame::World;
    everywhere.selection.box_min = {-1e3, -1e3, -1e3};
    everywhere.selection.box_max = {1e3, 1e3, 1e3};
    BoundaryCondition all;
    BoundaryCondition listed;
    listed.selection.kind = Selection::Kind::Vertices;
    listed.selection.vertices = std::move(chosen);
    body.boundary = {left, everywhere, all, listed};
    return body;
}

Model built(const TempFolder& folder,
            const Body& body,
            std::vector<SceneWarning>* warnings = nullptr) {
    Scene scene;
    scene.base_folder = folder.path();
    scene.bodies = {body};
    Result<Model> model = build_model(scene, warnings);
    EXPECT_TRUE(model) << model.error().where << ": " << model.error().message;
    return model ? model.value() : Model{};
}

std::vector<int> shifted(std::vector<int> vertices) {
    for (int& v : vertices)
        ++v;
    return vertices;
}

void expect_same_but_for_strays(const Model& clean, const Model& stray) {
    ASSERT_EQ(stray.num_vertices, clean.num_vertices + 2);
    EXPECT_EQ(stray.unreferenced, (std::vector<int>{0, stray.num_vertices - 1}));
    EXPECT_EQ(norm(stray.x0[0] - kFarAway), 0.0);  // numbers and places are the file's
    EXPECT_EQ(stray.diagonal, clean.diagonal);
    EXPECT_EQ(stray.surface_vertices, shifted(clean.surface_vertices));
    for (int v = 0; v < clean.num_vertices; ++v) {
        const auto i = static_cast<std::size_t>(v);
        EXPECT_EQ(norm(stray.v0[i + 1] - clean.v0[i]), 0.0);
        EXPECT_EQ(norm(stray.places()[i + 1] - clean.x0[i]), 0.0);
    }
    EXPECT_EQ(norm(stray.places()[0] - clean.x0[0]), 0.0);
    ASSERT_EQ(stray.conditions.size(), clean.conditions.size());
    for (std::size_t c = 0; c < clean.conditions.size(); ++c) {
        SCOPED_TRACE(c);
        const ModelCondition& a = clean.conditions[c];
        const ModelCondition& b = stray.conditions[c];
        EXPECT_EQ(b.vertices, shifted(a.vertices));
        EXPECT_EQ(b.body_vertices, shifted(a.body_vertices));
        EXPECT_EQ(norm(b.start_center - a.start_center), 0.0);
    }
}

TEST(VerticesWithoutElement, DoNotMatterToAnElasticBody) {
    const TempFolder folder;
    ASSERT_FALSE(write_mesh(folder / "clean.mesh", box_mesh()));
    ASSERT_FALSE(write_mesh(folder / "stray.mesh", with_strays(box_mesh())));
    std::vector<SceneWarning> warnings;
    expect_same_but_for_strays(
        built(folder, body_of("clean.mesh", {3, 4})),
        built(folder, body_of("stray.mesh", {0, 4, 5}), &warnings));
    ASSERT_EQ(warnings.size(), 1U);  // said once
    EXPECT_NE(warnings[0].message.find("2 vertices that no tetrahedron uses (first: 0)"),
              std::string::npos)
        << warnings[0].message;
}

TEST(VerticesWithoutElement, DoNotMatterToAnObstacle) {
    const TempFolder folder;
    const Mesh surface = make_box_surface().value();
    ASSERT_FALSE(write_mesh(folder / "clean.obj", surface));
    ASSERT_FALSE(write_mesh(folder / "stray.obj", with_strays(surface)));
    expect_same_but_for_strays(built(folder, body_of("clean.obj", {3, 4})),
                               built(folder, body_of("stray.obj", {0, 4, 5})));
}

TEST(VerticesWithoutElement, DoNotKeepAConditionFromEnding) {
    const TempFolder folder;
    ASSERT_FALSE(write_mesh(folder / "stray.mesh", with_strays(box_mesh())));
    Body body = body_of("stray.mesh", {4});
    body.boundary.resize(1);
    body.boundary[0].until =
        BoundaryCondition::Until{.subject = BoundaryCondition::Until::Subject::Body,
                                 .axis = 0,
                                 .above = true,
                                 .value = -1.0,
                                 .then_hold = false};
    const Model model = built(folder, body);
    BoundaryScript script(model, {0, 0, 0});
    StepBoundary out;
    script.evaluate(0.0, 0.1, 0, model.x0, out);
    EXPECT_EQ(script.ended, (std::vector<std::uint8_t>{1}));
}

/// Two triangles, a polyline of three points beside them, one more line along an edge of
/// a triangle, a point, and a vertex without any.
constexpr const char* kMixed =
    "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nv 3 0 0\nv 3 1 0\nv 3 1 1\nv 5 5 5\nv 9 9 9\n"
    "f 1 2 3\nf 2 4 3\nl 5 6 7\nl 2 1\np 8\n";

TEST(ObjObstacle, KeepsLinesAndPointsBesideFaces) {
    const TempFolder folder;
    folder.write("mixed.obj", kMixed);
    Body body;
    body.name = "mixed";
    body.mesh.file = "mixed.obj";
    const Model m = built(folder, body);
    EXPECT_EQ(m.triangles.size(), 2U);
    EXPECT_EQ(m.segments, (std::vector<Int2>{{4, 5}, {5, 6}}));
    EXPECT_EQ(m.edges.size(), 5U + 2U);  // the line along an edge is that edge
    EXPECT_EQ(m.surface_vertices, (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7}));
    EXPECT_EQ(m.unreferenced, (std::vector<int>{8}));
}

TEST(ObjObstacle, ReadsLinesOfManyPointsAlone) {
    const TempFolder folder;
    folder.write("rope.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 1 0\nl 1 2 3 4\n");
    Body body;
    body.name = "rope";
    body.mesh.file = "rope.obj";
    const Model m = built(folder, body);
    EXPECT_EQ(m.segments, (std::vector<Int2>{{0, 1}, {1, 2}, {2, 3}}));
    EXPECT_EQ(m.surface_vertices, (std::vector<int>{0, 1, 2, 3}));
    EXPECT_TRUE(m.unreferenced.empty());
}

TEST(ObjObstacle, TakesOnlyTheNamedPointsWhereThereAreAny) {
    const TempFolder folder;
    folder.write("points.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\np 1 3\n");
    Body body;
    body.name = "points";
    body.mesh.file = "points.obj";
    EXPECT_EQ(built(folder, body).surface_vertices, (std::vector<int>{0, 2}));
}

/// Gmsh writes the boundary of a surface as lines: they are no ropes.
TEST(GmshObstacle, LinesBesideTrianglesAreBoundaries) {
    const TempFolder folder;
    const Mesh mesh{
        {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {9, 9, 9}}, {}, {{0, 1, 2}}, {{0, 1}, {1, 3}}};
    ASSERT_FALSE(write_mesh(folder / "plate.msh", mesh));
    Body body;
    body.name = "plate";
    body.mesh.file = "plate.msh";
    const Model m = built(folder, body);
    EXPECT_TRUE(m.segments.empty());
    EXPECT_EQ(m.edges.size(), 3U);
    EXPECT_EQ(m.unreferenced, (std::vector<int>{3}));
}

}  // namespace
}  // namespace noli
