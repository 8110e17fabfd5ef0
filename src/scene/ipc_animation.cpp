// SPDX-License-Identifier: Apache-2.0
/// Animations of IPC scripts as boundary conditions.
///
/// With `script null` the shapes say themselves how they move. A named animation resets
/// that: it ignores the conditions of the shape lines and moves what it wants. Motion
/// that depends on where things are (planes that turn back, a bed that stops) is known in
/// advance, because prescribed vertices go where they are told: it is played through
/// here, step by step.
#include "scene/ipc_script_data.hpp"
#include "scene/suggest.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <map>

namespace noli {

namespace {

using Kind = BoundaryCondition::Kind;
using Until = BoundaryCondition::Until;

constexpr double kTwistDegrees = 72.0;  // 0.4 pi rad
constexpr double kSquashGap = 0.1;      // m

/// Ends before step `steps` (counted from 0) whatever the rounding of step times.
double end_before_step(int steps, double dt) {
    return (steps - 0.5) * dt;
}

class Animation {
  public:
    Animation(Script& script, const std::vector<PlacedShape>& shapes, Scene& scene)
        : script_(script), shapes_(shapes), scene_(scene) {
        for (std::size_t k = 0; k < 3; ++k) {
            lo_[k] = kForever;
            hi_[k] = -kForever;
            for (const PlacedShape& shape : shapes) {
                lo_[k] = std::min(lo_[k], shape.lo[k]);
                hi_[k] = std::max(hi_[k], shape.hi[k]);
            }
        }
    }

    void apply() {
        const std::map<std::string, std::function<void()>> animations{
            {"null", [this] { shapes_move_themselves(); }},
            {"fall", [] {}},
            {"fallNoShift", [] {}},
            {"DCOFix", [] {}},
            {"twist", [this] { twist(); }},
            {"dragright", [this] { drag_right(); }},
            {"stretchAndPause", [this] { stretch_and_pause(); }},
            {"DCORotCylinders", [this] { rotate_cylinders(); }},
            {"DCOSquash6", [this] { squash_six(); }},
            {"DCOSegBedSquash", [this] { squash_bed(); }},
            {"DCOBallHitWall", [this] { ball_hits_wall(); }}};
        const std::string& name = script_.animation;
        if (name != "null") warn_about_reset();
        if (const auto found = animations.find(name); found != animations.end())
            return found->second();
        std::vector<std::string> known;
        known.reserve(animations.size());
        for (const auto& [key, action] : animations)
            known.push_back(key);
        script_.animation_words.fail(
            fmt::format("found script \"{}\", an animation that is missing here, "
                        "expected {}{}; replace it by "
                        "conditions of the shapes (DBC, linearVelocity, ...)",
                        name,
                        quoted_list(known),
                        did_you_mean(name, known)),
            Error::Code::Unsupported);
    }

  private:
    Body& body_of(const PlacedShape& placed) { return scene_.bodies[placed.body]; }

    void need_shapes(std::size_t count) const {
        if (shapes_.size() < count)
            script_.animation_words.fail(fmt::format(
                "found {} shapes, expected at least {} for script {}; add shapes",
                shapes_.size(),
                count,
                script_.animation));
    }

    void warn(const ScriptWords& place, const std::string& message) {
        script_.warnings.push_back({place.where(), message});
    }

    // ── script null
    // ────────────────────────────────────────────────────────────────────────────

    void warn_about_reset() {
        for (const PlacedShape& placed : shapes_) {
            const ScriptShape& s = *placed.shape;
            const bool moves = s.linear || s.angular_deg || !s.dirichlet.empty()
                            || !s.neumann.empty() || s.velocity != Vector3{}
                            || s.angular_velocity_deg != Vector3{};
            if (moves)
                warn(s.place,
                     fmt::format("script {} replaces the velocities and conditions of "
                                 "the shape; they are "
                                 "ignored",
                                 script_.animation));
        }
    }

    void shapes_move_themselves() {
        for (const PlacedShape& placed : shapes_) {
            const ScriptShape& shape = *placed.shape;
            Body& body = body_of(placed);
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
                add_condition(placed, c, script_.dirichlet_range, true);
            for (const ScriptCondition& c : shape.neumann)
                add_condition(placed, c, script_.neumann_range, false);
        }
    }

    void add_condition(const PlacedShape& placed,
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
            body_of(placed).boundary.push_back(condition);
        else
            warn(placed.shape->place,
                 "a condition ends before it begins; it is left out");
    }

    // ── handles: boxes in the world at the ends along x
    // ────────────────────────────────────────

    [[nodiscard]] double range_x() const { return hi_[0] - lo_[0]; }

    /// All vertices with x below (or above) the bound, which itself does not belong to
    /// it.
    [[nodiscard]] Selection beyond(double bound, bool above) const {
        Selection selection;
        selection.kind = Selection::Kind::Box;
        selection.frame = Selection::Frame::World;
        for (std::size_t k = 0; k < 3; ++k) {  // any box around everything will do
            const double margin = 0.5 * (hi_[k] - lo_[k]) + range_x();
            selection.box_min[k] = lo_[k] - margin;
            selection.box_max[k] = hi_[k] + margin;
        }
        (above ? selection.box_min : selection.box_max)[0] =
            std::nextafter(bound, above ? kForever : -kForever);
        return selection;
    }

    /// Adds the condition to every shape that has vertices in its box; false if none has.
    bool add_to_handles(const BoundaryCondition& condition) {
        bool any = false;
        for (const PlacedShape& placed : shapes_) {
            const Selection& box = condition.selection;
            const bool in_reach =
                placed.hi[0] >= box.box_min[0] && placed.lo[0] <= box.box_max[0];
            const bool selects =
                placed.copies() > 1
                    ? in_reach
                    : std::any_of(placed.x.begin(), placed.x.end(), [&](const Vec3d& p) {
                          return p.x >= box.box_min[0] && p.x <= box.box_max[0];
                      });
            if (!selects) continue;
            body_of(placed).boundary.push_back(condition);
            any = true;
        }
        return any;
    }

    void twist() {
        for (const bool right : {false, true}) {
            const double depth = script_.handle_ratio * range_x();
            BoundaryCondition condition;
            condition.kind = Kind::Velocity;
            condition.selection = beyond(right ? hi_[0] - depth : lo_[0] + depth, right);
            condition.angular_deg = {right ? kTwistDegrees : -kTwistDegrees, 0, 0};
            condition.center = Vector3{0.5 * (lo_[0] + hi_[0]),
                                       0.5 * (lo_[1] + hi_[1]),
                                       0.5 * (lo_[2] + hi_[2])};
            add_to_handles(condition);
        }
    }

    void drag_right() {
        const auto elastic = std::count_if(
            shapes_.begin(), shapes_.end(), [](const auto& s) { return s.elastic; });
        if (shapes_.size() != 1 || elastic != 1 || shapes_[0].copies() != 1)
            script_.animation_words.fail(
                "found script dragright with several shapes, which is missing here, "
                "expected "
                "one shape; keep one, or use linearVelocity",
                Error::Code::Unsupported);
        BoundaryCondition condition;
        condition.kind = Kind::Velocity;
        condition.selection = beyond(hi_[0] - 0.04 * range_x(), true);
        condition.linear = {0.5, 0, 0};
        condition.until = Until{.subject = Until::Subject::Body,
                                .axis = 0,
                                .above = true,
                                .value = right_end_of_obstacles(),
                                .then_hold = false};
        add_to_handles(condition);
    }

    /// Largest x of all meshCO; the handles go on forever without any.
    [[nodiscard]] double right_end_of_obstacles() const {
        double end = -kForever;
        for (const ScriptObstacle& obstacle : script_.obstacles)
            end = std::max(end, obstacle.right_end);
        return script_.obstacles.empty() ? 1e6 : end;
    }

    void stretch_and_pause() {
        constexpr double kStopX = -0.28;  // m, where the left end stops
        int steps = 0;
        while (steps < scene_.num_steps() && lo_[0] - steps * scene_.dt > kStopX)
            ++steps;
        const double stop = end_before_step(steps, scene_.dt);
        for (const bool right : {false, true}) {
            const double depth = 0.01 * range_x();
            BoundaryCondition condition;
            condition.selection = beyond(right ? hi_[0] - depth : lo_[0] + depth, right);
            if (steps > 0) {
                condition.kind = Kind::Velocity;
                condition.linear = {right ? 1.0 : -1.0, 0, 0};
                condition.t_end = stop;
                add_to_handles(condition);
                condition.t_begin = stop;
                condition.t_end = kForever;
            }
            condition.kind = Kind::Fixed;
            condition.linear = {};
            add_to_handles(condition);
        }
    }

    // ── moving obstacles
    // ───────────────────────────────────────────────────────────────────────

    void rotate_cylinders() {
        need_shapes(4);
        constexpr Vector3 kSpeeds[]{{90, 0, 0}, {-90, 0, 0}, {0, 0, -90}, {0, 0, 90}};
        for (std::size_t i = 0; i < 4; ++i) {
            const PlacedShape& placed = shapes_[i];
            BoundaryCondition& condition = body_of(placed).boundary.emplace_back();
            condition.kind = Kind::Velocity;
            condition.angular_deg = kSpeeds[i];
            condition.center = Vector3{0.5 * (placed.lo[0] + placed.hi[0]),
                                       0.5 * (placed.lo[1] + placed.hi[1]),
                                       0.5 * (placed.lo[2] + placed.hi[2])};
        }
    }

    /// Six planes close in from +-x, +-y, +-z and turn back whenever the first two come
    /// close.
    void squash_six() {
        need_shapes(6);
        std::vector<PathKey> keys{
            PathKey{}};  // of the distance gone, as the x of a translation
        double gone = 0.0;
        double direction = 1.0;
        const double start_gap = shapes_[1].lo[0] - shapes_[0].hi[0];
        for (int step = 0; step < scene_.num_steps(); ++step) {
            if (start_gap - 2.0 * gone < kSquashGap) {
                direction = -direction;
                if (step > 0)
                    keys.push_back({.time = step * scene_.dt,
                                    .translation = {gone, 0, 0},
                                    .rotation_deg = {}});
            }
            gone += direction * scene_.dt;
        }
        keys.push_back({.time = scene_.num_steps() * scene_.dt,
                        .translation = {gone, 0, 0},
                        .rotation_deg = {}});
        for (std::size_t i = 0; i < 6; ++i) {
            BoundaryCondition& condition = body_of(shapes_[i]).boundary.emplace_back();
            condition.kind = Kind::Path;
            const double sign = i % 2 == 0 ? 1.0 : -1.0;
            for (PathKey key : keys) {
                const double way = sign * key.translation[0];
                key.translation = {0, 0, 0};
                key.translation[i / 2] = way;
                condition.path.push_back(key);
            }
        }
    }

    /// The obstacles of the second half of the list come down until they are near the
    /// first half.
    void squash_bed() {
        int total = 0;
        for (const PlacedShape& placed : shapes_)
            total += placed.elastic ? 0 : placed.copies();
        std::vector<const PlacedShape*> moving;
        double top_of_still = -kForever;
        double bottom_of_moving = kForever;
        int before = 0;
        for (const PlacedShape& placed : shapes_) {
            if (placed.elastic) continue;
            if (2 * before >= total) {
                moving.push_back(&placed);
                bottom_of_moving = std::min(bottom_of_moving, placed.lo[1]);
            } else if (2 * (before + placed.copies()) <= total + 1) {
                top_of_still = std::max(top_of_still, placed.hi[1]);
            } else {
                script_.animation_words.fail(
                    "found script DCOSegBedSquash with a shapeMatrix across both halves, "
                    "which is "
                    "missing here, expected two matrices; split it",
                    Error::Code::Unsupported);
            }
            before += placed.copies();
        }
        int steps = 0;
        while (steps < scene_.num_steps()
               && bottom_of_moving - steps * scene_.dt - top_of_still > kSquashGap)
            ++steps;
        for (const PlacedShape* placed : moving) {
            if (steps == 0) break;
            BoundaryCondition& condition = body_of(*placed).boundary.emplace_back();
            condition.kind = Kind::Velocity;
            condition.linear = {0, -1, 0};
            condition.t_end = end_before_step(steps, scene_.dt);
        }
    }

    void ball_hits_wall() {
        ScriptWords words = script_.animation_words;
        words.integer("the number of parameters");
        const double speed = words.number("the speed");
        for (const PlacedShape& placed : shapes_)
            if (placed.elastic) body_of(placed).velocity = {speed, 0, 0};
    }

    Script& script_;
    const std::vector<PlacedShape>& shapes_;
    Scene& scene_;
    Vector3 lo_{}, hi_{};  // of all shapes
};

}  // namespace

bool animation_lifts(const std::string& animation) {
    return animation == "fall" || animation == "dragright";
}

void apply_animation(Script& script,
                     const std::vector<PlacedShape>& shapes,
                     Scene& scene) {
    Animation(script, shapes, scene).apply();
}

}  // namespace noli
