// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "mesh/implicit.hpp"

namespace noli::detail {

/// Moves the vertices of a tetrahedral mesh of the body one after the other to where the
/// worst element around them is better; surface vertices stay on f = 0.
///
/// In:      edge   mean edge length, m
void smooth(Mesh& mesh, const ImplicitBody& body, double edge, int sweeps);

}  // namespace noli::detail
