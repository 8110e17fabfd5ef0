// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Vertices of which single coordinates are prescribed, and the others free.
///
/// With S the projection onto the free coordinates, the system of a direction
///
///     H_SS p_S = -g_S - H_SD p_D       becomes       (S H S + D) p = S (-g - H p_D),
///
/// D the diagonal of H on the prescribed coordinates: the two parts no longer know of
/// each other, the matrix stays positive definite with its pattern, and every solver
/// takes it as it is. This is elimination as for whole vertices (docs/decisions/001), by
/// values instead of by rows. These loops run only in steps that have such vertices.
///
/// axes: per vertex, bit k is set where coordinate k is prescribed; 0 for free and for
/// wholly prescribed vertices. An empty view: there are none.

#include "linear/block_matrix.hpp"
#include "linear/low_rank.hpp"

#include <cmath>
#include <cstdint>

namespace noli::detail {

/// Whether coordinate k is in the mask.
NOLI_HD inline bool has_axis(int mask, int k) {
    return ((mask >> k) & 1) != 0;
}

/// a[v] = 0 on the prescribed coordinates of v
template <class Exec>
void zero_axes(Exec& exec, View<const std::uint8_t> axes, View<Vec3d> a) {
    exec.for_each("step/zero_axes", a.size, [=] NOLI_HD(int v) {
        for (int k = 0; k < 3; ++k)
            if (has_axis(axes[v], k)) a[v][k] = 0.0;
    });
}

/// to[v] = from[v] on the prescribed coordinates of v
template <class Exec>
void copy_axes(Exec& exec,
               View<const std::uint8_t> axes,
               View<const Vec3d> from,
               View<Vec3d> to) {
    exec.for_each("step/copy_axes", to.size, [=] NOLI_HD(int v) {
        for (int k = 0; k < 3; ++k)
            if (has_axis(axes[v], k)) to[v][k] = from[v][k];
    });
}

/// out[v] = target[v] - x[v] on the prescribed coordinates of v
template <class Exec>
void remaining_on_axes(Exec& exec,
                       View<const std::uint8_t> axes,
                       View<const Vec3d> target,
                       View<const Vec3d> x,
                       View<Vec3d> out) {
    exec.for_each("step/remaining_on_axes", out.size, [=] NOLI_HD(int v) {
        for (int k = 0; k < 3; ++k)
            if (has_axis(axes[v], k)) out[v][k] = target[v][k] - x[v][k];
    });
}

/// v = (x - x_prev) / dt and a = 0 on the prescribed coordinates: how wholly prescribed
/// vertices move (integrator.hpp), whatever the integrator.
template <class Exec>
void advance_axes(Exec& exec,
                  double dt,
                  View<const std::uint8_t> axes,
                  View<const Vec3d> x_prev,
                  View<const Vec3d> x,
                  View<Vec3d> v,
                  View<Vec3d> a) {
    exec.for_each("step/advance_axes", x.size, [=] NOLI_HD(int i) {
        for (int k = 0; k < 3; ++k) {
            if (!has_axis(axes[i], k)) continue;
            v[i][k] = (1.0 / dt) * (x[i][k] - x_prev[i][k]);
            a[i][k] = 0.0;
        }
    });
}

/// S H S + D on the blocks: zero in the rows and columns of prescribed coordinates, but
/// for the diagonal.
template <class Exec>
void decouple_blocks(Exec& exec,
                     View<const std::uint8_t> axes,
                     View<const int> row_begin,
                     View<const int> col,
                     View<Mat3d> values) {
    exec.for_each("step/decouple_blocks", axes.size, [=] NOLI_HD(int i) {
        for (int b = row_begin[i]; b < row_begin[i + 1]; ++b) {
            const int j = col[b];
            if (axes[i] == 0 && axes[j] == 0) continue;
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 3; ++c) {
                    const bool held = has_axis(axes[i], r) || has_axis(axes[j], c);
                    if (held && (i != j || r != c)) values[b](r, c) = 0.0;
                }
        }
    });
}

/// S q for all modes q.
template <class Exec>
void project_modes(Exec& exec,
                   View<const std::uint8_t> axes,
                   View<const Int4> vertices,
                   View<const int> first_mode,
                   View<Mode> modes) {
    exec.for_each("step/project_modes", vertices.size, [=] NOLI_HD(int t) {
        for (int s = 0; s < kSlotsPerTerm; ++s) {
            const int v = vertices[t][s];
            if (v < 0 || axes[v] == 0) continue;
            for (int m = first_mode[t]; m < first_mode[t + 1]; ++m)
                for (int k = 0; k < 3; ++k)
                    if (has_axis(axes[v], k)) modes[m].q[s][k] = 0.0;
        }
    });
}

/// Takes the prescribed coordinates out of the assembled operator.
template <class Exec>
void decouple_axes(Exec& exec,
                   View<const std::uint8_t> axes,
                   BlockMatrix<Exec>& matrix,
                   LowRankTerms<Exec>& terms) {
    decouple_blocks(
        exec, axes, matrix.row_begin(), matrix.col(), matrix.mutable_values());
    if (terms.num_terms() > 0)
        project_modes(exec, axes, terms.terms(), terms.mode_begin(), terms.modes.view());
}

/// Largest component of a over free coordinates.
template <class Exec>
Later max_free_component(Exec& exec,
                         View<const Vec3d> a,
                         View<const std::uint8_t> fixed,
                         View<const std::uint8_t> axes) {
    return exec.max_later("step/max_free_axis", a.size, [=] NOLI_HD(int i) {
        double largest = 0.0;
        for (int k = 0; k < 3; ++k)
            if (!fixed[i] && !has_axis(axes[i], k))
                largest = std::fmax(largest, std::fabs(a[i][k]));
        return largest;
    });
}

}  // namespace noli::detail
