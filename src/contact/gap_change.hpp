// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How much a motion changes the distances of the active pairs, relative to what they
/// are.
///
/// The normal force of a barrier is lambda = -kappa b'(g), and
/// d lambda / lambda = (g b''/b') dg / g with |g b''/b'| of order 1 at small gaps: the
/// relative change of a gap bounds that of the force it carries.

#include "contact/min_gap.hpp"

#include <cmath>

namespace noli {

/// Distances of the pairs before and after a motion, m.
template <class Exec>
struct GapChangeWork {
    typename Exec::template Buffer<double> before, after;
};

namespace detail {

/// Gaps that change by no more than this many rounding errors of the coordinates have
/// settled as far as they can.
inline constexpr double kGapRounding = 64 * 2.2e-16;

/// |after - before| / before; 0 where that is rounding of coordinates of size `extent`.
NOLI_HD inline double relative_change(double before, double after, double extent) {
    const double change = std::fabs(after - before);
    return change <= kGapRounding * extent ? 0.0 : change / before;
}

}  // namespace detail

/// Largest relative change of a gap, distance less `min_separation` (m), among the pairs
/// from x, where they were found, to `moved`; -infinity without pairs.
template <class Exec>
Later largest_gap_change_later(Exec& exec,
                               const DeviceCollisionMesh<Exec>& mesh,
                               const PairSet<Exec>& pairs,
                               View<const Vec3d> x,
                               View<const Vec3d> moved,
                               double min_separation,
                               GapChangeWork<Exec>& work) {
    const detail::PairSetReader reader = detail::reader_of(mesh, pairs);
    work.before.resize(reader.size());
    work.after.resize(reader.size());
    detail::pair_distances<Doubles::First>(exec, reader, x, work.before.view());
    detail::pair_distances<Doubles::First>(exec, reader, moved, work.after.view());
    const View<const double> before = work.before.view();
    const View<const double> after = work.after.view();
    return exec.max_later("contact/gap_change", reader.size(), [=] NOLI_HD(int i) {
        const double extent = max_abs(x[reader.name(i).vertices[0]]);
        return detail::relative_change(
            before[i] - min_separation, after[i] - min_separation, extent);
    });
}

}  // namespace noli
