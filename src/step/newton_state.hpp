// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the parts of a Newton iteration share: newton_direction.hpp finds the direction
/// p, newton_search.hpp goes along it, and newton.hpp has the loop around the two.

#include "noli/simulator.hpp"

#include "core/timer.hpp"
#include "objective/objective.hpp"
#include "step/adaptive_law.hpp"
#include "step/collision.hpp"

namespace noli {

template <class Exec>
struct NewtonState {
    NewtonState(Exec& exec,
                const Model& model,
                const BlockPattern& pattern,
                const StepSettings& settings)
        : objective(exec, model, pattern), law(settings) {
        p.resize(model.num_vertices);
        x_trial.resize(model.num_vertices);
    }

    /// Gradient, operator and, where it is not known yet, the energy.
    void assemble(Exec& exec, View<const Vec3d> x, bool project, StepReport& report) {
        const PhaseTimer timer(report.t_assemble);
        EnergyParts parts;
        if (!energy_known) parts = objective.energy_later(exec, x, pairs, law.current());
        objective.assemble(exec, x, pairs, law.current(), project);
        if (!energy_known) energy = objective.total(exec, parts);
        energy_known = true;
        const AssemblySeconds seconds = objective.take_seconds();
        report.t_elastic += seconds.elastic;
        report.t_barrier += seconds.barrier;
        report.t_friction += seconds.friction;
    }

    Objective<Exec> objective;
    Collision<Exec> collision;
    PairSet<Exec> pairs;  ///< active at the last position that was looked at
    AdaptiveLaw law;
    View<const std::uint8_t> fixed{};  ///< which vertices are prescribed
    View<const std::uint8_t> axes{};   ///< and which single axes (single_axes.hpp)
    typename Exec::template Buffer<Vec3d> p, x_trial;
    double energy = 0.0;  ///< of the iterate
    bool energy_known = false;
};

}  // namespace noli
