// SPDX-License-Identifier: Apache-2.0
#pragma once
/// One function per file format. Each takes the path (for messages) and the bytes of the
/// file, and throws ReadFailure; read.cpp picks one by extension.

#include "mesh/mesh.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace noli::detail {

Mesh read_msh(const std::string& path, std::string_view bytes);
Mesh read_medit(const std::string& path, std::string_view bytes);
Mesh read_obj(const std::string& path, std::string_view bytes);
Mesh read_ply(const std::string& path, std::string_view bytes);
Mesh read_stl(const std::string& path, std::string_view bytes);
/// "v" and "s" lines; an empty Mesh when the text has neither.
Mesh read_seg(const std::string& path, std::string_view bytes);
/// "v" lines.
Mesh read_pt(const std::string& path, std::string_view bytes);

/// base.node and, if it exists or is required, base.ele.
Mesh read_tetgen(const std::string& base, bool need_tets);

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
