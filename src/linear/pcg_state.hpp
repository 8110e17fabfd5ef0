// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Where conjugate gradients on a device stand: all scalars of the iteration, in the
/// memory of the device, and what each of its two dot products does to them.
///
/// The host queues iterations without knowing how many it takes. Once the solver has come
/// to an end, `skip` turns the loops of later iterations into no-ops. The direction of
/// the iteration that reached the tolerance is still renewed (`hold` follows one product
/// later), so that the solver can go on to a finer one.

#include "linear/pcg_options.hpp"

#include <cmath>

namespace noli {

struct PcgState {
    enum class Status : int { Running, Reached, MaxIterations, Breakdown };

    PcgStop stop;
    double delta = 0.0;        ///< r.P⁻¹r
    double delta_start = 0.0;  ///< its first value
    double curvature = 0.0;    ///< p.Ap
    double alpha = 0.0, beta = 0.0;
    double ratio = 0.0;  ///< delta over its first value
    int iterations = 0;
    int max_iterations = 0;
    Status status = Status::Running;
    bool skip = false;  ///< the loops of an iteration do nothing
    bool hold = false;  ///< nor is the direction renewed

    /// With the first r.P⁻¹r.
    NOLI_HD void begin(double first) {
        delta = delta_start = first;
        ratio = first == 0.0 ? 0.0 : 1.0;
        if (first == 0.0)
            end(Status::Reached);
        else
            judge();
        hold = skip;
    }

    /// With p.Ap of the iteration.
    NOLI_HD void after_product(double p_dot_q) {
        hold = skip;
        if (skip) return;
        ++iterations;
        curvature = p_dot_q;
        if (curvature > 0.0)
            alpha = delta / curvature;
        else
            end(Status::Breakdown);
        hold = skip;
    }

    /// With r.P⁻¹r after the step along p.
    NOLI_HD void after_update(double next) {
        if (skip) return;
        if (!(next < HUGE_VAL)) {
            end(Status::Breakdown);
            hold = true;
            return;
        }
        beta = next / delta;
        stop.add(delta * delta / curvature);
        delta = next;
        ratio = delta / delta_start;
        judge();
    }

    /// Goes on from where a coarser tolerance was reached.
    NOLI_HD void refine(double tolerance) {
        stop.set_tolerance(tolerance);
        status = Status::Running;
        skip = hold = false;
        judge();
    }

  private:
    NOLI_HD void end(Status how) {
        status = how;
        skip = true;
    }
    NOLI_HD void judge() {
        if (stop.reached(ratio))
            end(Status::Reached);
        else if (iterations == max_iterations)
            end(Status::MaxIterations);
    }
};

}  // namespace noli
