// SPDX-License-Identifier: Apache-2.0
#include "step/trouble.hpp"

#include <fmt/format.h>

namespace noli {

namespace {

const std::string& body_of(const Model& model, int vertex) {
    return model.body_names[static_cast<std::size_t>(
        model.body[static_cast<std::size_t>(vertex)])];
}

}  // namespace

std::string describe_tet(const Model& model, int tet) {
    const std::size_t t = static_cast<std::size_t>(tet);
    const Int4& v = model.tets[t];
    return fmt::format("tet {} ({} {} {} {}) of \"{}\"",
                       model.tet_source[t],
                       v[0],
                       v[1],
                       v[2],
                       v[3],
                       body_of(model, v[0]));
}

std::string describe_bound(const Model& model, const StepBound& bound) {
    const Int4& v = bound.vertices;
    switch (bound.limit) {
        case StepBound::Limit::VertexTriangle:
            return fmt::format("pair PT {} | {} {} {} of \"{}\" and \"{}\"",
                               v[0],
                               v[1],
                               v[2],
                               v[3],
                               body_of(model, v[0]),
                               body_of(model, v[1]));
        case StepBound::Limit::EdgeEdge:
            return fmt::format("pair EE {} {} | {} {} of \"{}\" and \"{}\"",
                               v[0],
                               v[1],
                               v[2],
                               v[3],
                               body_of(model, v[0]),
                               body_of(model, v[2]));
        case StepBound::Limit::Wall:
            return fmt::format("vertex {} of \"{}\" at {}",
                               v[0],
                               body_of(model, v[0]),
                               describe_wall(model, v[1]));
        case StepBound::Limit::NotFinite:
            return "a position or direction that is not finite";
        case StepBound::Limit::None:
            break;
    }
    return "";
}

std::string describe_undecided(const Model& model, const Int4& vertices) {
    std::string names;
    int last = -1;
    for (const int v : vertices.v) {
        if (v < 0) continue;
        names += fmt::format(" {}", v);
        last = v;
    }
    const std::string bodies = last < 0 ? ""
                                        : fmt::format(" of \"{}\" and \"{}\"",
                                                      body_of(model, vertices[0]),
                                                      body_of(model, last));
    return fmt::format(
        "all has converged but which pairs stick (one of them, vertices{}{}); the step "
        "counts, with slips that may be off by epsv dt",
        names,
        bodies);
}

std::string describe_not_finite(double direction, double energy, int iteration) {
    return fmt::format(
        "not finite in Newton iteration {}: max |p| = {:g} m, energy = {:g}; look for "
        "degenerate elements, extreme stiffness contrasts or a time step that is too "
        "large",
        iteration,
        direction,
        energy);
}

std::string describe_failed_search(const IterationRecord& record) {
    return fmt::format(
        "the line search found no step along a direction of max |p| = {:g} m that lowers "
        "the energy ({} halvings from {:g}); step bound set by {}; the linear solution "
        "may "
        "be too inexact (solver.pcg_tolerance) or the system too badly conditioned",
        record.direction,
        record.halvings,
        record.step_bound,
        record.limiting.empty() ? "nothing" : record.limiting);
}

void StallDetector::add(const IterationRecord& record) {
    last = record;
    short_steps = record.step < kShortStepLength ? short_steps + 1 : 0;
}

std::string StallDetector::describe() const {
    return fmt::format(
        "last step length {:g}, max |p| = {:g} m, limited by {}, smallest gap {:g} m, "
        "kappa {:g}",
        last.step,
        last.direction,
        last.limiting.empty() ? "nothing" : last.limiting,
        last.min_gap,
        last.kappa);
}

}  // namespace noli
