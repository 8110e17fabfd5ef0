// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Tetrahedra inside any smooth closed surface that a function describes.

#include "mesh/mesh.hpp"

#include <functional>

namespace noli {

/// A body { x : f(x) > 0 } inside the box lo..hi. f is smooth near its zero set.
struct ImplicitBody {
    std::function<double(const Vec3d&)> f;
    Vec3d lo, hi;  ///< m
};

/// Number of tetrahedra that tetrahedralized() makes if the body fills its box.
double estimated_tets(const ImplicitBody& body, double edge_length);

/// A body-centred cubic lattice, cut along the surface, then smoothed: positive
/// tetrahedra with good angles, surface vertices on f = 0. Details thinner than about two
/// edges are lost. Source:  [Labelle2007] section 3 (the lattice, the warp of vertices
/// close to the surface), the
///          choice of diagonals and the smoothing are ours.
/// In:      edge_length   wished edge length, m, > 0
/// Out:     empty if no lattice vertex lies inside
Mesh tetrahedralized(const ImplicitBody& body, double edge_length);

}  // namespace noli
