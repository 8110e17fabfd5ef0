// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Rigid motions of a set of vertices ("node") in the coarse space of the solver: pure
/// functions.
///
/// A node has six unknowns: a translation t (m) and a turn w about its centre, scaled by
/// the node's radius, so that all six move a vertex about as far. The motions of a node
/// that is made of smaller nodes are among those of its parts: the spaces are nested.
///
/// Source: rigid-body modes as a coarse space, [Vanek1996]

#include "core/vec.hpp"

#include <cmath>

namespace noli {

inline constexpr int kRigidModes = 6;

/// About where and at which scale a node turns.
struct RigidFrame {
    Vec3d centre;       ///< mean of its free vertices, m
    double per_radius;  ///< 1 / root mean square distance from it, 1/m; 0: cannot turn
    double count;       ///< of free vertices
};

struct RigidMotion {
    Vec3d t, w;

    [[nodiscard]] NOLI_HD double operator[](int mode) const {
        return mode < 3 ? t[mode] : w[mode - 3];
    }
};

NOLI_HD inline RigidMotion unit_motion(int mode) {
    RigidMotion out{{0, 0, 0}, {0, 0, 0}};
    (mode < 3 ? out.t : out.w)[mode % 3] = 1.0;
    return out;
}

/// Displacement of a vertex at x.
NOLI_HD inline Vec3d displacement(const RigidFrame& frame,
                                  const RigidMotion& motion,
                                  const Vec3d& x) {
    return motion.t + cross(motion.w, frame.per_radius * (x - frame.centre));
}

/// The transpose of `displacement`: what a force at x does to each motion.
NOLI_HD inline RigidMotion generalised_force(const RigidFrame& frame,
                                             const Vec3d& force,
                                             const Vec3d& x) {
    return {force, cross(frame.per_radius * (x - frame.centre), force)};
}

/// Turns of a part per turn of the whole.
NOLI_HD inline double turn_ratio(const RigidFrame& whole, const RigidFrame& part) {
    return part.per_radius > 0.0 ? whole.per_radius / part.per_radius : 0.0;
}

/// A motion of the whole as a motion of one of its parts.
NOLI_HD inline RigidMotion motion_of_part(const RigidFrame& whole,
                                          const RigidMotion& motion,
                                          const RigidFrame& part) {
    return {displacement(whole, motion, part.centre), turn_ratio(whole, part) * motion.w};
}

/// The transpose of `motion_of_part`.
NOLI_HD inline RigidMotion force_on_whole(const RigidFrame& whole,
                                          const RigidMotion& force,
                                          const RigidFrame& part) {
    RigidMotion out = generalised_force(whole, force.t, part.centre);
    out.w += turn_ratio(whole, part) * force.w;
    return out;
}

}  // namespace noli
