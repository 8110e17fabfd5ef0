// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "linear/block_pattern.hpp"
#include "model/model.hpp"

#include <cstddef>
#include <string>

namespace noli {

struct CudaDevice;
struct EngineInput;

/// Memory that a run of this model will need, MB: the large arrays, counted, plus a share
/// for contacts that grows with the surface.
inline double estimate_megabytes(const Model& model) {
    const double tets = model.num_tets();
    const double vertices = model.num_vertices;
    const double surface =
        static_cast<double>(model.triangles.size() + model.edges.size());
    const double shape = 9 * 8 + 3 * 8 + 16;
    const double per_tet = 3 * shape + 24 + 4 * 24   // model, loops, groups; corners
                         + 10 * 6 + 10 * 2 + 3 * 8;  // lists of the gather and the sums
    const double per_vertex = 15 * (72 + 8) + 30 * 24;  // block rows, vectors
    const double per_primitive = 400;                   // trees, candidates, pairs
    return 20.0
         + 1e-6 * (tets * per_tet + vertices * per_vertex + surface * per_primitive);
}

/// Bytes of device memory that a run will need: the arrays of known size, counted, and
/// what a surface in contact takes, by experience. Buffers have room to grow.
std::size_t estimate_device_bytes(const Model& model,
                                  const BlockPattern& pattern,
                                  bool has_stiffness_damping);

/// A sentence with numbers and a cure if that is more than the device has free, else
/// empty.
std::string device_memory_trouble(const EngineInput& input,
                                  const CudaDevice& device,
                                  std::size_t free_bytes,
                                  std::size_t total_bytes);

}  // namespace noli
