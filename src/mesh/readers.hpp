// SPDX-License-Identifier: Apache-2.0
#pragma once
/// One function per file format. Each takes the path (for messages) and the bytes of the
/// file, and throws ReadFailure; read.cpp picks one by extension.

#include "mesh/mesh.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace noli::detail {

/// What is wanted of a file: elements that are not wanted are not parsed, except where
/// they stand before the vertices.
enum class ReadPart { All, Positions };

Mesh read_msh(const std::string& path, std::string_view bytes, ReadPart part);
Mesh read_medit(const std::string& path, std::string_view bytes, ReadPart part);
Mesh read_obj(const std::string& path, std::string_view bytes, ReadPart part);
Mesh read_ply(const std::string& path, std::string_view bytes, ReadPart part);
Mesh read_stl(const std::string& path, std::string_view bytes);
/// "v" and "s" lines; an empty Mesh when the text has neither.
Mesh read_seg(const std::string& path, std::string_view bytes);
/// "v" lines.
Mesh read_pt(const std::string& path, std::string_view bytes);

/// The two files of a TetGen mesh.
struct TetgenFiles {
    std::string node, ele;
};
/// Those that "ball.node", "ball.ele" or "ball" stand for, in the case of letters in
/// which they are there.
TetgenFiles tetgen_files(const std::string& path);
/// Needs both files; of positions only the first.
Mesh read_tetgen(const TetgenFiles& files, ReadPart part);

/// Polygons with any number of corners, as surface files store them.
struct Polygons {
    std::vector<int> corners;  ///< vertex indices of all polygons, one after the other
    std::vector<int> first = {0};  ///< polygon i has corners first[i] .. first[i+1]-1

    void close() { first.push_back(static_cast<int>(corners.size())); }
};

/// Cuts the polygons into triangles of the same orientation: n - 2 each. Flat concave
/// polygons are cut inside; where no such cut is found (self-crossing outline) the
/// polygon becomes a fan.
std::vector<Int3> triangulated(const std::vector<Vec3d>& x, const Polygons& polygons);

}  // namespace noli::detail
