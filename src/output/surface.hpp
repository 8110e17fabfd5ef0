// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Surfaces of a frame as OBJ or PLY: triangles of elastic bodies and obstacles, segments
/// and points of obstacles; vertices inside of tetrahedral bodies are left out.

#include "output/frame.hpp"

#include <string>
#include <vector>

namespace noli {

class SurfaceWriter {
  public:
    /// Picks and renumbers the vertices of the surface once.
    explicit SurfaceWriter(const FrameMesh& mesh);

    /// Wavefront OBJ, text, one object per body, 17 digits.
    [[nodiscard]] std::string encode_obj(const Frame& frame) const;

    /// PLY, binary little-endian, double coordinates and velocities, body_id per vertex.
    [[nodiscard]] std::string encode_ply(const Frame& frame) const;

    [[nodiscard]] int num_vertices() const { return static_cast<int>(vertices_.size()); }

  private:
    std::vector<std::string> body_names_;
    std::vector<int> vertices_;                  ///< of the frame, ascending
    std::vector<int> body_;                      ///< of each vertex
    std::vector<std::array<int, 3>> triangles_;  ///< indices into vertices_
    std::vector<std::array<int, 2>> segments_;
    std::vector<int> points_;
};

}  // namespace noli
