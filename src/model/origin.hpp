// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The point that a model counts places from. Doubles lose digits with the distance from
/// zero, so a scene that lies far away is moved near zero while it is still a
/// description; places that leave the program are moved back (in_world).

#include "noli/scene.hpp"

#include "core/vec.hpp"
#include "model/model.hpp"

#include <vector>

namespace noli {

/// A model whose bodies are farther from zero than this many diagonals of their box gets
/// an origin of its own: up to there rounding takes 1e-12 of a body at most.
inline constexpr double kFarInDiagonals = 1e3;

/// Where the places of such a model should count from, m; zero if that does. Of the
/// elastic bodies, or of all where none is elastic. A multiple of a power of two near
/// their size, so that little is rounded when places are moved by it.
Vec3d local_origin(const Model& model);

/// The scene with everything that has a place in the world moved by -origin: bodies,
/// half-spaces, containers, boxes of selections in the world, centres of rotation and
/// ends of conditions. Sequences are files and stay.
Scene moved_to(const Vec3d& origin, const Scene& scene);

/// A place of the model in the coordinates of the scene, m.
inline Vec3d in_world(const Model& model, const Vec3d& place) {
    return place + model.origin;
}

}  // namespace noli
