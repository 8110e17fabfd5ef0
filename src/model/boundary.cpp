// SPDX-License-Identifier: Apache-2.0
#include "model/boundary.hpp"

#include "model/box.hpp"
#include "model/rotation.hpp"

#include <algorithm>
#include <cmath>

namespace noli {

namespace {

Vec3d box_center(std::span<const Vec3d> x, const std::vector<int>& vertices) {
    Box box;
    for (const int v : vertices)
        box.add(x[static_cast<std::size_t>(v)]);
    return box.center();
}

/// Translation and rotation (degrees) of a path at time t, linear between keys.
PathKey path_at(const std::vector<PathKey>& path, double t) {
    if (t <= path.front().time) return path.front();
    for (std::size_t k = 1; k < path.size(); ++k) {
        if (t > path[k].time) continue;
        const PathKey& a = path[k - 1];
        const PathKey& b = path[k];
        const double s = b.time > a.time ? (t - a.time) / (b.time - a.time) : 1.0;
        PathKey at{.time = t};
        for (std::size_t i = 0; i < 3; ++i) {
            at.translation[i] = (1 - s) * a.translation[i] + s * b.translation[i];
            at.rotation_deg[i] = (1 - s) * a.rotation_deg[i] + s * b.rotation_deg[i];
        }
        return at;
    }
    return path.back();
}

bool is_load(BoundaryCondition::Kind kind) {
    return kind == BoundaryCondition::Kind::Force
        || kind == BoundaryCondition::Kind::Acceleration;
}

/// A vertex is free, prescribed on single axes, or wholly prescribed.
void settle_axes(StepBoundary& out) {
    bool any = false;
    for (std::size_t v = 0; v < out.axes.size(); ++v) {
        if (out.axes[v] == kAllAxes) out.prescribed[v] = 1;
        if (out.prescribed[v] != 0) out.axes[v] = 0;
        any = any || out.axes[v] != 0;
    }
    if (!any) out.axes.clear();
}

}  // namespace

BoundaryScript::BoundaryScript(const Model& model, const Vector3& gravity)
    : ended(model.conditions.size(), 0), model_(&model), gravity_(to_vec3(gravity)) {}

void BoundaryScript::update_until(std::span<const Vec3d> x) {
    for (std::size_t c = 0; c < ended.size(); ++c) {
        const ModelCondition& condition = model_->conditions[c];
        if (ended[c] != 0 || !condition.what.until) continue;
        const BoundaryCondition::Until& until = *condition.what.until;
        const auto& subject = until.subject == BoundaryCondition::Until::Subject::Body
                                ? condition.body_vertices
                                : condition.vertices;
        const bool all_beyond = std::all_of(subject.begin(), subject.end(), [&](int v) {
            const double at = x[static_cast<std::size_t>(v)][until.axis];
            return until.above ? at >= until.value : at <= until.value;
        });
        if (all_beyond) ended[c] = until.then_hold ? 2 : 1;
    }
}

bool BoundaryScript::acts(int index, const Step& step) const {
    const BoundaryCondition& what =
        model_->conditions[static_cast<std::size_t>(index)].what;
    const std::uint8_t state = ended[static_cast<std::size_t>(index)];
    if (state != 0) return state == 2 && !is_load(what.kind);
    return step.t >= what.t_begin - 1e-9 * step.dt
        && step.t < what.t_end - 1e-9 * step.dt;
}

/// Largest rotation of a condition in this step, degrees.
double BoundaryScript::largest_turn(const Step& step) const {
    using Kind = BoundaryCondition::Kind;
    double largest = 0.0;
    for (std::size_t c = 0; c < ended.size(); ++c) {
        const BoundaryCondition& what = model_->conditions[c].what;
        if (ended[c] != 0 || !acts(static_cast<int>(c), step)) continue;
        if (what.kind == Kind::Velocity)
            largest = std::max(largest, step.dt * norm(to_vec3(what.angular_deg)));
        if (what.kind != Kind::Path) continue;
        const PathKey from = path_at(what.path, step.t);
        const PathKey to = path_at(what.path, step.t + step.dt);
        largest = std::max(largest,
                           norm(to_vec3(to.rotation_deg) - to_vec3(from.rotation_deg)));
    }
    return largest;
}

void BoundaryScript::apply_load(int index, StepBoundary& out) const {
    const ModelCondition& condition = model_->conditions[static_cast<std::size_t>(index)];
    double scale = 1.0;
    if (condition.what.kind == BoundaryCondition::Kind::Force) {
        double mass = 0.0;
        for (const int v : condition.vertices)
            mass += model_->mass[static_cast<std::size_t>(v)];
        scale = mass > 0.0 ? 1.0 / mass : 0.0;
    }
    for (const int v : condition.vertices)
        out.acceleration[static_cast<std::size_t>(v)] +=
            scale * to_vec3(condition.what.linear);
}

/// Marks the condition's vertices and puts them where they are at the end of a leg, on
/// the axes that it prescribes.
void BoundaryScript::prescribe(int index,
                               const Step& step,
                               int leg,
                               StepBoundary& out) const {
    using Kind = BoundaryCondition::Kind;
    const ModelCondition& condition = model_->conditions[static_cast<std::size_t>(index)];
    const BoundaryCondition& what = condition.what;
    const double share =
        static_cast<double>(leg + 1) / static_cast<double>(out.path.size());
    std::vector<Vec3d>& position = out.path[static_cast<std::size_t>(leg)];
    const auto put = [&](int vertex, const Vec3d& at) {
        const auto v = static_cast<std::size_t>(vertex);
        if (what.axes == kAllAxes) {
            out.prescribed[v] = 1;
            position[v] = at;
            return;
        }
        out.axes[v] |= static_cast<std::uint8_t>(what.axes);
        for (int k = 0; k < 3; ++k)
            if (((what.axes >> k) & 1) != 0) position[v][k] = at[k];
    };
    const auto now = [&](int vertex) { return step.x[static_cast<std::size_t>(vertex)]; };

    if (ended[static_cast<std::size_t>(index)] == 2 || what.kind == Kind::Fixed) {
        for (const int v : condition.vertices)
            put(v, now(v));
    } else if (what.kind == Kind::Velocity) {
        const double time = share * step.dt;
        const Vec3d center =
            what.center ? to_vec3(*what.center) : box_center(step.x, condition.vertices);
        const Mat3d turn = rotation_from_degrees(time * to_vec3(what.angular_deg));
        const Vec3d shift = time * to_vec3(what.linear);
        for (const int v : condition.vertices)
            put(v, center + turn * (now(v) - center) + shift);
    } else if (what.kind == Kind::Path) {
        const PathKey key = path_at(what.path, step.t + share * step.dt);
        const Vec3d center = what.center ? to_vec3(*what.center) : condition.start_center;
        const Mat3d turn = rotation_from_degrees(to_vec3(key.rotation_deg));
        for (const int v : condition.vertices) {
            const Vec3d arm = model_->x0[static_cast<std::size_t>(v)] - center;
            put(v, center + turn * arm + to_vec3(key.translation));
        }
    } else {
        // Sequence: entry k is the end of step k; the last one is held.
        const std::size_t last = condition.sequence.size() - 1;
        const auto& frame =
            condition.sequence[std::min(last, static_cast<std::size_t>(step.number))];
        for (std::size_t i = 0; i < condition.vertices.size(); ++i) {
            const int v = condition.vertices[i];
            put(v, share < 1.0 ? now(v) + share * (frame[i] - now(v)) : frame[i]);
        }
    }
}

void BoundaryScript::evaluate(
    double t, double dt, int step, std::span<const Vec3d> x, StepBoundary& out) {
    const std::size_t n = static_cast<std::size_t>(model_->num_vertices);
    out.prescribed.assign(n, 0);
    out.axes.assign(n, 0);
    out.acceleration.assign(n, gravity_);
    for (std::size_t v = 0; v < n; ++v)
        out.prescribed[v] = model_->obstacle[v];

    update_until(x);
    const Step now{t, dt, step, x};
    const int legs =
        std::max(1, static_cast<int>(std::ceil(largest_turn(now) / kLargestTurn)));
    out.path.assign(static_cast<std::size_t>(legs), {x.begin(), x.end()});
    for (std::size_t c = 0; c < ended.size(); ++c) {
        const int index = static_cast<int>(c);
        if (!acts(index, now)) continue;
        if (is_load(model_->conditions[c].what.kind)) {
            apply_load(index, out);
            continue;
        }
        for (int leg = 0; leg < legs; ++leg)
            prescribe(index, now, leg, out);
    }
    settle_axes(out);

    out.num_prescribed = 0;
    for (std::size_t v = 0; v < n; ++v)
        out.num_prescribed += out.prescribed[v];
}

}  // namespace noli
