// SPDX-License-Identifier: Apache-2.0
/// TetGen .node and .ele. Source: TetGen manual, section "File formats".
#include "mesh/cursor.hpp"
#include "mesh/readers.hpp"

#include <filesystem>
#include <fmt/format.h>

namespace noli::detail {

namespace {

/// Node or element number at the head of a line; they must count up from 0 or 1.
void check_number(const Cursor& in,
                  std::int64_t found,
                  std::int64_t expected,
                  const char* what) {
    if (found != expected)
        in.fail(fmt::format(
            "found {} number {}, expected {}; a line is missing or the numbers do not "
            "count up from 0 or 1: write the file again",
            what,
            found,
            expected));
}

void require_line(Cursor& in, const char* what) {
    if (!in.next_line()) in.fail_truncated(what);
}

/// Returns the number of the first node (0 or 1).
std::int64_t read_nodes(const std::string& path, std::string_view bytes, Mesh& mesh) {
    Cursor in(path, bytes, '#');
    require_line(in, "the line \"<points> 3 <attributes> <marker>\"");
    const std::int64_t announced =
        in.parse_integer(in.token_in_line(), "the number of points");
    const std::string_view dim = in.token_in_line();
    if (!dim.empty() && in.parse_integer(dim, "the dimension") != 3)
        in.fail(
            fmt::format("found dimension {}, expected 3; export a three-dimensional mesh",
                        quoted(dim)));
    const int count = in.checked_count(announced, 8, "points");
    mesh.x.reserve(static_cast<std::size_t>(count));
    std::int64_t base = 0;
    for (int i = 0; i < count; ++i) {
        require_line(in, "a point");
        const std::int64_t number =
            in.parse_integer(in.token_in_line(), "a point number");
        if (i == 0) base = number == 0 ? 0 : 1;
        check_number(in, number, base + i, "point");
        const double x =
            in.parse_number(in.token_in_line(), "the x coordinate of a point");
        const double y =
            in.parse_number(in.token_in_line(), "the y coordinate of a point");
        const double z =
            in.parse_number(in.token_in_line(), "the z coordinate of a point");
        mesh.x.push_back({x, y, z});
    }
    return base;
}

void read_tets(const std::string& path,
               std::string_view bytes,
               std::int64_t base,
               Mesh& mesh) {
    Cursor in(path, bytes, '#');
    require_line(in, "the line \"<tetrahedra> 4 <attributes>\"");
    const std::int64_t announced =
        in.parse_integer(in.token_in_line(), "the number of tetrahedra");
    const std::string_view nodes = in.token_in_line();
    if (!nodes.empty() && in.parse_integer(nodes, "the nodes per tetrahedron") != 4)
        in.fail(fmt::format(
            "found {} nodes per tetrahedron, expected 4; run TetGen without -o2", nodes));
    const int count = in.checked_count(announced, 10, "tetrahedra");
    mesh.tets.reserve(static_cast<std::size_t>(count));
    const auto num_nodes = static_cast<std::int64_t>(mesh.x.size());
    for (int i = 0; i < count; ++i) {
        require_line(in, "a tetrahedron");
        check_number(in,
                     in.parse_integer(in.token_in_line(), "a tetrahedron number"),
                     base + i,
                     "tetrahedron");
        Int4 tet{};
        for (int k = 0; k < 4; ++k) {
            const std::int64_t node =
                in.parse_integer(in.token_in_line(), "a corner of a tetrahedron");
            if (node < base || node >= base + num_nodes)
                in.fail(
                    fmt::format("tetrahedron {} uses point {}, expected {} to {}; "
                                "correct the line, or "
                                "check that the .node and .ele files belong together",
                                base + i,
                                node,
                                base,
                                base + num_nodes - 1));
            tet[k] = static_cast<int>(node - base);
        }
        mesh.tets.push_back(tet);
    }
}

}  // namespace

Mesh read_tetgen(const std::string& base_path, bool need_tets) {
    Mesh mesh;
    const std::string node_path = base_path + ".node", ele_path = base_path + ".ele";
    const std::int64_t base = read_nodes(node_path, load_file(node_path), mesh);
    std::error_code ec;
    if (need_tets || std::filesystem::exists(ele_path, ec))
        read_tets(ele_path, load_file(ele_path), base, mesh);
    return mesh;
}

}  // namespace noli::detail
