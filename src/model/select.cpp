// SPDX-License-Identifier: Apache-2.0
#include "model/select.hpp"

#include "mesh/source.hpp"
#include "mesh/topology.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

namespace noli {

namespace {

struct Box {
    Vec3d lo, hi;
};

Box bounding_box(const std::vector<Vec3d>& x, int first, int count) {
    constexpr double kInf = std::numeric_limits<double>::infinity();
    Box box{{kInf, kInf, kInf}, {-kInf, -kInf, -kInf}};
    for (int v = first; v < first + count; ++v) {
        const Vec3d& p = x[static_cast<std::size_t>(v)];
        for (int k = 0; k < 3; ++k) {
            box.lo[k] = std::min(box.lo[k], p[k]);
            box.hi[k] = std::max(box.hi[k], p[k]);
        }
    }
    return box;
}

/// The selection's box in the coordinates in which it is tested.
Box selection_box(const Selection& selection, const PlacedBody& body) {
    Box box{{selection.box_min[0], selection.box_min[1], selection.box_min[2]},
            {selection.box_max[0], selection.box_max[1], selection.box_max[2]}};
    if (selection.frame == Selection::Frame::World) return box;
    const Box mesh = bounding_box(body.file_x, 0, static_cast<int>(body.file_x.size()));
    for (int k = 0; k < 3; ++k) {
        const double extent = mesh.hi[k] - mesh.lo[k];
        box.lo[k] = mesh.lo[k] + box.lo[k] * extent;
        box.hi[k] = mesh.lo[k] + box.hi[k] * extent;
    }
    return box;
}

bool inside(const Box& box, const Vec3d& p) {
    for (int k = 0; k < 3; ++k)
        if (p[k] < box.lo[k] || p[k] > box.hi[k]) return false;
    return true;
}

std::vector<int> select_box(const Selection& selection, const PlacedBody& body) {
    const Box box = selection_box(selection, body);
    std::vector<std::uint8_t> allowed(body.file_x.size(), 1);
    if (selection.surface_only && !body.mesh.tets.empty()) {
        std::fill(allowed.begin(), allowed.end(), 0);
        for (const Int3& t : boundary_triangles(body.mesh.tets))
            for (const int v : t.v)
                allowed[static_cast<std::size_t>(v)] = 1;
    }
    std::vector<int> found;
    for (std::size_t v = 0; v < body.file_x.size(); ++v) {
        const Vec3d& p = selection.frame == Selection::Frame::World
                           ? body.x[static_cast<std::size_t>(body.first) + v]
                           : body.file_x[v];
        if (allowed[v] != 0 && inside(box, p))
            found.push_back(body.first + static_cast<int>(v));
    }
    return found;
}

Status load_sequence(ModelCondition& condition,
                     const PlacedBody& body,
                     const std::string& base_folder) {
    for (const std::string& file : condition.what.sequence) {
        Result<Mesh> frame = load_body_mesh(MeshSource{.file = file}, base_folder);
        if (!frame) return frame.error();
        if (frame.value().x.size() != body.file_x.size())
            return Error{
                Error::Code::BadMesh,
                condition.where,
                fmt::format("\"{}\" has {} vertices, expected {} as in the body's mesh",
                            file,
                            frame.value().x.size(),
                            body.file_x.size())};
        std::vector<Vec3d>& positions = condition.sequence.emplace_back();
        for (const int v : condition.vertices)
            positions.push_back(
                frame.value().x[static_cast<std::size_t>(v - body.first)]);
    }
    return Done{};
}

}  // namespace

Vec3d bounding_box_center(const std::vector<Vec3d>& x, int first, int count) {
    const Box box = bounding_box(x, first, count);
    return 0.5 * (box.lo + box.hi);
}

Result<ModelCondition> make_condition(const BoundaryCondition& what,
                                      const PlacedBody& body,
                                      const std::string& where,
                                      const std::string& base_folder) {
    ModelCondition made{.what = what, .where = where};
    const int count = static_cast<int>(body.file_x.size());
    for (int v = 0; v < count; ++v)
        made.body_vertices.push_back(body.first + v);

    const Selection& selection = what.selection;
    if (selection.kind == Selection::Kind::All) made.vertices = made.body_vertices;
    if (selection.kind == Selection::Kind::Box)
        made.vertices = select_box(selection, body);
    if (selection.kind == Selection::Kind::Vertices)
        for (const int v : selection.vertices) {
            if (v < 0 || v >= count)
                return Error{
                    Error::Code::InvalidScene,
                    where + "/select/vertices",
                    fmt::format(
                        "vertex {} does not exist, expected 0..{}", v, count - 1)};
            made.vertices.push_back(body.first + v);
        }
    std::sort(made.vertices.begin(), made.vertices.end());
    made.vertices.erase(std::unique(made.vertices.begin(), made.vertices.end()),
                        made.vertices.end());

    if (!made.vertices.empty()) {
        std::vector<Vec3d> selected;
        for (const int v : made.vertices)
            selected.push_back(body.x[static_cast<std::size_t>(v)]);
        made.start_center =
            bounding_box_center(selected, 0, static_cast<int>(selected.size()));
    }
    Status loaded = load_sequence(made, body, base_folder);
    if (!loaded) return loaded.error();
    return made;
}

}  // namespace noli
