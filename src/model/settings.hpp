// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What half-spaces and settings of a scene become in a model whose bodies are there.

#include "noli/scene.hpp"

#include "model/model.hpp"

#include <cstddef>
#include <vector>

namespace noli {

/// The length scale of a scene is at most that many diagonals of its smallest elastic
/// body: how far bodies are apart says nothing about how exactly they are to move.
inline constexpr double kMostBodies = 100.0;
/// A relative dhat is at most these shares of the smallest elastic body's diagonal and of
/// its short edges: from there on a body's own contact acts at rest.
inline constexpr double kDhatOfBody = 0.02, kDhatOfEdge = 0.25;

void add_walls(const Scene& scene, Model& model);

/// Who may touch whom, and with what friction. source_body[b]: index in scene.bodies of
/// what body b is a copy of. The walls are there already.
void set_contact_rules(const Scene& scene,
                       const std::vector<std::size_t>& source_body,
                       Model& model);

/// Masses, the diagonal, and the lengths and speeds that are relative to it.
void resolve_scales(const Scene& scene, Model& model);

}  // namespace noli
