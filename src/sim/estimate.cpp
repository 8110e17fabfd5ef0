// SPDX-License-Identifier: Apache-2.0
#include "sim/estimate.hpp"

#include "exec/device_full.hpp"
#include "linear/rigid_levels.hpp"
#include "sim/engine.hpp"

namespace noli {

namespace {

/// A buffer takes a quarter more than it needs when it grows.
constexpr double kRoom = 1.25;
/// What the runtime, its kernels and the scratch memory of sorts and scans take.
constexpr double kFixedBytes = 64e6;

double matrix_bytes(const BlockPattern& pattern) {
    const double blocks = pattern.num_blocks();
    const double upper = pattern.num_upper();
    return blocks * (72 + 4) + upper * 12
         + 4.0 * static_cast<double>(pattern.gather.size()) + 8.0 * pattern.num_rows;
}

/// Shapes and lists, element blocks, corner gradients, one energy.
constexpr double kBytesPerTet = (16 + 72 + 24 + 16) + 90 * 8 + 4 * 24 + 8;

/// 32 vectors, the diagonal blocks and their inverses, lists and scalars.
constexpr double kBytesPerVertex = 32 * 24 + 72 + 48 + 64;

/// Boxes, orders and search slots; eight candidates (pair, sort keys, code, bound).
constexpr double kBytesPerPrimitive = 180 + 8 * 72;

/// One pair per surface vertex: modes, gradients, slots and their sort. Boxes of the
/// vertices, standing and moving, plain and grown.
constexpr double kBytesPerSurfaceVertex = 3 * 96 + 96 + 16 + 4 * 52 + 144;

/// Dense inverses of the coarse levels (linear/rigid_coarse.hpp).
double coarse_bytes(int num_vertices) {
    const double nodes = static_cast<double>(num_vertices) / aggregate_size(num_vertices);
    constexpr double kBlock = 96.0 * 96.0 * 8.0;
    constexpr double kLast = 36.0 * kMostDenseNodes * kMostDenseNodes * 8.0;
    const double last =
        nodes > kMostDenseNodes ? 9.0 * kLast : 2.0 * 36.0 * 8.0 * nodes * nodes;
    return last + (nodes > kMostDenseNodes ? nodes / kNodesPerBlock * kBlock : 0.0);
}

}  // namespace

std::size_t estimate_device_bytes(const Model& model,
                                  const BlockPattern& pattern,
                                  bool has_stiffness_damping) {
    const double matrices = matrix_bytes(pattern) * (has_stiffness_damping ? 2.0 : 1.0);
    const double primitives = static_cast<double>(
        model.triangles.size() + model.edges.size() + model.surface_vertices.size());
    const double contact =
        primitives * kBytesPerPrimitive
        + static_cast<double>(model.surface_vertices.size()) * kBytesPerSurfaceVertex;
    const double arrays = matrices + model.num_tets() * kBytesPerTet
                        + model.num_vertices * kBytesPerVertex + contact
                        + coarse_bytes(model.num_vertices);
    return static_cast<std::size_t>(kRoom * arrays + kFixedBytes);
}

std::string device_memory_trouble(const EngineInput& input,
                                  const CudaDevice& device,
                                  std::size_t free_bytes,
                                  std::size_t total_bytes) {
    const std::size_t needed =
        device.stack_bytes
        + estimate_device_bytes(
            input.model, input.pattern, input.settings.damping.stiffness > 0.0);
    if (needed <= free_bytes) return "";
    return "not enough memory on " + device.name + ": this scene needs about "
         + megabytes(needed) + ", " + megabytes(free_bytes) + " of "
         + megabytes(total_bytes)
         + " are free; end what else runs there or use a coarser mesh";
}

}  // namespace noli
