// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Boundary conditions in time: which vertices are prescribed in a step, where to, and
/// which accelerations act. Host code, once per step.

#include "model/model.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace noli {

/// Boundary data of one step; arrays are per vertex.
struct StepBoundary {
    std::vector<std::uint8_t> prescribed;  ///< 1 = position given by `target`
    std::vector<Vec3d> target;             ///< position at the end of the step, m
    std::vector<Vec3d> acceleration;       ///< gravity and applied forces, m/s^2
    int num_prescribed = 0;
};

/// Evaluates the conditions of a model step by step. Conditions that ended through
/// `until` stay ended: `ended` is part of the state of a simulation.
class BoundaryScript {
  public:
    BoundaryScript(const Model& model, const Vector3& gravity);

    /// For the step that starts at time t (s) with positions x and is step number `step`
    /// (0 first).
    void evaluate(
        double t, double dt, int step, std::span<const Vec3d> x, StepBoundary& out);

    std::vector<std::uint8_t> ended;  ///< per condition: 0 active, 1 released, 2 held

  private:
    void update_until(std::span<const Vec3d> x);
    void apply(int index,
               double t,
               double dt,
               int step,
               std::span<const Vec3d> x,
               StepBoundary& out) const;

    const Model* model_;
    Vec3d gravity_;
};

}  // namespace noli
