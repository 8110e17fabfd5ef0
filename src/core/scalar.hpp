// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The double versions of what core/pack.hpp offers for packs, so that a formula
/// templated on its scalar type reads the same for both.

#include "core/vec.hpp"

#include <cmath>

namespace noli {

using std::fabs;
using std::sqrt;

NOLI_HD inline double select(bool mask, double a, double b) {
    return mask ? a : b;
}
/// The same per component, for double and for packs.
template <class Mask, class T>
NOLI_HD inline Vec3<T> select3(Mask mask, const Vec3<T>& a, const Vec3<T>& b) {
    return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}
NOLI_HD inline bool any(bool mask) {
    return mask;
}
template <class F>
NOLI_HD inline double map_lanes(double a, F f) {
    return f(a);
}

}  // namespace noli
