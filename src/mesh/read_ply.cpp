// SPDX-License-Identifier: Apache-2.0
/// PLY: vertices (x y z of any number type), faces (vertex_indices) and edges (vertex1
/// vertex2), ASCII or binary in either byte order; other elements and properties are
/// passed over. Source: G. Turk, "The PLY polygon file format", 1994.
#include "mesh/cursor.hpp"
#include "mesh/readers.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>

namespace noli::detail {

namespace {

enum class Type { I8, U8, I16, U16, I32, U32, F32, F64 };

struct Property {
    std::string name;
    Type type = Type::F64;
    bool is_list = false;
    Type count_type = Type::U8;  ///< of a list's length
};

struct Element {
    std::string name;
    std::int64_t count = 0;
    std::vector<Property> properties;
};

class PlyReader {
  public:
    PlyReader(const std::string& path, std::string_view bytes) : in_(path, bytes) {}

    Mesh read(ReadPart part) {
        read_header();
        for (const Element& element : elements_) {
            read_element(element);
            if (part == ReadPart::Positions && element.name == "vertex")
                return {.x = std::move(mesh_.x)};
        }
        check_corners();
        mesh_.triangles = triangulated(mesh_.x, polygons_);
        return std::move(mesh_);
    }

  private:
    void read_header();
    void read_format();
    void read_property();
    [[nodiscard]] Type parse_type(std::string_view text) const;
    void check_header() const;
    void read_element(const Element& element);
    void read_vertex(const Element& element);
    void read_face(const Element& element);
    void read_edge(const Element& element);
    double read_scalar(Type type, const std::string& name);
    std::int64_t read_index(Type type, const std::string& name);
    std::int64_t read_list_length(const Property& property);
    void skip(const Property& property);
    void check_corners() const;

    Cursor in_;
    Mesh mesh_;
    bool has_format_ = false, ascii_ = true, swap_ = false;
    std::vector<Element> elements_;
    Polygons polygons_;
};

void PlyReader::read_header() {
    in_.next_line();
    if (const std::string_view magic = in_.token_in_line(); magic != "ply")
        in_.fail(fmt::format(
            "found {}, expected \"ply\"; this is no PLY file: check its extension",
            quoted(magic)));
    while (in_.next_line()) {
        const std::string_view key = in_.token_in_line();
        if (key == "end_header") {
            check_header();
            in_.skip_line();
            return;
        }
        if (key == "format") {
            read_format();
        } else if (key == "element") {
            const std::string name(in_.token_in_line());
            elements_.push_back(
                {name, in_.parse_integer(in_.token_in_line(), "an element count"), {}});
        } else if (key == "property" && !elements_.empty()) {
            read_property();
        } else if (key != "comment" && key != "obj_info") {
            in_.fail(
                fmt::format("found {} in the header, expected format, element, property, "
                            "comment or end_header; correct the line",
                            quoted(key)));
        }
    }
    in_.fail_truncated("\"end_header\"");
}

/// Comments may stand before this line, and elements too.
void PlyReader::read_format() {
    if (has_format_)
        in_.fail("found a second format line, expected one; remove the wrong one");
    has_format_ = true;
    const std::string_view format = in_.token_in_line();
    constexpr bool kLittle = std::endian::native == std::endian::little;
    if (format == "binary_little_endian" || format == "binary_big_endian") {
        ascii_ = false;
        swap_ = (format == "binary_little_endian") != kLittle;
    } else if (format != "ascii") {
        in_.fail(fmt::format(
            "found format {}, expected ascii, binary_little_endian or binary_big_endian; "
            "write the file again",
            quoted(format)));
    }
}

Type PlyReader::parse_type(std::string_view text) const {
    constexpr std::string_view kNames[][2] = {{"char", "int8"},
                                              {"uchar", "uint8"},
                                              {"short", "int16"},
                                              {"ushort", "uint16"},
                                              {"int", "int32"},
                                              {"uint", "uint32"},
                                              {"float", "float32"},
                                              {"double", "float64"}};
    for (int i = 0; i < 8; ++i)
        if (text == kNames[i][0] || text == kNames[i][1]) return static_cast<Type>(i);
    in_.fail(
        fmt::format("found property type {}, expected char, uchar, short, ushort, int, "
                    "uint, float or "
                    "double; correct the header",
                    quoted(text)));
}

void PlyReader::read_property() {
    Property property;
    std::string_view text = in_.token_in_line();
    if (text == "list") {
        property.is_list = true;
        property.count_type = parse_type(in_.token_in_line());
        text = in_.token_in_line();
    }
    property.type = parse_type(text);
    property.name = in_.token_in_line();
    elements_.back().properties.push_back(property);
}

void PlyReader::check_header() const {
    if (!has_format_)
        in_.fail(
            "the header ends without a format line, expected one such as \"format ascii "
            "1.0\"; add it or write the file again");
    bool has_vertices = false;
    for (const Element& element : elements_) {
        if (element.name == "tristrips" && element.count > 0)
            in_.fail(
                "found triangle strips, expected faces; export the mesh as plain "
                "triangles");
        if (element.properties.empty() && element.count > 0)
            in_.fail(fmt::format(
                "element {} has no properties, expected at least one; correct the header",
                quoted(element.name)));
        if (element.name != "vertex") continue;
        has_vertices = true;
        for (const char* name : {"x", "y", "z"})
            if (std::none_of(
                    element.properties.begin(),
                    element.properties.end(),
                    [&](const Property& p) { return p.name == name && !p.is_list; }))
                in_.fail(
                    fmt::format("the vertices have no property {}, expected x, y and z; "
                                "correct the header",
                                name));
    }
    if (!has_vertices)
        in_.fail(
            "the header has no \"element vertex\", expected vertices; write the file "
            "again");
}

void PlyReader::read_element(const Element& element) {
    if (!ascii_) in_.set_binary(swap_);
    const std::size_t min_bytes = element.properties.size() * (ascii_ ? 2 : 1);
    const int count = in_.checked_count(element.count, min_bytes, element.name);
    for (int i = 0; i < count; ++i) {
        if (element.name == "vertex") {
            read_vertex(element);
        } else if (element.name == "face") {
            read_face(element);
        } else if (element.name == "edge") {
            read_edge(element);
        } else {
            for (const Property& property : element.properties)
                skip(property);
        }
    }
}

double PlyReader::read_scalar(Type type, const std::string& name) {
    if (ascii_) return in_.number(name);
    switch (type) {
        case Type::I8:
            return in_.take<std::int8_t>(name);
        case Type::U8:
            return in_.take<std::uint8_t>(name);
        case Type::I16:
            return in_.take<std::int16_t>(name);
        case Type::U16:
            return in_.take<std::uint16_t>(name);
        case Type::I32:
            return in_.take<std::int32_t>(name);
        case Type::U32:
            return in_.take<std::uint32_t>(name);
        case Type::F32:
            return in_.take<float>(name);
        case Type::F64:
            break;
    }
    return in_.take<double>(name);
}

std::int64_t PlyReader::read_index(Type type, const std::string& name) {
    const double value = read_scalar(type, name);
    if (value != std::floor(value) || std::fabs(value) > 4e9)
        in_.fail(
            fmt::format("found {} as {}, expected a whole number; write the file again",
                        value,
                        name));
    return static_cast<std::int64_t>(value);
}

std::int64_t PlyReader::read_list_length(const Property& property) {
    const std::int64_t length =
        read_index(property.count_type, "the length of list " + property.name);
    return in_.checked_count(length, ascii_ ? 2 : 1, "entries of list " + property.name);
}

void PlyReader::skip(const Property& property) {
    const std::int64_t count = property.is_list ? read_list_length(property) : 1;
    for (std::int64_t k = 0; k < count; ++k)
        if (!ascii_)
            read_scalar(property.type, property.name);
        else if (in_.token().empty())
            in_.fail_truncated(property.name);
}

void PlyReader::read_vertex(const Element& element) {
    Vec3d x{0, 0, 0};
    for (const Property& property : element.properties) {
        const bool is_coordinate =
            property.name == "x" || property.name == "y" || property.name == "z";
        if (is_coordinate && !property.is_list)
            x[property.name[0] - 'x'] = in_.checked_finite(
                read_scalar(property.type, property.name), property.name);
        else
            skip(property);
    }
    mesh_.x.push_back(x);
}

void PlyReader::read_face(const Element& element) {
    for (const Property& property : element.properties) {
        const bool is_corners =
            property.name == "vertex_indices" || property.name == "vertex_index";
        if (!is_corners || !property.is_list) {
            skip(property);
            continue;
        }
        const std::int64_t count = read_list_length(property);
        if (count < 3)
            in_.fail(fmt::format(
                "found a face with {} corners, expected 3 or more; correct or remove it",
                count));
        for (std::int64_t k = 0; k < count; ++k) {
            const std::int64_t corner = read_index(property.type, property.name);
            polygons_.corners.push_back(
                corner < 0 || corner > INT32_MAX ? -1 : static_cast<int>(corner));
        }
        polygons_.close();
    }
}

void PlyReader::read_edge(const Element& element) {
    Int2 edge{-1, -1};
    for (const Property& property : element.properties) {
        if (property.is_list
            || (property.name != "vertex1" && property.name != "vertex2")) {
            skip(property);
            continue;
        }
        const std::int64_t v = read_index(property.type, property.name);
        edge[property.name == "vertex2"] =
            v < 0 || v > INT32_MAX ? -1 : static_cast<int>(v);
    }
    mesh_.segments.push_back(edge);
}

/// Faces may stand before vertices in the header, so this comes last.
void PlyReader::check_corners() const {
    const auto num_vertices = static_cast<int>(mesh_.x.size());
    const auto check = [&](int v, const char* what, std::size_t index) {
        if (v >= 0 && v < num_vertices) return;
        throw ReadFailure{
            {Error::Code::BadMesh,
             in_.path(),
             fmt::format("{} {} (from 0) uses vertex {}, expected 0 to {}; correct it or "
                         "write the "
                         "file again",
                         what,
                         index,
                         v < 0 ? "of an impossible number" : std::to_string(v),
                         num_vertices - 1)}};
    };
    for (std::size_t f = 0; f + 1 < polygons_.first.size(); ++f)
        for (int k = polygons_.first[f]; k < polygons_.first[f + 1]; ++k)
            check(polygons_.corners[static_cast<std::size_t>(k)], "face", f);
    for (std::size_t e = 0; e < mesh_.segments.size(); ++e)
        for (const int v : mesh_.segments[e].v)
            check(v, "edge", e);
}

}  // namespace

Mesh read_ply(const std::string& path, std::string_view bytes, ReadPart part) {
    return PlyReader(path, bytes).read(part);
}

}  // namespace noli::detail
