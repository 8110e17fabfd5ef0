// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "model/model.hpp"

#include <array>
#include <vector>

namespace noli {

/// Cauchy stress (row-major, Pa) and von Mises stress (Pa) of every tetrahedron, in
/// mesh-file order.
void tet_stresses(const Model& model,
                  const std::vector<Vec3d>& x,
                  std::vector<std::array<double, 9>>& stress,
                  std::vector<double>& von_mises_out);

}  // namespace noli
