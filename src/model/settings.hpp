// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What half-spaces and settings of a scene become in a model whose bodies are there.

#include "noli/scene.hpp"

#include "model/model.hpp"

#include <cstddef>
#include <vector>

namespace noli {

void add_planes(const Scene& scene, Model& model);

/// Who may touch whom, and with what friction. source_body[b]: index in scene.bodies of
/// what body b is a copy of. The planes are there already.
void set_contact_rules(const Scene& scene,
                       const std::vector<std::size_t>& source_body,
                       Model& model);

/// Masses, the diagonal, and the lengths and speeds that are relative to it.
void resolve_scales(const Scene& scene, Model& model);

}  // namespace noli
