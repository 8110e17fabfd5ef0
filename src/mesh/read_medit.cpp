// SPDX-License-Identifier: Apache-2.0
/// MEDIT .mesh, ASCII. Source: P. Frey, "MEDIT: an interactive mesh visualization
/// software", INRIA RT-0253, section on file formats.
#include "mesh/cursor.hpp"
#include "mesh/readers.hpp"

#include <cctype>
#include <fmt/format.h>

namespace noli::detail {

namespace {

bool is_refused(std::string_view keyword) {
    return keyword == "Quadrilaterals" || keyword == "Hexahedra" || keyword == "Hexaedra"
        || keyword == "Prisms" || keyword == "Pyramids"
        || keyword.find("P2") != keyword.npos || keyword.find("P3") != keyword.npos;
}

class MeditReader {
  public:
    MeditReader(const std::string& path, std::string_view bytes)
        : in_(path, bytes, '#') {}

    Mesh read(ReadPart part) {
        read_header();
        for (std::string_view key = in_.token(); !key.empty() && key != "End";
             key = next_keyword()) {
            read_section(key);
            if (part == ReadPart::Positions && have_vertices_) {
                mesh_ = {.x = std::move(mesh_.x)};
                return std::move(mesh_);
            }
        }
        if (!have_vertices_)
            in_.fail(
                "the file has no Vertices section; it is truncated or holds no mesh: "
                "write it again");
        check_early(mesh_.tets, "tetrahedra");
        check_early(mesh_.triangles, "triangles");
        check_early(mesh_.segments, "edges");
        return std::move(mesh_);
    }

  private:
    void read_header() {
        const std::string_view head = in_.token();
        if (head != "MeshVersionFormatted")
            in_.fail(
                fmt::format("found {}, expected \"MeshVersionFormatted\"; only ASCII "
                            "MEDIT files are read "
                            "as .mesh: convert binary .meshb or other formats",
                            quoted(head)));
        in_.integer("the MEDIT version");
    }

    void read_section(std::string_view key) {
        in_section_ = true;
        if (key == "Dimension") {
            if (const std::int64_t dim = in_.integer("the dimension"); dim != 3)
                in_.fail(fmt::format(
                    "found dimension {}, expected 3; export a three-dimensional mesh",
                    dim));
        } else if (key == "Vertices") {
            read_vertices();
        } else if (key == "Tetrahedra") {
            read_elements<4>(mesh_.tets, "tetrahedra");
        } else if (key == "Triangles") {
            read_elements<3>(mesh_.triangles, "triangles");
        } else if (key == "Edges") {
            read_elements<2>(mesh_.segments, "edges");
        } else if (is_refused(key)) {
            if (in_.integer("a count") != 0)
                in_.fail(
                    fmt::format("found {}, expected straight-sided Tetrahedra, Triangles "
                                "and Edges; split "
                                "or mesh them again in the program that wrote the file",
                                key));
        } else if (!std::isalpha(static_cast<unsigned char>(key[0]))) {
            in_.fail(
                fmt::format("found {} where a keyword such as \"Tetrahedra\" was "
                            "expected; a count before "
                            "it is wrong: write the file again",
                            quoted(key)));
        } else {
            in_section_ = false;
        }
    }

    /// Next keyword; the numbers of a section that is not read are passed over.
    std::string_view next_keyword() {
        std::string_view text = in_.token();
        while (!in_section_ && !text.empty()
               && !std::isalpha(static_cast<unsigned char>(text[0])))
            text = in_.token();
        return text;
    }

    void read_vertices() {
        if (have_vertices_)
            in_.fail(
                "found a second Vertices section, expected one; write the file again");
        const int count =
            in_.checked_count(in_.integer("the number of vertices"), 8, "vertices");
        mesh_.x.reserve(static_cast<std::size_t>(count));
        for (int i = 0; i < count; ++i) {
            const double x = in_.number("the x coordinate of a vertex");
            const double y = in_.number("the y coordinate of a vertex");
            const double z = in_.number("the z coordinate of a vertex");
            if (in_.token().empty())  // some writers use numbers with a point
                in_.fail_truncated("the reference of a vertex");
            mesh_.x.push_back({x, y, z});
        }
        have_vertices_ = true;
    }

    [[noreturn]] void fail_corner(std::size_t number,
                                  const char* name,
                                  std::int64_t vertex,
                                  std::size_t num_vertices) const {
        in_.fail(fmt::format(
            "element {} of the {} uses vertex {}, expected 1 to {}; correct the line or "
            "write the file again",
            number,
            name,
            vertex,
            num_vertices));
    }

    /// Corners of elements that stand before the vertices.
    template <class Element>
    void check_early(const std::vector<Element>& elements, const char* name) const {
        for (std::size_t e = 0; has_early_elements_ && e < elements.size(); ++e)
            for (const int v : elements[e].v)
                if (static_cast<std::size_t>(v) >= mesh_.x.size())
                    fail_corner(e + 1, name, v + 1, mesh_.x.size());
    }

    template <int N, class Element>
    void read_elements(std::vector<Element>& out, const char* name) {
        has_early_elements_ |= !have_vertices_;
        const int count =
            in_.checked_count(in_.integer("a count"), std::size_t{2} * N, name);
        out.reserve(out.size() + static_cast<std::size_t>(count));
        const std::int64_t largest =
            have_vertices_ ? static_cast<std::int64_t>(mesh_.x.size()) : INT32_MAX;
        for (int i = 0; i < count; ++i) {
            Element element{};
            for (int k = 0; k < N; ++k) {
                const std::int64_t v = in_.integer("a corner of an element");
                if (v < 1 || v > largest)
                    fail_corner(static_cast<std::size_t>(i) + 1,
                                name,
                                v,
                                static_cast<std::size_t>(largest));
                element[k] = static_cast<int>(v - 1);
            }
            in_.integer("the reference of an element");
            out.push_back(element);
        }
    }

    Cursor in_;
    Mesh mesh_;
    bool have_vertices_ = false;
    bool has_early_elements_ = false;
    bool in_section_ = true;
};

}  // namespace

Mesh read_medit(const std::string& path, std::string_view bytes, ReadPart part) {
    return MeditReader(path, bytes).read(part);
}

}  // namespace noli::detail
