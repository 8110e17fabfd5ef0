// SPDX-License-Identifier: Apache-2.0
/// Wavefront OBJ and the line formats of IPC scripts (.seg, .pt) that borrow its "v"
/// lines. Why not tinyobjloader: even with TINYOBJLOADER_USE_DOUBLE its number parser is
/// not correctly rounded. Of 30,000 random doubles written with their shortest digits,
/// 20,499 came back changed (2.0.0rc10).
#include "mesh/cursor.hpp"
#include "mesh/readers.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace noli::detail {

namespace {

/// Keywords of the OBJ specification that carry no geometry of ours.
bool is_ignored(std::string_view key) {
    constexpr std::string_view kIgnored[] = {
        "vn",     "vt",       "vp",       "g",      "o",          "s",         "mg",
        "usemtl", "mtllib",   "usemap",   "maplib", "shadow_obj", "trace_obj", "lod",
        "bevel",  "c_interp", "d_interp", "cstype", "deg",        "bmat",      "step",
        "curv",   "curv2",    "surf",     "parm",   "trim",       "hole",      "scrv",
        "sp",     "end",      "con",      "call",   "csh"};
    return std::find(std::begin(kIgnored), std::end(kIgnored), key) != std::end(kIgnored);
}

Vec3d read_point(Cursor& in) {
    const double x = in.parse_number(in.token_in_line(), "the x coordinate of a vertex");
    const double y = in.parse_number(in.token_in_line(), "the y coordinate of a vertex");
    const double z = in.parse_number(in.token_in_line(), "the z coordinate of a vertex");
    return {x, y, z};
}

/// Polygons and lines may name vertices that come later in the file, so indices are
/// checked at the end.
class ObjReader {
  public:
    ObjReader(const std::string& path, std::string_view bytes) : in_(path, bytes, '#') {}

    Mesh read(ReadPart part) {
        const bool only_points = part == ReadPart::Positions;
        while (in_.next_line()) {
            const std::string_view key = in_.token_in_line();
            if (key == "v") {
                mesh_.x.push_back(read_point(in_));
            } else if (only_points && (key == "f" || key == "l" || key == "p")) {
                continue;
            } else if (key == "f") {
                read_face();
            } else if (key == "l") {
                read_line();
            } else if (key == "p") {
                read_points();
            } else if (!is_ignored(key)) {
                in_.fail(
                    fmt::format("found {}, expected an OBJ keyword such as v or f; "
                                "correct the line or put "
                                "# before it",
                                quoted(key)));
            }
        }
        if (mesh_.x.empty())
            in_.fail(
                "the file has no \"v x y z\" line, expected vertices; write the file "
                "again");
        if (max_index_ >= static_cast<std::int64_t>(mesh_.x.size()))
            throw ReadFailure{{Error::Code::BadMesh,
                               max_place_,
                               fmt::format("found vertex {}, expected 1 to {} (or -1 to "
                                           "{}); correct the line or "
                                           "write the file again",
                                           max_index_ + 1,
                                           mesh_.x.size(),
                                           -static_cast<std::int64_t>(mesh_.x.size()))}};
        mesh_.triangles = triangulated(mesh_.x, polygons_);
        return std::move(mesh_);
    }

  private:
    /// "7", "7/1", "7//3", "7/1/3" or "-1": only the first number counts. Returns the
    /// index from 0.
    int read_index(std::string_view text) {
        const std::int64_t found =
            in_.parse_integer(text.substr(0, text.find('/')), "a vertex number");
        const auto so_far = static_cast<std::int64_t>(mesh_.x.size());
        if (found == 0 || found < -so_far || found > INT32_MAX)
            in_.fail(
                fmt::format("found vertex number {}, expected 1 or more, or -1 to {} "
                            "counted back from the "
                            "last vertex; correct the line",
                            found,
                            -so_far));
        const std::int64_t index = found > 0 ? found - 1 : so_far + found;
        if (index > max_index_) {
            max_index_ = index;
            if (index >= so_far) max_place_ = in_.place();
        }
        return static_cast<int>(index);
    }

    void read_face() {
        int count = 0;
        for (std::string_view t = in_.token_in_line(); !t.empty();
             t = in_.token_in_line(), ++count)
            polygons_.corners.push_back(read_index(t));
        if (count < 3)
            in_.fail(
                fmt::format("found a face with {} corners, expected 3 or more; correct "
                            "or remove the line",
                            count));
        polygons_.close();
    }

    void read_line() {
        int previous = -1, count = 0;
        for (std::string_view t = in_.token_in_line(); !t.empty();
             t = in_.token_in_line(), ++count) {
            const int index = read_index(t);
            if (count > 0) mesh_.segments.push_back({previous, index});
            previous = index;
        }
        if (count < 2)
            in_.fail(fmt::format(
                "found a line with {} points, expected 2 or more; correct or remove it",
                count));
    }

    void read_points() {
        const std::size_t before = mesh_.points.size();
        for (std::string_view t = in_.token_in_line(); !t.empty();
             t = in_.token_in_line())
            mesh_.points.push_back(read_index(t));
        if (mesh_.points.size() == before)
            in_.fail(
                "found a p line without a vertex, expected 1 or more; correct or remove "
                "it");
    }

    Cursor in_;
    Mesh mesh_;
    Polygons polygons_;
    std::int64_t max_index_ = -1;
    std::string max_place_;
};

}  // namespace

Mesh read_obj(const std::string& path, std::string_view bytes, ReadPart part) {
    return ObjReader(path, bytes).read(part);
}

Mesh read_seg(const std::string& path, std::string_view bytes) {
    Cursor in(path, bytes, '#');
    Mesh mesh;
    std::int64_t largest = 0;  // number of a vertex, which may come later in the file
    std::string place;
    while (in.next_line()) {
        const std::string_view key = in.token_in_line();
        if (key == "v") {
            mesh.x.push_back(read_point(in));
        } else if (key == "s") {
            Int2 segment{};
            for (int k = 0; k < 2; ++k) {
                const std::int64_t v =
                    in.parse_integer(in.token_in_line(), "an end of a segment");
                if (v < 1 || v > INT32_MAX)
                    in.fail(fmt::format(
                        "found vertex {}, expected 1 or more; correct the line", v));
                if (v > largest) {
                    largest = v;
                    place = in.place();
                }
                segment[k] = static_cast<int>(v - 1);
            }
            mesh.segments.push_back(segment);
        } else {
            in.fail(
                fmt::format("found {}, expected \"v x y z\" or \"s i j\"; correct the "
                            "line or put # before it",
                            quoted(key)));
        }
    }
    if (largest > static_cast<std::int64_t>(mesh.x.size()))
        throw ReadFailure{
            {Error::Code::BadMesh,
             place,
             fmt::format("found vertex {}, expected 1 to {}; correct the line or add the "
                         "missing \"v x y z\" lines",
                         largest,
                         mesh.x.size())}};
    return mesh;
}

Mesh read_pt(const std::string& path, std::string_view bytes) {
    Cursor in(path, bytes, '#');
    Mesh mesh;
    while (in.next_line()) {
        const std::string_view key = in.token_in_line();
        if (key == "v")
            mesh.x.push_back(read_point(in));
        else if (key != "f" && key != "l" && key != "p" && !is_ignored(key))
            in.fail(fmt::format(
                "found {}, expected \"v x y z\"; correct the line or put # before it",
                quoted(key)));
    }
    return mesh;
}

}  // namespace noli::detail
