// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The contact law of a solve: stiffer where a tiny gap still shrinks, with a stronger
/// Hessian where steps stay short. Source: MATH 8.2, 8.8 (stiffness).

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
                            .curvature_cap = 0.0},
                .hessian = hessian_of(settings.contact.hessian),
                .mollified = hessian_of(settings.contact.mollifier)};
    }

    /// Takes back a stronger Hessian and forgets the last gap; kappa stays.
    void begin_step() {
        law_.hessian = hessian_of(settings_.contact.hessian);
        last_gap_ = HUGE_VAL;
    }

    [[nodiscard]] const ContactLaw& current() const { return law_; }
    [[nodiscard]] StiffnessRange range() const { return range_; }
    /// False with a fixed kappa.
    [[nodiscard]] bool adapts() const { return settings_.contact.kappa <= 0.0; }
    void set_kappa(double kappa) { law_.barrier.kappa = kappa; }

    /// Looks at the smallest gap (m) of an accepted state. Returns true if kappa changed.
    bool stiffen(double gap) {
        const double tiny = std::sqrt(kTinyGapSq) * settings_.diagonal;
        const bool stiffer =
            adapts() && gap < tiny && gap < last_gap_ && law_.barrier.kappa < range_.high;
        if (stiffer) law_.barrier.kappa = std::min(2.0 * law_.barrier.kappa, range_.high);
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
};

}  // namespace noli
