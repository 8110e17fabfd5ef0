// SPDX-License-Identifier: Apache-2.0
#include "sim/net_force.hpp"

#include "model/rotation.hpp"

#include <algorithm>

namespace noli {

namespace {

struct Sums {
    double mass = 0.0;
    Vec3d moment{0, 0, 0}, force{0, 0, 0}, torque{0, 0, 0};  ///< about the first vertex
    Vec3d origin{0, 0, 0};
    bool is_started = false, is_held = false;
};

Vector3 to_array(const Vec3d& v) {
    return {v.x, v.y, v.z};
}

}  // namespace

std::vector<NetForce> net_forces(const Model& model,
                                 const std::vector<Vec3d>& x,
                                 const Residual& residual) {
    std::vector<Sums> bodies(static_cast<std::size_t>(model.num_bodies()));
    for (std::size_t v = 0; v < x.size(); ++v) {
        Sums& body = bodies[static_cast<std::size_t>(model.body[v])];
        if (!body.is_started) body.origin = x[v];
        body.is_started = true;
        // A vertex without an element is held and has no say.
        if (model.mass[v] > 0.0 && residual.held[v] != 0) body.is_held = true;
        const Vec3d r = x[v] - body.origin;
        body.mass += model.mass[v];
        body.moment += model.mass[v] * r;
        body.force += residual.force[v];
        body.torque += cross(r, residual.force[v]);
    }
    std::vector<NetForce> out;
    for (const Sums& body : bodies) {
        NetForce& net = out.emplace_back();
        if (body.is_held || !(body.mass > 0.0)) continue;
        const Vec3d center = (1.0 / body.mass) * body.moment;
        net.force = to_array(body.force);
        net.torque = to_array(body.torque - cross(center, body.force));
    }
    return out;
}

double unbalanced(const Topology& topology,
                  const std::vector<NetForce>& net,
                  const std::vector<Vector3>& contact_force,
                  double small,
                  double dt,
                  double share) {
    std::vector<double> allowed(net.size(), 0.0);
    for (std::size_t v = 0; v < contact_force.size(); ++v)
        allowed[static_cast<std::size_t>(topology.body_of_vertex[v])] +=
            topology.mass[v] * small / (dt * dt)
            + share * norm(to_vec3(contact_force[v]));
    double worst = 0.0;
    for (std::size_t b = 0; b < net.size(); ++b) {
        const double size = norm(to_vec3(net[b].force));
        if (size > 0.0) worst = std::max(worst, size / allowed[b]);
    }
    return worst;
}

}  // namespace noli
