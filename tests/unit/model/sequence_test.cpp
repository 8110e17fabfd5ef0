// SPDX-License-Identifier: Apache-2.0
/// Mesh sequences: who reads which file, how often, and how much of it.

#include "mesh/generate.hpp"
#include "mesh/write.hpp"
#include "model/model.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sys/inotify.h>
#include <unistd.h>

namespace noli {
namespace {

namespace fs = std::filesystem;

class Folder {
  public:
    Folder() {
        static int count = 0;
        path_ = fs::temp_directory_path()
              / ("noli_sequence_" + std::to_string(getpid()) + "_"
                 + std::to_string(count++));
        fs::create_directories(path_);
    }
    ~Folder() { fs::remove_all(path_); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    [[nodiscard]] std::string path() const { return path_.string(); }
    std::string operator/(const std::string& name) const {
        return (path_ / name).string();
    }
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(*this / name) << text;
    }

  private:
    fs::path path_;
};

/// How often each file of a folder was opened since the object was made.
class Opened {
  public:
    explicit Opened(const std::string& folder) : queue_(inotify_init1(IN_NONBLOCK)) {
        watched_ = queue_ >= 0 && inotify_add_watch(queue_, folder.c_str(), IN_OPEN) >= 0;
    }
    ~Opened() { close(queue_); }
    Opened(const Opened&) = delete;
    Opened& operator=(const Opened&) = delete;
    [[nodiscard]] bool works() const { return watched_; }

    std::map<std::string, int> counts() {
        alignas(inotify_event) char bytes[65536];
        for (ssize_t size = 0; (size = read(queue_, bytes, sizeof(bytes))) > 0;)
            for (ssize_t at = 0; at < size;) {
                const auto* event = reinterpret_cast<const inotify_event*>(bytes + at);
                if (event->len > 0) ++counts_[event->name];
                at += static_cast<ssize_t>(sizeof(inotify_event)) + event->len;
            }
        return counts_;
    }

  private:
    int queue_;
    bool watched_ = false;
    std::map<std::string, int> counts_;
};

/// A triangle that shifts along y by frame; its face line is no part of a position.
std::string frame(double y, const std::string& face = "f 1 2 3\n") {
    const std::string h = std::to_string(y);
    return "v 0 " + h + " 0\nv 1 " + h + " 0\nv 0 " + h + " 1\n" + face;
}

Body plate(const Folder& folder, const std::vector<std::string>& files) {
    folder.write("plate.obj", frame(0));
    Body body;
    body.name = "plate";
    body.mesh.file = "plate.obj";
    BoundaryCondition& condition = body.boundary.emplace_back();
    condition.kind = BoundaryCondition::Kind::Sequence;
    condition.sequence = files;
    return body;
}

Scene scene_of(const Folder& folder, const Body& body) {
    Scene scene;
    scene.base_folder = folder.path();
    scene.bodies = {body};
    return scene;
}

TEST(Sequence, EachFileIsReadOnceForAllCopiesConditionsAndSteps) {
    const Folder folder;
    folder.write("a.obj", frame(1));
    folder.write("b.obj", frame(2));
    Body body = plate(folder, {"a.obj", "b.obj", "a.obj", "./b.obj"});
    body.grid = {3, 1, 1};
    body.grid_spacing = {2, 0, 0};
    body.boundary.push_back(body.boundary[0]);
    body.boundary[1].selection.kind = Selection::Kind::Vertices;
    body.boundary[1].selection.vertices = {2};
    Opened opened(folder.path());
    if (!opened.works()) GTEST_SKIP() << "this system does not watch files (inotify)";
    const Result<Model> model = build_model(scene_of(folder, body));
    ASSERT_TRUE(model) << model.error().message;
    EXPECT_EQ(opened.counts(),
              (std::map<std::string, int>{{"a.obj", 1}, {"b.obj", 1}, {"plate.obj", 1}}));
    ASSERT_EQ(model.value().conditions.size(), 6U);
    for (std::size_t c = 0; c < 6; ++c) {
        const ModelCondition& condition = model.value().conditions[c];
        ASSERT_EQ(condition.sequence.size(), 4U);
        for (std::size_t step = 0; step < 4; ++step) {
            ASSERT_EQ(condition.sequence[step].size(), c % 2 == 0 ? 3U : 1U);
            EXPECT_EQ(condition.sequence[step].back().y, step % 2 == 0 ? 1.0 : 2.0);
            EXPECT_EQ(condition.sequence[step].back().z, 1.0);
        }
    }
}

TEST(Sequence, OnlyThePositionsOfAFrameAreLookedAt) {
    const Folder folder;
    folder.write("bad_faces.obj", frame(1, "f 1 1 1\nf 7 8 nothing\n"));
    folder.write("no_faces.obj", frame(2, ""));
    const Result<Model> model =
        build_model(scene_of(folder, plate(folder, {"bad_faces.obj", "no_faces.obj"})));
    ASSERT_TRUE(model) << model.error().message;
    EXPECT_EQ(model.value().conditions[0].sequence[0][1].y, 1.0);
    EXPECT_EQ(model.value().conditions[0].sequence[1][1].y, 2.0);
}

TEST(Sequence, PointsAloneServeAsFramesInEveryFormat) {
    const Folder folder;
    Body body;
    body.name = "box";
    body.mesh.generator = "box";
    body.mesh.parameters = {{"size", {1, 1, 1}}, {"cells", {2, 2, 2}}};
    const Mesh box = make_box({.nx = 2, .ny = 2, .nz = 2}).value();
    BoundaryCondition& condition = body.boundary.emplace_back();
    condition.kind = BoundaryCondition::Kind::Sequence;
    for (const char* name : {"a.node", "a.msh", "a.mesh"}) {
        ASSERT_FALSE(write_mesh(folder / name, box));
        condition.sequence.emplace_back(name);
    }
    fs::remove(folder / "a.ele");  // TetGen's elements are not asked for
    ASSERT_FALSE(write_mesh(folder / "b.ply", {.x = box.x}, {.binary = true}));
    condition.sequence.emplace_back("b.ply");
    const Result<Model> model = build_model(scene_of(folder, body));
    ASSERT_TRUE(model) << model.error().where << ": " << model.error().message;
    for (const auto& x : model.value().conditions[0].sequence) {
        ASSERT_EQ(x.size(), box.x.size());
        for (std::size_t v = 0; v < x.size(); ++v)
            EXPECT_EQ(norm(x[v] - box.x[v]), 0.0);
    }
}

TEST(Sequence, WrongFramesAreNamedWithTheCondition) {
    const Folder folder;
    folder.write("four.obj", frame(1, "v 2 2 2\n"));
    Result<Model> model = build_model(scene_of(folder, plate(folder, {"four.obj"})));
    ASSERT_FALSE(model);
    EXPECT_NE(model.error().where.find("/bodies/0/boundary/0"), std::string::npos);
    EXPECT_NE(model.error().message.find("4 vertices, expected 3"), std::string::npos);

    model = build_model(scene_of(folder, plate(folder, {"missing.obj"})));
    ASSERT_FALSE(model);
    EXPECT_NE(model.error().where.find("/bodies/0/boundary/0: "), std::string::npos);
    EXPECT_NE(model.error().where.find("missing.obj"), std::string::npos);

    folder.write("tet.mesh",
                 "MeshVersionFormatted 2\nDimension 3\nVertices 4\n0 0 0 0\n1 0 0 0\n0 1 "
                 "0 0\n0 0 1 0\nTetrahedra 1\n1 2 3 4 0\n");
    folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 -1\n");
    Body tet = plate(folder, {"tet.mesh", "flat.obj"});
    tet.mesh.file = "tet.mesh";
    model = build_model(scene_of(folder, tet));
    ASSERT_FALSE(model);
    EXPECT_NE(model.error().message.find(
                  "\"flat.obj\" turns the tetrahedron of vertices 0, 1, 2 and 3"),
              std::string::npos)
        << model.error().message;
}

}  // namespace
}  // namespace noli
