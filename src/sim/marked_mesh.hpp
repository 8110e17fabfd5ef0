// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "noli/simulator.hpp"

#include "model/model.hpp"

#include <string>

namespace noli {

/// All surfaces at the start as PLY, triangles that take part in an intersection in red.
Status write_marked_mesh(const std::string& path,
                         const Model& model,
                         const VerifyReport& found);

}  // namespace noli
