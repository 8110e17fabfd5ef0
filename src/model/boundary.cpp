// SPDX-License-Identifier: Apache-2.0
#include "model/boundary.hpp"

#include "model/rotation.hpp"

#include <algorithm>
#include <limits>

namespace noli {

namespace {

Vec3d to_vec3(const Vector3& v) {
    return {v[0], v[1], v[2]};
}

Vec3d box_center(std::span<const Vec3d> x, const std::vector<int>& vertices) {
    constexpr double kInf = std::numeric_limits<double>::infinity();
    Vec3d lo{kInf, kInf, kInf};
    Vec3d hi{-kInf, -kInf, -kInf};
    for (const int v : vertices) {
        const Vec3d& p = x[static_cast<std::size_t>(v)];
        lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
        hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
    }
    return 0.5 * (lo + hi);
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

void prescribe(StepBoundary& out, int vertex, const Vec3d& target) {
    const std::size_t v = static_cast<std::size_t>(vertex);
    out.prescribed[v] = 1;
    out.target[v] = target;
}

bool is_load(BoundaryCondition::Kind kind) {
    return kind == BoundaryCondition::Kind::Force
        || kind == BoundaryCondition::Kind::Acceleration;
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

void BoundaryScript::apply(int index,
                           double t,
                           double dt,
                           int step,
                           std::span<const Vec3d> x,
                           StepBoundary& out) const {
    const ModelCondition& condition = model_->conditions[static_cast<std::size_t>(index)];
    const BoundaryCondition& what = condition.what;
    const std::uint8_t state = ended[static_cast<std::size_t>(index)];
    const bool active = t >= what.t_begin - 1e-9 * dt && t < what.t_end - 1e-9 * dt;
    if (state == 1 || (state == 0 && !active)) return;

    if (is_load(what.kind)) {
        double scale = 1.0;
        if (what.kind == BoundaryCondition::Kind::Force) {
            double mass = 0.0;
            for (const int v : condition.vertices)
                mass += model_->mass[static_cast<std::size_t>(v)];
            scale = mass > 0.0 ? 1.0 / mass : 0.0;
        }
        if (state == 2) return;
        for (const int v : condition.vertices)
            out.acceleration[static_cast<std::size_t>(v)] += scale * to_vec3(what.linear);
        return;
    }
    if (state == 2 || what.kind == BoundaryCondition::Kind::Fixed) {
        for (const int v : condition.vertices)
            prescribe(out, v, x[static_cast<std::size_t>(v)]);
        return;
    }
    if (what.kind == BoundaryCondition::Kind::Velocity) {
        const Vec3d center =
            what.center ? to_vec3(*what.center) : box_center(x, condition.vertices);
        const Mat3d turn = rotation_from_degrees(dt * to_vec3(what.angular_deg));
        const Vec3d shift = dt * to_vec3(what.linear);
        for (const int v : condition.vertices)
            prescribe(out,
                      v,
                      center + turn * (x[static_cast<std::size_t>(v)] - center) + shift);
        return;
    }
    if (what.kind == BoundaryCondition::Kind::Path) {
        const PathKey key = path_at(what.path, t + dt);
        const Vec3d center = what.center ? to_vec3(*what.center) : condition.start_center;
        const Mat3d turn = rotation_from_degrees(to_vec3(key.rotation_deg));
        for (const int v : condition.vertices) {
            const Vec3d arm = model_->x0[static_cast<std::size_t>(v)] - center;
            prescribe(out, v, center + turn * arm + to_vec3(key.translation));
        }
        return;
    }
    // Sequence: entry k is the end of step k; the last one is held.
    const std::size_t last = condition.sequence.size() - 1;
    const auto& frame =
        condition.sequence[std::min(last, static_cast<std::size_t>(step))];
    for (std::size_t i = 0; i < condition.vertices.size(); ++i)
        prescribe(out, condition.vertices[i], frame[i]);
}

void BoundaryScript::evaluate(
    double t, double dt, int step, std::span<const Vec3d> x, StepBoundary& out) {
    const std::size_t n = static_cast<std::size_t>(model_->num_vertices);
    out.prescribed.assign(n, 0);
    out.target.assign(x.begin(), x.end());
    out.acceleration.assign(n, gravity_);
    for (std::size_t v = 0; v < n; ++v)
        out.prescribed[v] = model_->obstacle[v];

    update_until(x);
    for (std::size_t c = 0; c < ended.size(); ++c)
        apply(static_cast<int>(c), t, dt, step, x, out);

    out.num_prescribed = 0;
    for (std::size_t v = 0; v < n; ++v)
        out.num_prescribed += out.prescribed[v];
}

}  // namespace noli
