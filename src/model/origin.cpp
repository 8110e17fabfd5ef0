// SPDX-License-Identifier: Apache-2.0
#include "model/origin.hpp"

#include "model/box.hpp"
#include "model/rotation.hpp"

#include <cmath>

namespace noli {

namespace {

Box box_of(const Model& model, bool elastic_only) {
    Box box;
    for (std::size_t v = 0; v < model.x0.size(); ++v)
        if (!elastic_only || model.mass[v] > 0.0) box.add(model.x0[v]);
    return box;
}

void move(Vector3& place, const Vec3d& by) {
    place = {place[0] + by.x, place[1] + by.y, place[2] + by.z};
}

void move(BoundaryCondition& condition, const Vec3d& by) {
    if (condition.selection.frame == Selection::Frame::World) {
        move(condition.selection.box_min, by);
        move(condition.selection.box_max, by);
    }
    if (condition.center) move(*condition.center, by);
    if (condition.until) condition.until->value += by[condition.until->axis];
}

}  // namespace

Vec3d local_origin(const Model& model) {
    Box box = box_of(model, true);
    if (box.is_empty()) box = box_of(model, false);
    const Vec3d center = box.center();
    const double diagonal = box.diagonal();
    const bool is_far = max_abs(center) > kFarInDiagonals * diagonal;
    if (box.is_empty() || !is_far || !(diagonal > 0.0) || !std::isfinite(norm(center)))
        return {0.0, 0.0, 0.0};
    const double unit = std::exp2(std::ceil(std::log2(diagonal)));
    Vec3d out;
    for (int k = 0; k < 3; ++k)
        out[k] = std::round(center[k] / unit) * unit;
    return out;
}

Scene moved_to(const Vec3d& origin, const Scene& scene) {
    const Vec3d by = -origin;
    Scene out = scene;
    for (Body& body : out.bodies) {
        for (int k = 0; k < 3; ++k)
            body.transform.rows[static_cast<std::size_t>(k)][3] += by[k];
        for (BoundaryCondition& condition : body.boundary)
            move(condition, by);
    }
    for (HalfSpace& half_space : out.half_spaces)
        move(half_space.point, by);
    for (Container& container : out.containers)
        move(container.center, by);
    return out;
}

}  // namespace noli
