// SPDX-License-Identifier: Apache-2.0
/// Animations of IPC scripts that move obstacles.
#include "scene/ipc_animation.hpp"

#include <algorithm>

namespace noli {

namespace {

using Kind = BoundaryCondition::Kind;

constexpr double kSquashGap = 0.1;  // m

}  // namespace

void rotate_cylinders(const AnimationStage& stage) {
    stage.need_shapes(4);
    constexpr Vector3 kSpeeds[]{{90, 0, 0}, {-90, 0, 0}, {0, 0, -90}, {0, 0, 90}};
    for (std::size_t i = 0; i < 4; ++i) {
        const PlacedShape& placed = stage.shapes[i];
        BoundaryCondition& condition = stage.body_of(placed).boundary.emplace_back();
        condition.kind = Kind::Velocity;
        condition.angular_deg = kSpeeds[i];
        condition.center = Vector3{0.5 * (placed.lo[0] + placed.hi[0]),
                                   0.5 * (placed.lo[1] + placed.hi[1]),
                                   0.5 * (placed.lo[2] + placed.hi[2])};
    }
}

void squash_six(const AnimationStage& stage) {
    stage.need_shapes(6);
    std::vector<PathKey> keys{
        PathKey{}};  // of the distance gone, as the x of a translation
    double gone = 0.0;
    double direction = 1.0;
    const double start_gap = stage.shapes[1].lo[0] - stage.shapes[0].hi[0];
    for (int step = 0; step < stage.scene.num_steps(); ++step) {
        if (start_gap - 2.0 * gone < kSquashGap) {
            direction = -direction;
            if (step > 0)
                keys.push_back({.time = step * stage.scene.dt,
                                .translation = {gone, 0, 0},
                                .rotation_deg = {}});
        }
        gone += direction * stage.scene.dt;
    }
    keys.push_back({.time = stage.scene.num_steps() * stage.scene.dt,
                    .translation = {gone, 0, 0},
                    .rotation_deg = {}});
    for (std::size_t i = 0; i < 6; ++i) {
        BoundaryCondition& condition =
            stage.body_of(stage.shapes[i]).boundary.emplace_back();
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

void squash_bed(const AnimationStage& stage) {
    int total = 0;
    for (const PlacedShape& placed : stage.shapes)
        total += placed.elastic ? 0 : placed.copies();
    std::vector<const PlacedShape*> moving;
    double top_of_still = -kForever;
    double bottom_of_moving = kForever;
    int before = 0;
    for (const PlacedShape& placed : stage.shapes) {
        if (placed.elastic) continue;
        if (2 * before >= total) {
            moving.push_back(&placed);
            bottom_of_moving = std::min(bottom_of_moving, placed.lo[1]);
        } else if (2 * (before + placed.copies()) <= total + 1) {
            top_of_still = std::max(top_of_still, placed.hi[1]);
        } else {
            stage.script.animation_words.fail(
                "found script DCOSegBedSquash with a shapeMatrix across both halves, "
                "which is missing here, expected two matrices; split it",
                Error::Code::Unsupported);
        }
        before += placed.copies();
    }
    int steps = 0;
    while (steps < stage.scene.num_steps()
           && bottom_of_moving - steps * stage.scene.dt - top_of_still > kSquashGap)
        ++steps;
    for (const PlacedShape* placed : moving) {
        if (steps == 0) break;
        BoundaryCondition& condition = stage.body_of(*placed).boundary.emplace_back();
        condition.kind = Kind::Velocity;
        condition.linear = {0, -1, 0};
        condition.t_end = stage.before_step(steps);
    }
}

}  // namespace noli
