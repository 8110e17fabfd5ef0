// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How much a motion changes the normal forces of the active pairs, relative to the
/// largest of them.
///
/// The relative change of a gap bounds that of its force where gaps are small
/// (contact/gap_change.hpp). Near dhat a force goes to zero faster than any gap tells:
/// there a body that only just touches is pushed wrongly by most of its force.

#include "contact/gap_change.hpp"
#include "energy/barrier.hpp"
#include "exec/later.hpp"

#include <cmath>

namespace noli {

/// On their way to the host; forces for kappa = 1.
struct ForceChangeLater {
    Later change, force;

    /// 0 where the largest force is at most `least`.
    template <class Exec>
    [[nodiscard]] double value(Exec& exec, double least = 0.0) const {
        const double largest = exec.value(force);
        return largest > least ? exec.value(change) / largest : 0.0;
    }
};

namespace detail {

struct ForceAt {
    int exponent;
    double dhat, min_separation;

    NOLI_HD double operator()(double distance) const {
        return -barrier_slope(exponent, distance - min_separation, dhat);
    }
};

}  // namespace detail

/// Of the pairs whose distances largest_gap_change_later has left in `work`.
template <class Exec>
ForceChangeLater force_change_later(Exec& exec,
                                    const GapChangeWork<Exec>& work,
                                    int exponent,
                                    double dhat,
                                    double min_separation) {
    const View<const double> before = work.before.view();
    const View<const double> after = work.after.view();
    const detail::ForceAt force{exponent, dhat, min_separation};
    return {exec.max_later("step/force_change",
                           before.size,
                           [=] NOLI_HD(int i) {
                               return std::fabs(force(after[i]) - force(before[i]));
                           }),
            exec.max_later("step/largest_force", before.size, [=] NOLI_HD(int i) {
                const double was = force(before[i]);
                const double becomes = force(after[i]);
                return was > becomes ? was : becomes;
            })};
}

}  // namespace noli
