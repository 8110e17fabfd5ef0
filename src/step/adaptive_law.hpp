// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The contact law of a solve: stiffer where a tiny gap still shrinks, with a stronger
/// Hessian where steps stay short. Source: docs/theory/stiffness.md.

#include "step/settings.hpp"
#include "step/stiffness.hpp"

#include <algorithm>
#include <cmath>

namespace noli {

class AdaptiveLaw {
  public:
    explicit AdaptiveLaw(const StepSettings& settings)
        : settings_(settings), range_(stiffness_range(settings)) {
        law_ = {.barrier = {.dhat = settings.dhat,
                            .kappa = settings.contact.kappa,
                            .exponent = settings.contact.barrier_exponent,
                            .curvature_cap = 0.0,
                            .min_separation = settings.contact.min_separation},
                .hessian = hessian_of(settings.contact.hessian),
                .mollified = hessian_of(settings.contact.mollifier)};
    }

    /// Takes back a stronger Hessian and forgets the last gap; kappa stays.
    void begin_step() {
        law_.hessian = hessian_of(settings_.contact.hessian);
        last_gap_ = HUGE_VAL;
        dives_ = 0;
    }

    [[nodiscard]] const ContactLaw& current() const { return law_; }
    [[nodiscard]] StiffnessRange range() const { return range_; }
    /// False with a fixed kappa.
    [[nodiscard]] bool adapts() const { return settings_.contact.kappa <= 0.0; }
    void set_kappa(double kappa) { law_.barrier.kappa = kappa; }

    /// Looks at the smallest distance (m) of an accepted state. Where it is tiny and
    /// still shrinks, or where it dives (halves at least, kDives times in a row, as only
    /// the step bound lets it: nothing that the barrier does is felt), kappa rises to
    /// what would carry the present force at a gap of kWantedGap dhat, ten times at most:
    /// a step shrinks no gap more than five times, so kappa keeps up. Returns true if it
    /// changed.
    bool stiffen(double gap) {
        gap -= settings_.contact.min_separation;
        const double kappa = law_.barrier.kappa;
        const bool dives = gap < kDivingGap * settings_.dhat && gap < 0.5 * last_gap_;
        dives_ = dives ? dives_ + 1 : 0;
        const bool tiny = gap < kTinyGap * settings_.dhat && gap < last_gap_;
        const bool stiffer =
            adapts() && gap > 0.0 && (tiny || dives_ >= kDives) && kappa < range_.high;
        if (stiffer) {
            const auto slope = [&](double d) {
                return barrier_slope(law_.barrier.exponent, d, settings_.dhat);
            };
            const double factor =
                std::min(slope(gap) / slope(kWantedGap * settings_.dhat), kMostRise);
            law_.barrier.kappa = std::min(factor * kappa, range_.high);
        }
        last_gap_ = gap;
        return stiffer;
    }

    /// Moves to the next stronger Hessian; false if there is none, or none is wanted.
    bool strengthen() {
        if (!settings_.contact.strengthen || law_.hessian >= ContactHessian::Exact)
            return false;
        law_.hessian = law_.hessian == ContactHessian::GaussNewton
                         ? ContactHessian::GaussNewtonPlus
                         : ContactHessian::Exact;
        return true;
    }

  private:
    const StepSettings& settings_;
    StiffnessRange range_;
    ContactLaw law_{};
    double last_gap_ = HUGE_VAL;
    int dives_ = 0;  ///< iterations in a row in which the smallest gap has dived
};

}  // namespace noli
