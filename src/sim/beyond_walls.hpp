// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Words for vertices that half-spaces and containers forbid to be where they are, and
/// for what is closer than contact.min_separation.

#include "noli/simulator.hpp"

#include "contact/intersections.hpp"
#include "contact/min_gap.hpp"
#include "model/model.hpp"

#include <string>
#include <vector>

namespace noli {

/// `hits` by body and wall, in their order.
std::vector<BeyondWall> beyond_walls(const Model& model,
                                     const std::vector<VertexBehindWall>& hits,
                                     const std::vector<Vec3d>& x);

/// The pair, its distance, and what to do.
std::string describe_too_close(const Model& model, const MinGap& pair);

/// Of the first wall, and how many others there are; empty if there is none.
std::string describe_beyond_walls(const std::vector<BeyondWall>& found);

}  // namespace noli
