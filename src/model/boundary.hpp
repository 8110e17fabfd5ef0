// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Boundary conditions in time: which vertices are prescribed in a step, where to, and
/// which accelerations act. Host code, once per step.

#include "model/model.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace noli {

/// Largest rotation that is travelled along a chord, degrees: shrinks by 3.4 % midway.
inline constexpr double kLargestTurn = 30.0;

/// Boundary data of one step; arrays are per vertex.
struct StepBoundary {
    std::vector<std::uint8_t> prescribed;  ///< 1 = position given by `path`
    /// Bit k: coordinate k is given by `path`, the vertex free otherwise; 0 for all
    /// others. Empty if there are no such vertices.
    std::vector<std::uint8_t> axes;
    std::vector<Vec3d> acceleration;  ///< gravity and applied forces, m/s^2
    /// Positions on the way, m: those at the end of the step come last. There is more
    /// than one entry if something turns by more than kLargestTurn in the step: a chord
    /// of such an arc would crush the body that turns.
    std::vector<std::vector<Vec3d>> path;
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
    /// The step that is evaluated.
    struct Step {
        double t, dt;
        int number;
        std::span<const Vec3d> x;
    };

    void update_until(std::span<const Vec3d> x);
    [[nodiscard]] bool acts(int index, const Step& step) const;
    [[nodiscard]] double largest_turn(const Step& step) const;
    void apply_load(int index, StepBoundary& out) const;
    void prescribe(int index, const Step& step, int leg, StepBoundary& out) const;

    const Model* model_;
    Vec3d gravity_;
};

}  // namespace noli
