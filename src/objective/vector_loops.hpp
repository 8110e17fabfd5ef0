// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Sums and multiples of arrays over the vertices.

#include "core/vec.hpp"
#include "core/view.hpp"
#include "exec/later.hpp"

namespace noli::detail {

template <class Exec>
void add_scaled(Exec& exec, double s, View<const Vec3d> a, View<Vec3d> out) {
    exec.for_each(
        "objective/add_scaled", out.size, [=] NOLI_HD(int v) { out[v] += s * a[v]; });
}

template <class Exec>
void set_zero(Exec& exec, View<Vec3d> out) {
    exec.for_each("objective/set_zero", out.size, [=] NOLI_HD(int v) {
        out[v] = {0.0, 0.0, 0.0};
    });
}

template <class Exec>
void set_zero(Exec& exec, View<double> out) {
    exec.for_each(
        "objective/set_zero_scalars", out.size, [=] NOLI_HD(int v) { out[v] = 0.0; });
}

template <class Exec>
Later dot_sum(Exec& exec, View<const Vec3d> a, View<const Vec3d> b) {
    return exec.sum_later(
        "objective/dot", a.size, [=] NOLI_HD(int v) { return dot(a[v], b[v]); });
}

}  // namespace noli::detail
