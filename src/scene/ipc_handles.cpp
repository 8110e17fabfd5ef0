// SPDX-License-Identifier: Apache-2.0
/// Animations of IPC scripts that move handles: boxes in the world at the ends along x.
#include "scene/ipc_animation.hpp"

#include <algorithm>
#include <cmath>

namespace noli {

namespace {

using Kind = BoundaryCondition::Kind;
using Until = BoundaryCondition::Until;

constexpr double kTwistDegrees = 72.0;  // 0.4 pi rad

/// All vertices with x below (or above) the bound, which itself does not belong to it.
Selection beyond(const AnimationStage& stage, double bound, bool above) {
    Selection selection;
    selection.kind = Selection::Kind::Box;
    selection.frame = Selection::Frame::World;
    for (std::size_t k = 0; k < 3; ++k) {  // any box around everything will do
        const double margin = 0.5 * (stage.hi[k] - stage.lo[k]) + stage.range_x();
        selection.box_min[k] = stage.lo[k] - margin;
        selection.box_max[k] = stage.hi[k] + margin;
    }
    (above ? selection.box_min : selection.box_max)[0] =
        std::nextafter(bound, above ? kForever : -kForever);
    return selection;
}

/// Adds the condition to every shape that has vertices in its box.
void add_to_handles(const AnimationStage& stage, const BoundaryCondition& condition) {
    for (const PlacedShape& placed : stage.shapes) {
        const Selection& box = condition.selection;
        const bool in_reach =
            placed.hi[0] >= box.box_min[0] && placed.lo[0] <= box.box_max[0];
        const bool selects =
            placed.copies() > 1
                ? in_reach
                : std::any_of(placed.x.begin(), placed.x.end(), [&](const Vec3d& p) {
                      return p.x >= box.box_min[0] && p.x <= box.box_max[0];
                  });
        if (selects) stage.body_of(placed).boundary.push_back(condition);
    }
}

/// Largest x of all meshCO; the handles go on forever without any.
double right_end_of_obstacles(const Script& script) {
    double end = -kForever;
    for (const ScriptObstacle& obstacle : script.obstacles)
        end = std::max(end, obstacle.right_end);
    return script.obstacles.empty() ? 1e6 : end;
}

}  // namespace

void twist_handles(const AnimationStage& stage) {
    for (const bool right : {false, true}) {
        const double depth = stage.script.handle_ratio * stage.range_x();
        BoundaryCondition condition;
        condition.kind = Kind::Velocity;
        condition.selection =
            beyond(stage, right ? stage.hi[0] - depth : stage.lo[0] + depth, right);
        condition.angular_deg = {right ? kTwistDegrees : -kTwistDegrees, 0, 0};
        condition.center = Vector3{0.5 * (stage.lo[0] + stage.hi[0]),
                                   0.5 * (stage.lo[1] + stage.hi[1]),
                                   0.5 * (stage.lo[2] + stage.hi[2])};
        add_to_handles(stage, condition);
    }
}

void drag_handles_right(const AnimationStage& stage) {
    const auto elastic = std::count_if(stage.shapes.begin(),
                                       stage.shapes.end(),
                                       [](const auto& s) { return s.elastic; });
    if (stage.shapes.size() != 1 || elastic != 1 || stage.shapes[0].copies() != 1)
        stage.script.animation_words.fail(
            "found script dragright with several shapes, which is missing here, "
            "expected one shape; keep one, or use linearVelocity",
            Error::Code::Unsupported);
    BoundaryCondition condition;
    condition.kind = Kind::Velocity;
    condition.selection = beyond(stage, stage.hi[0] - 0.04 * stage.range_x(), true);
    condition.linear = {0.5, 0, 0};
    condition.until = Until{.subject = Until::Subject::Body,
                            .axis = 0,
                            .above = true,
                            .value = right_end_of_obstacles(stage.script),
                            .then_hold = false};
    add_to_handles(stage, condition);
}

void stretch_and_pause_handles(const AnimationStage& stage) {
    constexpr double kStopX = -0.28;  // m, where the left end stops
    int steps = 0;
    while (steps < stage.scene.num_steps()
           && stage.lo[0] - steps * stage.scene.dt > kStopX)
        ++steps;
    const double stop = stage.before_step(steps);
    for (const bool right : {false, true}) {
        const double depth = 0.01 * stage.range_x();
        BoundaryCondition condition;
        condition.selection =
            beyond(stage, right ? stage.hi[0] - depth : stage.lo[0] + depth, right);
        if (steps > 0) {
            condition.kind = Kind::Velocity;
            condition.linear = {right ? 1.0 : -1.0, 0, 0};
            condition.t_end = stop;
            add_to_handles(stage, condition);
            condition.t_begin = stop;
            condition.t_end = kForever;
        }
        condition.kind = Kind::Fixed;
        condition.linear = {};
        add_to_handles(stage, condition);
    }
}

}  // namespace noli
