// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Mesh files out. Text gets the shortest digits that give the same double back.

#include "noli/result.hpp"

#include "mesh/mesh.hpp"

#include <optional>
#include <string>

namespace noli {

struct WriteOptions {
    bool binary = false;                         ///< .msh and .ply only; little-endian
    enum class Msh { V22, V41 } msh = Msh::V41;  ///< version of .msh files
};

/// Writes by extension: .msh, .mesh, .node or .ele (both files), .obj, .ply, .stl
/// (ASCII), .seg, .pt. Every format keeps doubles exactly and vertices in order (STL: in
/// the order of the triangles). Returns an Error if the format cannot hold the mesh's
/// elements, or the file cannot be written whole; nothing otherwise.
std::optional<Error> write_mesh(const std::string& path,
                                const Mesh& mesh,
                                const WriteOptions& options = {});

}  // namespace noli
