// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The named animations of IPC scripts, by what they move.
///
/// Motion that depends on where things are (planes that turn back, a bed that stops) is
/// known in advance, because prescribed vertices go where they are told: it is played
/// through here, step by step.

#include "scene/ipc_script_data.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace noli {

/// What an animation works on.
struct AnimationStage {
    Script& script;
    const std::vector<PlacedShape>& shapes;
    Scene& scene;
    Vector3 lo{}, hi{};  ///< box of all shapes, m

    AnimationStage(Script& from, const std::vector<PlacedShape>& placed, Scene& into);

    [[nodiscard]] Body& body_of(const PlacedShape& placed) const {
        return scene.bodies[placed.body];
    }
    [[nodiscard]] double range_x() const { return hi[0] - lo[0]; }
    /// Throws ScriptFailure if there are fewer.
    void need_shapes(std::size_t count) const;
    void warn(const ScriptWords& place, const std::string& message) const {
        script.warnings.push_back({place.where(), message});
    }
    /// A time before that of step `steps` (counted from 0) and after that of the one
    /// before it, whatever their rounding, s.
    [[nodiscard]] double before_step(int steps) const { return (steps - 0.5) * scene.dt; }
};

// Handles: the vertices at the ends along x.
void twist_handles(const AnimationStage& stage);
void drag_handles_right(const AnimationStage& stage);
void stretch_and_pause_handles(const AnimationStage& stage);

// Obstacles that move.
void rotate_cylinders(const AnimationStage& stage);
/// Six planes close in from +-x, +-y, +-z and turn back whenever the first two come
/// close.
void squash_six(const AnimationStage& stage);
/// The obstacles of the second half of the list come down until they are near the first
/// half.
void squash_bed(const AnimationStage& stage);

}  // namespace noli
