// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "noli/scene.hpp"

#include <bit>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

namespace noli::test {

/// Every field of a scene as text, doubles by their bits: two scenes are the same if
/// these are.
class Flat {
  public:
    explicit Flat(const Scene& s) {
        add("name",
            s.name,
            s.description,
            s.base_folder,
            s.duration,
            s.dt,
            s.gravity,
            s.length_scale);
        for (const Body& body : s.bodies)
            add_body(body);
        for (const HalfSpace& h : s.half_spaces)
            add("half_space", h.name, h.point, h.normal, h.friction);
        for (const Container& c : s.containers)
            add("container", c.name, c.shape, c.center, c.radius, c.axis, c.friction);
        const ContactSettings& c = s.contact;
        add("contact",
            c.enabled,
            c.self_contact,
            c.dhat,
            c.dhat_absolute,
            c.model,
            c.strengthen,
            c.barrier_exponent,
            c.hessian,
            c.mollifier,
            c.kappa,
            c.kappa_min_multiplier,
            c.epsv,
            c.epsv_absolute,
            c.friction_iterations,
            c.friction_tolerance,
            c.friction_hessian,
            c.min_separation);
        for (const ContactPairRule& r : c.pairs)
            add("pair",
                r.a,
                r.b,
                r.friction.has_value(),
                r.friction.value_or(0),
                r.enabled.has_value(),
                r.enabled.value_or(false));
        const SolverSettings& o = s.solver;
        add("solver",
            s.damping.mass,
            s.damping.stiffness,
            o.integrator,
            o.newmark_beta,
            o.newmark_gamma,
            o.tolerance,
            o.gap_tolerance,
            o.projection,
            o.start,
            o.gradient_tolerance,
            o.tolerance_absolute,
            o.tolerance_per_step,
            o.max_newton,
            o.linear,
            o.contact_product,
            o.pcg_tolerance,
            o.max_pcg);
        add("output",
            s.output.every,
            s.output.formats,
            s.output.checkpoint_steps,
            s.output.checkpoint_seconds,
            s.output.hash_every);
    }

    [[nodiscard]] const std::vector<std::string>& items() const { return items_; }

  private:
    void add_body(const Body& b) {
        add("body",
            b.name,
            b.mesh.file,
            b.mesh.generator,
            b.mesh.fix_orientation,
            b.transform.rows,
            b.velocity,
            b.angular_velocity_deg,
            b.friction,
            b.grid,
            b.grid_spacing);
        for (const auto& [name, values] : b.mesh.parameters)
            add(name, values);
        add(b.material.model,
            b.material.density,
            b.material.young,
            b.material.poisson,
            b.material.gipc_lame);
        for (const BoundaryCondition& c : b.boundary) {
            const Selection& s = c.selection;
            add("condition",
                c.kind,
                s.kind,
                s.frame,
                s.box_min,
                s.box_max,
                s.vertices,
                s.surface_only,
                c.linear,
                c.angular_deg,
                c.center.has_value(),
                c.center.value_or(Vector3{}),
                c.sequence,
                c.t_begin,
                c.t_end,
                c.axes,
                c.until.has_value());
            for (const PathKey& k : c.path)
                add("key", k.time, k.translation, k.rotation_deg);
            if (c.until)
                add(c.until->subject,
                    c.until->axis,
                    c.until->above,
                    c.until->value,
                    c.until->then_hold);
        }
    }

    template <class... T>
    void add(const T&... values) {
        (push(values), ...);
    }
    void push(const std::string& text) { items_.push_back(text); }
    void push(const char* text) { items_.emplace_back(text); }
    void push(double value) {
        items_.push_back(std::to_string(std::bit_cast<std::uint64_t>(value)));
    }
    template <class T>
    requires(std::is_integral_v<T> || std::is_enum_v<T>) void push(T value) {
        items_.push_back(std::to_string(static_cast<long long>(value)));
    }
    template <class T>
    void push(const std::vector<T>& values) {
        items_.push_back("list of " + std::to_string(values.size()));
        for (const T& value : values)
            push(value);
    }
    template <class T, std::size_t n>
    void push(const std::array<T, n>& values) {
        for (const T& value : values)
            push(value);
    }

    std::vector<std::string> items_;
};

}  // namespace noli::test
