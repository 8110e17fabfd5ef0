// SPDX-License-Identifier: Apache-2.0
/// Animations of IPC scripts as boundary conditions.
///
/// With `script null` the shapes say themselves how they move. A named animation resets
/// that: it ignores the conditions of the shape lines and moves what it wants.
#include "scene/ipc_animation.hpp"

#include "scene/suggest.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>

namespace noli {

namespace {

using Kind = BoundaryCondition::Kind;

void warn_about_reset(const AnimationStage& stage) {
    for (const PlacedShape& placed : stage.shapes) {
        const ScriptShape& s = *placed.shape;
        const bool moves = s.linear || s.angular_deg || !s.dirichlet.empty()
                        || !s.neumann.empty() || s.velocity != Vector3{}
                        || s.angular_velocity_deg != Vector3{};
        if (moves)
            stage.warn(s.place,
                       fmt::format("script {} replaces the velocities and conditions of "
                                   "the shape; they are ignored",
                                   stage.script.animation));
    }
}

void add_condition(const AnimationStage& stage,
                   const PlacedShape& placed,
                   const ScriptCondition& c,
                   const ScriptTimeRange& range,
                   bool dirichlet) {
    BoundaryCondition condition;
    const bool still = c.linear == Vector3{} && c.angular_deg == Vector3{};
    condition.kind =
        !dirichlet ? Kind::Acceleration : (still ? Kind::Fixed : Kind::Velocity);
    condition.selection.kind = Selection::Kind::Box;
    condition.selection.surface_only = placed.elastic;
    for (std::size_t k = 0; k < 3; ++k) {
        condition.selection.box_min[k] = std::min(c.box_min[k], c.box_max[k]);
        condition.selection.box_max[k] = std::max(c.box_min[k], c.box_max[k]);
    }
    condition.linear = c.linear;
    condition.angular_deg = c.angular_deg;
    condition.t_begin = std::max({0.0, c.t_begin, range.begin});
    condition.t_end = std::min(c.t_end, range.end);
    if (condition.t_end > condition.t_begin)
        stage.body_of(placed).boundary.push_back(condition);
    else
        stage.warn(placed.shape->place,
                   "a condition ends before it begins; it is left out");
}

/// Script null.
void shapes_move_themselves(const AnimationStage& stage) {
    for (const PlacedShape& placed : stage.shapes) {
        const ScriptShape& shape = *placed.shape;
        Body& body = stage.body_of(placed);
        if (placed.elastic) {
            body.velocity = shape.velocity;
            body.angular_velocity_deg = shape.angular_velocity_deg;
        }
        if (shape.linear || shape.angular_deg) {
            BoundaryCondition& motion = body.boundary.emplace_back();
            motion.kind = Kind::Velocity;
            motion.linear = shape.linear.value_or(Vector3{});
            motion.angular_deg = shape.angular_deg.value_or(Vector3{});
        }
        for (const ScriptCondition& c : shape.dirichlet)
            add_condition(stage, placed, c, stage.script.dirichlet_range, true);
        for (const ScriptCondition& c : shape.neumann)
            add_condition(stage, placed, c, stage.script.neumann_range, false);
    }
}

void ball_hits_wall(const AnimationStage& stage) {
    ScriptWords words = stage.script.animation_words;
    words.integer("the number of parameters");
    const double speed = words.number("the speed");
    for (const PlacedShape& placed : stage.shapes)
        if (placed.elastic) stage.body_of(placed).velocity = {speed, 0, 0};
}

void move_nothing(const AnimationStage& /*stage*/) {}

using Animation = void (*)(const AnimationStage&);

const std::map<std::string, Animation>& animations() {
    static const std::map<std::string, Animation> all{
        {"null", shapes_move_themselves},
        {"fall", move_nothing},
        {"fallNoShift", move_nothing},
        {"DCOFix", move_nothing},
        {"twist", twist_handles},
        {"dragright", drag_handles_right},
        {"stretchAndPause", stretch_and_pause_handles},
        {"DCORotCylinders", rotate_cylinders},
        {"DCOSquash6", squash_six},
        {"DCOSegBedSquash", squash_bed},
        {"DCOBallHitWall", ball_hits_wall}};
    return all;
}

}  // namespace

AnimationStage::AnimationStage(Script& from,
                               const std::vector<PlacedShape>& placed,
                               Scene& into)
    : script(from), shapes(placed), scene(into) {
    for (std::size_t k = 0; k < 3; ++k) {
        lo[k] = kForever;
        hi[k] = -kForever;
        for (const PlacedShape& shape : shapes) {
            lo[k] = std::min(lo[k], shape.lo[k]);
            hi[k] = std::max(hi[k], shape.hi[k]);
        }
    }
}

void AnimationStage::need_shapes(std::size_t count) const {
    if (shapes.size() < count)
        script.animation_words.fail(
            fmt::format("found {} shapes, expected at least {} for script {}; add shapes",
                        shapes.size(),
                        count,
                        script.animation));
}

bool animation_lifts(const std::string& animation) {
    return animation == "fall" || animation == "dragright";
}

void apply_animation(Script& script,
                     const std::vector<PlacedShape>& shapes,
                     Scene& scene) {
    const AnimationStage stage(script, shapes, scene);
    const std::map<std::string, Animation>& known = animations();
    const std::string& name = script.animation;
    if (name != "null") warn_about_reset(stage);
    if (const auto found = known.find(name); found != known.end())
        return found->second(stage);
    std::vector<std::string> names;
    names.reserve(known.size());
    for (const auto& [key, action] : known)
        names.push_back(key);
    script.animation_words.fail(
        fmt::format("found script \"{}\", an animation that is missing here, "
                    "expected {}{}; replace it by conditions of "
                    "the shapes (DBC, linearVelocity, ...)",
                    name,
                    quoted_list(names),
                    did_you_mean(name, names)),
        Error::Code::Unsupported);
}

}  // namespace noli
