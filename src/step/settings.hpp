// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the step room needs to know of a scene, in absolute units.

#include "noli/scene.hpp"

#include "core/stop_flag.hpp"
#include "objective/pair_terms.hpp"

namespace noli {

struct StepSettings {
    double dt = 0.0;            ///< s
    double dhat = 0.0;          ///< m
    double epsv = 0.0;          ///< m/s
    double diagonal = 0.0;      ///< m
    double mean_mass = 0.0;     ///< kg
    double vertex_force = 0.0;  ///< largest (lambda + 2 mu) V^(2/3) of a tetrahedron, N
    bool has_friction = false;  ///< some coefficient is positive
    ContactSettings contact;
    DampingSettings damping;
    SolverSettings solver;
    bool record_iterations = false;
    StopFlag stop = nullptr;  ///< of the step at hand: cancels it
};

inline ContactHessian hessian_of(ContactModel model) {
    return static_cast<ContactHessian>(model);
}
inline MollifiedHessian hessian_of(MollifierModel model) {
    return static_cast<MollifiedHessian>(model);
}

/// The contact settings with a named formulation spelled out.
inline ContactSettings spelled_out(ContactSettings contact) {
    if (contact.model == ContactFormulation::Ipc) {
        contact.barrier_exponent = 1;
        contact.hessian = ContactModel::Numeric;
        contact.mollifier = MollifierModel::Exact;
    }
    return contact;
}

/// Constants of the numerics that are not the user's business; each says what it is for.
inline constexpr double kCcdSlack =
    0.8;  ///< share of a distance that one step may use up
inline constexpr double kKeepVolume =
    0.2;  ///< share of a tet's volume that one step must keep
inline constexpr double kFrictionUnrest =
    0.1;  ///< largest unrest of friction (energy/friction.hpp) at which Newton may end
inline constexpr int kMostUndecided =
    30;  ///< iterations in which friction alone is not settled; then the step ends so
inline constexpr double kRoughDirection =
    1e-2;  ///< squared relative energy error of a Newton direction that is not the last
inline constexpr double kRoughAfterFullStep =
    1e-1;  ///< the same after an iteration that nothing cut short
inline constexpr double kFineDirection = 1e-3;  ///< of one that may be
inline constexpr double kStoppedTurn =
    0.1;  ///< a shorter bound of a direction that turns pieces: the straight one is taken
inline constexpr int kShortStepsBeforeSwitch =
    5;  ///< then a stronger contact Hessian is tried
inline constexpr int kShortStepsBeforeStall = 60;  ///< then the step ends as stalled
inline constexpr double kTinyGap = 1e-6;           ///< of dhat: below it kappa rises
inline constexpr double kDivingGap = 1e-3;  ///< of dhat: below it kappa rises where
                                            ///< the gap dives
inline constexpr int kDives = 3;            ///< so often in a row
inline constexpr double kMostRise = 10.0;   ///< of kappa in an iteration
inline constexpr double kWantedGap =
    1e-3;  ///< of dhat: where the risen kappa is to carry the force

}  // namespace noli
