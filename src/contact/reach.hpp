// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Whether a motion is large enough to bring two primitives close.
///
/// Where the distance at the start is gap + travel or more, travel being how far both
/// primitives move at most, they do not get closer than gap. Newton's later directions
/// are short: then this leaves almost nothing but what touches.

#include "contact/moving_box.hpp"
#include "geometry/plain_distance.hpp"

namespace noli {

/// Distance of two primitives at positions x, m: see plain_distance.hpp.
NOLI_HD inline double plain_distance(View<const Vec3d> x,
                                     int vertex,
                                     const Int3& triangle) {
    return std::sqrt(plain_point_triangle_sq(
        x[vertex], x[triangle[0]], x[triangle[1]], x[triangle[2]]));
}
NOLI_HD inline double plain_distance(View<const Vec3d> x, const Int2& a, const Int2& b) {
    return std::sqrt(plain_edge_edge_sq(x[a[0]], x[a[1]], x[b[0]], x[b[1]]));
}

/// Largest coordinate difference between the points of a pair and its first one, m.
template <class IdsA, class IdsB>
NOLI_HD inline double size_of_pair(View<const Vec3d> x, const IdsA& a, const IdsB& b) {
    const Vec3d& origin = x[corner(a, 0)];
    double size = 0.0;
    for (int k = 1; k < kNumCorners<IdsA>; ++k)
        size = larger(size, max_abs(x[corner(a, k)] - origin));
    for (int k = 0; k < kNumCorners<IdsB>; ++k)
        size = larger(size, max_abs(x[corner(b, k)] - origin));
    return size;
}

/// How far the points of a primitive move at most besides a common motion, m.
template <class Ids>
NOLI_HD inline double travel_of(const Motion& motion,
                                const Ids& ids,
                                const Vec3d& common) {
    double travel_sq = 0.0;
    for (int k = 0; k < kNumCorners<Ids>; ++k) {
        const double sq = norm_sq(motion.p[corner(ids, k)] - common);
        travel_sq = sq > travel_sq ? sq : travel_sq;
    }
    return motion.alpha * std::sqrt(travel_sq);
}

/// By how much the distance of two primitives shrinks at most along the motion, m: the
/// sum of what both travel, or of what they travel besides their mean motion.
template <class IdsA, class IdsB>
NOLI_HD inline double travel_of_pair(const Motion& motion, const IdsA& a, const IdsB& b) {
    if (motion.p.size == 0) return 0.0;
    Vec3d mean{0.0, 0.0, 0.0};
    for (int k = 0; k < kNumCorners<IdsA>; ++k)
        mean += motion.p[corner(a, k)];
    for (int k = 0; k < kNumCorners<IdsB>; ++k)
        mean += motion.p[corner(b, k)];
    mean = (1.0 / (kNumCorners<IdsA> + kNumCorners<IdsB>)) * mean;
    const Vec3d none{0.0, 0.0, 0.0};
    const double all = travel_of(motion, a, none) + travel_of(motion, b, none);
    const double besides = travel_of(motion, a, mean) + travel_of(motion, b, mean);
    return besides < all ? besides : all;
}

/// False only if the motion is too short to bring the two closer than gap.
template <class IdsA, class IdsB>
NOLI_HD inline bool within_reach(const Motion& motion,
                                 const IdsA& a,
                                 const IdsB& b,
                                 double gap) {
    const double travel = travel_of_pair(motion, a, b);
    const double room = kPlainError * size_of_pair(motion.x, a, b);
    return !(plain_distance(motion.x, a, b) >= gap + travel + room);
}

}  // namespace noli
