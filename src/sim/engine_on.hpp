// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The engine's text, once for all executors.

#include "sim/engine.hpp"

namespace noli {

/// Forwards to a Stepper on one executor.
template <class Exec>
class EngineOn {
  public:
    explicit EngineOn(const EngineInput& input)
        : stepper_(exec_, input.model, input.pattern, input.settings, input.gravity),
          num_vertices_(input.model.num_vertices) {}

    StepReport step(StopFlag stop = nullptr) { return stepper_.step(stop); }
    StepState state() { return stepper_.state(); }
    [[nodiscard]] int steps() const { return stepper_.steps(); }
    [[nodiscard]] const std::vector<Vec3d>& positions() const {
        return stepper_.positions();
    }
    std::vector<Vec3d> velocities() { return stepper_.velocities(); }
    void set_state(const StepState& state) { stepper_.set_state(state); }

    std::vector<Vec3d> contact_forces() {
        typename Exec::template Buffer<Vec3d> out;
        out.resize(num_vertices_);
        Newton<Exec>& newton = stepper_.newton();
        newton.objective().contact_forces(
            exec_, stepper_.x(), newton.pairs(), newton.law(), out.view());
        std::vector<Vec3d> host;
        exec_.download(View<const Vec3d>(out.view()), host);
        return host;
    }
    Residual residual() { return stepper_.residual(); }
    double elastic_energy() {
        return stepper_.newton().objective().elastic_energy_at(exec_, stepper_.x());
    }
    double barrier_energy() {
        Newton<Exec>& newton = stepper_.newton();
        const double h_sq = newton.objective().scales().h_sq;
        if (!(h_sq > 0.0)) return 0.0;  // before the first step
        return newton.objective().barrier_energy(
                   exec_, stepper_.x(), newton.pairs(), newton.law().barrier)
             / h_sq;
    }
    /// For measurements.
    [[nodiscard]] const Exec& exec() const { return exec_; }

  private:
    Exec exec_;
    Stepper<Exec> stepper_;
    int num_vertices_;
};

}  // namespace noli
