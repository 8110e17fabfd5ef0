// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How far the vertices of the surface are from a pool's reference and how far a motion
/// takes them: what decides whether a pool will do (candidate_pool.hpp).

#include "contact/collision_mesh.hpp"
#include "core/view.hpp"
#include "exec/later.hpp"

#include <cmath>

namespace noli {

/// Numbers on their way from the executor, lengths in m, along all of p.
struct QueryReach {
    Later displaced;     ///< largest distance from the pool's reference
    Later travel;        ///< largest |p|
    Later long_travels;  ///< vertices that travel too far for a pool
    Later far;           ///< vertices that go farther than the pool's margin
    Later coordinate;    ///< largest
    Later edge_lengths;  ///< sum over the edges
};

namespace detail {

/// Largest distance of a vertex of the surface from the reference, m.
template <class Exec>
Later largest_displacement(Exec& exec,
                           View<const int> vertices,
                           View<const Vec3d> reference,
                           View<const Vec3d> x) {
    return exec.max_later(
        "contact/largest_displacement", vertices.size, [=] NOLI_HD(int i) {
            return norm(x[vertices[i]] - reference[vertices[i]]);
        });
}

/// Largest |p| of a vertex of the surface, m; 0 where p is empty.
template <class Exec>
Later largest_travel(Exec& exec, View<const int> vertices, View<const Vec3d> p) {
    return exec.max_later("contact/largest_travel",
                          p.size > 0 ? vertices.size : 0,
                          [=] NOLI_HD(int i) { return norm(p[vertices[i]]); });
}

/// How many vertices of the surface move by more than `most` (m) along p; 0 where p is
/// empty.
template <class Exec>
Later count_long_travels(Exec& exec,
                         View<const int> vertices,
                         View<const Vec3d> p,
                         double most) {
    return exec.sum_later(
        "contact/long_travels", p.size > 0 ? vertices.size : 0, [=] NOLI_HD(int i) {
            return norm(p[vertices[i]]) <= most ? 0.0 : 1.0;
        });
}

/// How many vertices of the surface are displaced from the reference and travel along p
/// (may be empty) by more than `most` (m) in all.
template <class Exec>
Later count_far(Exec& exec,
                View<const int> vertices,
                View<const Vec3d> reference,
                View<const Vec3d> x,
                View<const Vec3d> p,
                double most) {
    return exec.sum_later("contact/far_vertices", vertices.size, [=] NOLI_HD(int i) {
        const int v = vertices[i];
        const double travel = p.size > 0 ? norm(p[v]) : 0.0;
        return norm(x[v] - reference[v]) + travel <= most ? 0.0 : 1.0;
    });
}

/// Largest coordinate of a vertex of the surface, m.
template <class Exec>
Later largest_coordinate(Exec& exec, View<const int> vertices, View<const Vec3d> x) {
    return exec.max_later("contact/largest_coordinate",
                          vertices.size,
                          [=] NOLI_HD(int i) { return max_abs(x[vertices[i]]); });
}

template <class Exec>
Later sum_of_lengths(Exec& exec, View<const double> length_sq) {
    return exec.sum_later("contact/edge_lengths", length_sq.size, [=] NOLI_HD(int e) {
        return std::sqrt(length_sq[e]);
    });
}

}  // namespace detail

}  // namespace noli
