// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Where Newton's method starts: where the last two steps lead, if that is a better place
/// than where the bodies are.

#include "core/vec.hpp"
#include "core/view.hpp"

#include <cstdint>

namespace noli::detail {

/// Displacement dt (2 v - v_prev) of the free vertices, that to their targets of the
/// prescribed ones, m. Exact for constant acceleration.
template <class Exec>
void extrapolate(Exec& exec,
                 double dt,
                 View<const std::uint8_t> fixed,
                 View<const Vec3d> target,
                 View<const Vec3d> x,
                 View<const Vec3d> v,
                 View<const Vec3d> v_prev,
                 View<Vec3d> out) {
    exec.for_each("step/extrapolate", x.size, [=] NOLI_HD(int i) {
        out[i] = fixed[i] ? target[i] - x[i] : dt * (2.0 * v[i] - v_prev[i]);
    });
}

}  // namespace noli::detail
