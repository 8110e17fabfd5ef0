// SPDX-License-Identifier: Apache-2.0
/// Keywords of an IPC script that put something into the scene: shapes, grids of shapes,
/// obstacles.
#include "scene/ipc_parser.hpp"

#include <array>
#include <fmt/format.h>

namespace noli::detail {

namespace {

void expect_input(ScriptWords& w) {
    const std::string type = w.word("\"input\"");
    if (type != "input")
        w.fail(fmt::format("found shapes of type \"{}\", expected input; write a "
                           "mesh file instead",
                           type),
               Error::Code::Unsupported);
}

}  // namespace

void ScriptParser::add_shape_keywords() {
    keywords_["shape"] = [this](ScriptWords& w) {
        expect_input(w);
        ScriptShape shape;
        shape.place = w;
        shape.path = w.word("the path of a mesh");
        script_.shapes.push_back(shape);
    };
    keywords_["shapes"] = [this](ScriptWords& w) {
        expect_input(w);
        const int count = w.integer("the number of shapes");
        for (int i = 0; i < count; ++i)
            script_.shapes.push_back(read_shape(next_line(w, "a line for every shape")));
    };
    keywords_["shapeMatrix"] = [this](ScriptWords& w) { read_matrix(w); };
    keywords_["rotateModel"] = [this](ScriptWords& w) {
        ScriptRotation rotation{.axis = w.vector("the axis")};
        rotation.degrees = w.number("the angle in degrees");
        require(rotation.axis != Vector3{},
                w,
                "found the axis 0 0 0, expected a direction; correct it");
        script_.rotation = rotation;
    };
    keywords_["meshCO"] = [this](ScriptWords& w) {
        ScriptObstacle obstacle;
        obstacle.place = w;
        obstacle.path = w.word("the path of a mesh");
        obstacle.origin = w.vector("the origin");
        obstacle.scale = w.number("the scale");
        w.number("the stiffness");  // unused there too
        obstacle.friction = w.number("the friction");
        if (w.peek() == "rotate") {
            w.word("");
            obstacle.rotation_deg = w.vector("the rotation in degrees");
        }
        require(obstacle.scale > 0,
                w,
                "found a scale that is not positive, expected an extent in m; "
                "correct it");
        script_.obstacles.push_back(obstacle);
    };
}

ScriptWords ScriptParser::next_line(const ScriptWords& opening, const char* what) {
    ScriptWords words;
    if (!lines_.next(words))
        opening.fail(
            fmt::format("found the end of the file, expected {}; add the lines", what));
    return words;
}

void ScriptParser::read_matrix(ScriptWords& w) {
    expect_input(w);
    std::array<int, 3> grid{};
    for (int& n : grid) {
        n = w.integer("the number of copies along an axis");
        require(n >= 1,
                w,
                fmt::format("found {} copies, expected at least one; correct it", n));
    }
    const Vector3 origin =
        w.number_follows() ? w.vector("the place of the first copy") : Vector3{};
    ScriptShape shape = read_shape(next_line(w, "a line with a shape"));
    shape.grid = grid;
    shape.spacing =
        shape.translation;  // in a matrix the first three numbers are distances
    shape.translation = origin;
    script_.shapes.push_back(shape);
}

}  // namespace noli::detail
