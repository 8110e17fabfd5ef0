// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What keeps a tetrahedron from turning inside out under the laws that are finite there.
///
/// Stable neo-Hookean and fixed corotated let a strong enough load press an element
/// through zero volume. The step bound forbids that, and a step that wants it could then
/// not end. So below a tenth of the rest volume an element also has the energy density
///
///     c(J) = -(mu + lambda) (J - J0)^2 ln(J / J0),   0 < J < J0 = 0.1,
///
/// the form of the contact barrier (MATH 1.2, r = 1) with the volume in place of the
/// distance: twice continuously differentiable at J0, +infinity at J = 0. Neo-Hookean
/// with its logarithm needs none. Why: docs/decisions/005-crush-barrier.md.

#include "core/scalar.hpp"
#include "core/vec.hpp"
#include "energy/elastic.hpp"
#include "energy/elastic_spectrum.hpp"

#include <limits>

namespace noli {

/// Share of the rest volume below which elements resist being crushed.
inline constexpr double kCrushVolume = 0.1;

/// Whether a law lets elements turn inside out.
inline constexpr bool may_invert(ElasticModel model) {
    return model != ElasticModel::NeoHookean;
}

/// c(J) and its first two derivatives, Pa; energy +infinity and derivatives 0 for J <= 0.
template <class T>
struct CrushBarrier {
    T energy, d1, d2;
};

template <class T>
NOLI_HD inline CrushBarrier<T> crush_barrier(const T& J, const LameParameters<T>& lame) {
    const auto valid = J > T(0.0);
    const auto acts = valid & (J < T(kCrushVolume));
    const T share = select(acts, J * T(1.0 / kCrushVolume), T(1.0));  // J / J0
    const T log_share = detail::log_volume(share);
    const T gap = share - T(1.0);
    const T stiffness = lame.mu + lame.lambda;
    const T size = stiffness * T(kCrushVolume);
    const T energy = -(size * T(kCrushVolume)) * (gap * gap) * log_share;
    return {select(valid, energy, T(std::numeric_limits<double>::infinity())),
            -size * gap * (T(2.0) * log_share + gap / share),
            -stiffness * (T(2.0) * log_share + gap / share * (T(4.0) - gap / share))};
}

/// Adds the second derivative of c(J) to a law's spectrum (energy/elastic_spectrum.hpp).
template <class T>
NOLI_HD inline void add_crush(const CrushBarrier<T>& c,
                              const Vec3<T>& s,
                              ElasticSpectrum<T>& out) {
    const T yz = s.y * s.z;
    const T xz = s.x * s.z;
    const T xy = s.x * s.y;
    out.stretch.xx += c.d2 * (yz * yz);
    out.stretch.yy += c.d2 * (xz * xz);
    out.stretch.zz += c.d2 * (xy * xy);
    out.stretch.xy += c.d2 * (yz * xz) + c.d1 * s.z;
    out.stretch.xz += c.d2 * (yz * xy) + c.d1 * s.y;
    out.stretch.yz += c.d2 * (xz * xy) + c.d1 * s.x;
    out.twist += c.d1 * s;
    out.flip -= c.d1 * s;
}

}  // namespace noli
