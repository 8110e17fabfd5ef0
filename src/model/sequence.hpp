// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The positions that mesh files prescribe step by step.

#include "noli/result.hpp"

#include "model/model.hpp"

#include <string>

namespace noli {

/// Fills ModelCondition::sequence of all conditions. The bodies and their tetrahedra are
/// there already. Each file is read once however many copies, conditions and steps take
/// it, and only its vertices are looked at. Errors: FileNotReadable; BadMesh where the
/// number of vertices is not that of the body, or a frame turns a tetrahedron inside out.
Status load_sequences(const std::string& base_folder, Model& model);

}  // namespace noli
