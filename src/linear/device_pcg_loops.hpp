// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The loops of conjugate gradients on a device. Those of an iteration take their scalars
/// from a PcgState in the memory of the device, leave their sums there, and do nothing
/// once it says that the solver has come to an end.

#include "linear/block_jacobi.hpp"
#include "linear/block_row.hpp"
#include "linear/pcg_state.hpp"
#include "linear/rigid_coarse.hpp"

#include <cstdint>

namespace noli::detail {

/// BlockProductKernel, unless the solver has come to an end.
struct GuardedProductKernel {
    View<const PcgState> state;
    BlockProductKernel product;

    template <class T>
    NOLI_HD void operator()(Lane<T> lane) const {
        if (!state[0].skip) product(lane);
    }
};

/// The state travels with the loop: nobody waits for it.
template <class Exec>
void device_set_state(Exec& exec, const PcgState& from, View<PcgState> state) {
    exec.for_each("linear/device_set_state", 1, [=] NOLI_HD(int) { state[0] = from; });
}

/// x = 0, r = b
template <class Exec>
void device_clear(Exec& exec, View<const Vec3d> b, View<Vec3d> x, View<Vec3d> r) {
    exec.for_each("linear/device_clear", x.size, [=] NOLI_HD(int i) {
        x[i] = {0, 0, 0};
        r[i] = b[i];
    });
}

/// z = P⁻¹ r with block Jacobi alone; then the state begins with r.z.
template <class Exec>
void device_begin(Exec& exec,
                  View<PcgState> state,
                  View<const SymMat3d> inverse,
                  View<const Vec3d> r,
                  View<Vec3d> z) {
    exec.sum_then(
        "linear/device_begin",
        r.size,
        [=] NOLI_HD(int i) {
            z[i] = inverse[i] * r[i];
            return dot(r[i], z[i]);
        },
        [=] NOLI_HD(double total) { state[0].begin(total); });
}

/// p.q, with which the state knows alpha.
template <class Exec>
void device_curvature(Exec& exec,
                      View<PcgState> state,
                      View<const Vec3d> p,
                      View<const Vec3d> q) {
    exec.sum_then(
        "linear/device_curvature",
        p.size,
        [=] NOLI_HD(int i) { return state[0].skip ? 0.0 : dot(p[i], q[i]); },
        [=] NOLI_HD(double total) { state[0].after_product(total); });
}

/// x += alpha p, r -= alpha q, z = P⁻¹ r with block Jacobi alone; then r.z.
template <class Exec>
void device_update(Exec& exec,
                   View<PcgState> state,
                   View<const SymMat3d> inverse,
                   View<const Vec3d> p,
                   View<const Vec3d> q,
                   View<Vec3d> x,
                   View<Vec3d> r,
                   View<Vec3d> z) {
    exec.sum_then(
        "linear/device_update",
        x.size,
        [=] NOLI_HD(int i) {
            if (state[0].skip) return 0.0;
            const double alpha = state[0].alpha;
            x[i] += alpha * p[i];
            r[i] -= alpha * q[i];
            z[i] = inverse[i] * r[i];
            return dot(r[i], z[i]);
        },
        [=] NOLI_HD(double total) { state[0].after_update(total); });
}

/// x += alpha p, r -= alpha q
template <class Exec>
void device_advance(Exec& exec,
                    View<const PcgState> state,
                    View<const Vec3d> p,
                    View<const Vec3d> q,
                    View<Vec3d> x,
                    View<Vec3d> r) {
    exec.for_each("linear/device_advance", x.size, [=] NOLI_HD(int i) {
        if (state[0].skip) return;
        const double alpha = state[0].alpha;
        x[i] += alpha * p[i];
        r[i] -= alpha * q[i];
    });
}

/// z = block Jacobi of r, or what z holds already, plus the coarse correction; then r.z.
/// At fixed vertices z = 0.
template <class Exec>
void device_combine(Exec& exec,
                    View<PcgState> state,
                    bool is_first,
                    bool keep_z,
                    View<const SymMat3d> inverse,
                    typename RigidCoarse<Exec>::Correction coarse,
                    View<const std::uint8_t> fixed,
                    View<const Vec3d> r,
                    View<Vec3d> z) {
    exec.sum_then(
        "linear/device_combine",
        r.size,
        [=] NOLI_HD(int i) {
            if (state[0].skip) return 0.0;
            if (fixed[i] != 0) {
                z[i] = {0, 0, 0};
                return 0.0;
            }
            if (!keep_z) z[i] = inverse[i] * r[i];
            z[i] += coarse.at(i);
            return dot(r[i], z[i]);
        },
        [=] NOLI_HD(double total) {
            if (is_first)
                state[0].begin(total);
            else
                state[0].after_update(total);
        });
}

/// p = z + beta p
template <class Exec>
void device_direction(Exec& exec,
                      View<const PcgState> state,
                      View<const Vec3d> z,
                      View<Vec3d> p) {
    exec.for_each("linear/device_direction", p.size, [=] NOLI_HD(int i) {
        if (!state[0].hold) p[i] = z[i] + state[0].beta * p[i];
    });
}

template <class Exec>
void device_refine(Exec& exec, View<PcgState> state, double tolerance) {
    exec.for_each(
        "linear/device_refine", 1, [=] NOLI_HD(int) { state[0].refine(tolerance); });
}

}  // namespace noli::detail
