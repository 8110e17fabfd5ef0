// SPDX-License-Identifier: Apache-2.0
#pragma once
/// VTK XML files: one UnstructuredGrid (.vtu) per frame and a collection (.pvd) of them,
/// as ParaView reads them. Arrays are inline base64 of zlib blocks, doubles throughout.

#include "output/frame.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace noli {

/// Cells in this order: all tetrahedra, triangles of bodies without tetrahedra, segments,
/// points.
class VtuWriter {
  public:
    /// Encodes what stays the same once. The mesh's arrays must outlive the writer.
    explicit VtuWriter(const FrameMesh& mesh);

    /// The text of the .vtu file.
    [[nodiscard]] std::string encode(const Frame& frame) const;

  private:
    [[nodiscard]] std::string point_data(const Frame& frame) const;
    [[nodiscard]] std::string cell_data(const Frame& frame) const;

    FrameMesh mesh_;
    int num_cells_ = 0;
    std::string cells_;          ///< the <Cells> element
    std::string point_body_id_;  ///< DataArray elements
    std::string cell_body_id_;
};

/// One line of a collection.
struct PvdEntry {
    double time = 0.0;  ///< s
    std::string file;   ///< relative to the .pvd file
};

/// The text of the .pvd file.
std::string encode_pvd(const std::vector<PvdEntry>& entries);

/// `bytes` cut into blocks, each zlib-compressed, with VTK's header of UInt64 block
/// sizes; both in base64: what stands inside a DataArray of format "binary".
std::string encode_vtk_blocks(std::string_view bytes);

std::string encode_base64(std::string_view bytes);

}  // namespace noli
