// SPDX-License-Identifier: Apache-2.0
/// TetGen .node and .ele. Source: TetGen manual, section "File formats".
#include "mesh/cursor.hpp"
#include "mesh/readers.hpp"

#include <algorithm>
#include <cctype>
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

/// A pair without one of its files is no mesh: what is there must not pass for a cloud
/// of points.
void require_partner(const std::string& path,
                     const std::string& partner,
                     const char* holds) {
    std::error_code ec;
    if (std::filesystem::exists(path, ec) || !std::filesystem::exists(partner, ec))
        return;
    throw ReadFailure{
        {Error::Code::FileNotReadable,
         path,
         fmt::format("there is no such file, expected {} that belong to {}; put it "
                     "beside that file. For an obstacle of points write them to a .pt "
                     "file, in lines \"v x y z\"",
                     holds,
                     std::filesystem::path(partner).filename().string())}};
}

bool is_same_but_for_case(std::string_view text, std::string_view lower) {
    return std::equal(
        text.begin(), text.end(), lower.begin(), lower.end(), [](char a, char b) {
            return std::tolower(static_cast<unsigned char>(a)) == b;
        });
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

Mesh read_tetgen(const TetgenFiles& files, ReadPart part) {
    Mesh mesh;
    require_partner(files.node, files.ele, "the points");
    const std::int64_t base = read_nodes(files.node, load_file(files.node), mesh);
    if (part == ReadPart::Positions) return mesh;
    require_partner(files.ele, files.node, "the tetrahedra");
    read_tets(files.ele, load_file(files.ele), base, mesh);
    return mesh;
}

TetgenFiles tetgen_files(const std::string& path) {
    namespace fs = std::filesystem;
    const std::string extension = fs::path(path).extension().string();
    const bool is_node = is_same_but_for_case(extension, ".node");
    const bool is_ele = is_same_but_for_case(extension, ".ele");
    const std::string base =
        is_node || is_ele ? fs::path(path).replace_extension().string() : path;
    std::error_code ec;
    const auto beside = [&](const char* lower, const char* upper) {
        const bool other_case =
            !fs::exists(base + lower, ec) && fs::exists(base + upper, ec);
        return base + (other_case ? upper : lower);
    };
    return {is_node ? path : beside(".node", ".NODE"),
            is_ele ? path : beside(".ele", ".ELE")};
}

}  // namespace noli::detail
