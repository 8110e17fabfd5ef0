// SPDX-License-Identifier: Apache-2.0
#include "model/select.hpp"

#include "mesh/topology.hpp"
#include "model/box.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace noli {

namespace {

Box used_box(const std::vector<Vec3d>& x,
             int first,
             const std::vector<std::uint8_t>& used) {
    Box box;
    for (std::size_t v = 0; v < used.size(); ++v)
        if (used[v] != 0) box.add(x[static_cast<std::size_t>(first) + v]);
    return box;
}

/// The selection's box in the coordinates in which it is tested.
Box selection_box(const Selection& selection, const PlacedBody& body) {
    Box box{{selection.box_min[0], selection.box_min[1], selection.box_min[2]},
            {selection.box_max[0], selection.box_max[1], selection.box_max[2]}};
    if (selection.frame == Selection::Frame::World) return box;
    const Box mesh = used_box(body.file_x, 0, body.used);
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
    std::vector<std::uint8_t> allowed = body.used;
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

}  // namespace

Vec3d used_box_center(const std::vector<Vec3d>& x,
                      int first,
                      const std::vector<std::uint8_t>& used) {
    return used_box(x, first, used).center();
}

Result<ModelCondition> make_condition(const BoundaryCondition& what,
                                      const PlacedBody& body,
                                      const std::string& where) {
    ModelCondition made{.what = what, .where = where};
    const int count = static_cast<int>(body.file_x.size());
    const auto is_used = [&](int v) {
        return body.used[static_cast<std::size_t>(v)] != 0;
    };
    for (int v = 0; v < count; ++v)
        if (is_used(v)) made.body_vertices.push_back(body.first + v);

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
            if (is_used(v)) made.vertices.push_back(body.first + v);
        }
    std::sort(made.vertices.begin(), made.vertices.end());
    made.vertices.erase(std::unique(made.vertices.begin(), made.vertices.end()),
                        made.vertices.end());

    if (!made.vertices.empty()) {
        std::vector<Vec3d> selected;
        for (const int v : made.vertices)
            selected.push_back(body.x[static_cast<std::size_t>(v)]);
        const std::vector<std::uint8_t> all(selected.size(), 1);
        made.start_center = used_box_center(selected, 0, all);
    }
    return made;
}

}  // namespace noli
