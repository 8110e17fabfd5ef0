// SPDX-License-Identifier: Apache-2.0
/// STL repeats the corners of every triangle; corners with equal coordinates become one
/// vertex.
#include "mesh/cursor.hpp"
#include "mesh/readers.hpp"
#include "mesh/topology.hpp"

#include <bit>
#include <fmt/format.h>

namespace noli::detail {

namespace {

constexpr std::size_t kHeaderBytes = 84;    // 80 of text, 4 of count
constexpr std::size_t kTriangleBytes = 50;  // normal, three corners, attribute

/// Three corners per triangle -> shared vertices, in the order of their first use.
Mesh merged(const std::vector<Vec3d>& corners) {
    const std::vector<int> first = first_equal_vertex(corners);
    std::vector<int> index(corners.size());
    Mesh mesh;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const auto original = static_cast<std::size_t>(first[i]);
        if (original == i) {
            index[i] = static_cast<int>(mesh.x.size());
            mesh.x.push_back(corners[i]);
        } else {
            index[i] = index[original];
        }
    }
    for (std::size_t i = 0; i < corners.size(); i += 3)
        mesh.triangles.push_back({index[i], index[i + 1], index[i + 2]});
    return mesh;
}

void expect(Cursor& in, std::string_view word) {
    const std::string_view found = in.token();
    if (found.empty()) in.fail_truncated(word);
    if (found != word)
        in.fail(fmt::format(
            "found {}, expected \"{}\"; correct the line or write the file again",
            quoted(found),
            word));
}

Mesh read_ascii(const std::string& path, std::string_view bytes) {
    Cursor in(path, bytes);
    std::vector<Vec3d> corners;
    while (in.next_line()) {  // "solid" may be followed by a name of several words
        expect(in, "solid");
        in.skip_line();
        std::string_view word = in.token();
        for (; word == "facet"; word = in.token()) {
            expect(in, "normal");
            for (int k = 0; k < 3; ++k)
                in.token();  // recomputed; some writers leave nan here
            expect(in, "outer");
            expect(in, "loop");
            for (int k = 0; k < 3; ++k) {
                expect(in, "vertex");
                const double x = in.number("the x coordinate of a corner");
                const double y = in.number("the y coordinate of a corner");
                const double z = in.number("the z coordinate of a corner");
                corners.push_back({x, y, z});
            }
            expect(in, "endloop");
            expect(in, "endfacet");
        }
        if (word.empty()) in.fail_truncated("\"endsolid\"");
        if (word != "endsolid")
            in.fail(fmt::format(
                "found {}, expected \"facet\" or \"endsolid\"; correct the line",
                quoted(word)));
    }
    return merged(corners);
}

Mesh read_binary(const std::string& path, std::string_view bytes) {
    Cursor in(path, bytes);
    constexpr bool kSwap =
        std::endian::native == std::endian::big;  // STL is little-endian
    in.set_binary(kSwap);
    in.skip_bytes(kHeaderBytes - 4, "the 80-byte header of a binary STL file");
    const int count = in.checked_count(
        in.take<std::uint32_t>("the number of triangles"), kTriangleBytes, "triangles");
    std::vector<Vec3d> corners;
    corners.reserve(3 * static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        in.skip_bytes(12, "the normal of a triangle");
        for (int k = 0; k < 3; ++k) {
            Vec3d x{};
            for (int axis = 0; axis < 3; ++axis)
                x[axis] =
                    in.checked_finite(in.take<float>("a coordinate"), "a coordinate");
            corners.push_back(x);
        }
        in.skip_bytes(2, "the attribute of a triangle");
    }
    return merged(corners);
}

/// Binary headers may begin with "solid" too; then the size of the file tells.
bool is_binary(std::string_view bytes) {
    const std::size_t start = std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size());
    if (bytes.substr(start, 5) != "solid") return true;
    if (bytes.size() < kHeaderBytes) return false;
    std::uint32_t count = 0;
    for (std::size_t k = 0; k < 4; ++k)
        count |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[80 + k]))
              << (8 * k);
    return bytes.size() == kHeaderBytes + kTriangleBytes * count;
}

}  // namespace

Mesh read_stl(const std::string& path, std::string_view bytes) {
    return is_binary(bytes) ? read_binary(path, bytes) : read_ascii(path, bytes);
}

}  // namespace noli::detail
