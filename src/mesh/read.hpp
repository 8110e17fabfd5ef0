// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Mesh files of the field, in full double precision.

#include "noli/result.hpp"

#include "mesh/mesh.hpp"

#include <string>

namespace noli {

struct ReadOptions {
    /// A .seg or .pt file that is missing or empty takes the edges or vertices of the
    /// .obj file of the same name, as IPC scripts expect.
    bool fall_back_to_obj = true;
    /// Elements are passed over, unread where the format allows it; TetGen needs no .ele.
    bool positions_only = false;
};

/// Reads a mesh; the extension (any case) decides the format:
///
///     .msh          Gmsh 2.2, 4.0, 4.1, ASCII or binary, either byte order;
///                   foreign sections skipped
///     .node .ele    TetGen, numbered from 0 or 1, both files needed; also without
///                   extension ("ball" -> ball.node, ball.ele)
///     .mesh         MEDIT, ASCII
///     .obj          polygons are cut into triangles; "l" lines become segments, "p"
///     lines points .ply .stl     ASCII or binary; STL corners with equal coordinates
///     become one vertex .seg .pt      "v x y z" lines, and "s i j" lines (from 1) in
///     .seg
///
/// Numbers are read to the nearest double. Node numbers may have gaps; vertices keep file
/// order. Errors: FileNotReadable (missing, a directory, no permission) or BadMesh, with
/// file and line (text) or byte (binary). Says nothing about geometry: see check.hpp.
Result<Mesh> read_mesh(const std::string& path, const ReadOptions& options = {});

}  // namespace noli
