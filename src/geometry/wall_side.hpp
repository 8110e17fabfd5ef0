// SPDX-License-Identifier: Apache-2.0
#pragma once
/// On which side of a wall a point lies, decided without rounding for the doubles that
/// describe both. Shares nothing with wall_distance but the wall's definition.

#include "geometry/exact.hpp"
#include "geometry/wall.hpp"

namespace noli {

namespace detail {

/// Exact product of two expansions: halves of the second, added up.
template <int M, int N>
NOLI_HD inline Expansion<2 * M * N> full_product(const Expansion<M>& e,
                                                 const Expansion<N>& f) {
    if constexpr (N == 1) {
        Expansion<2 * M> none;
        none.size = 0;
        return f.size == 0 ? none : scaled(e, f.term[0]);
    } else {
        Expansion<N / 2> low{};
        Expansion<N - N / 2> high{};
        NOLI_ROLLED
        for (int i = 0; i < f.size; ++i)
            i < N / 2 ? low.push_nonzero(f.term[i]) : high.push_nonzero(f.term[i]);
        return sum(full_product(e, low), full_product(e, high));
    }
}

template <int M>
NOLI_HD inline Expansion<2 * M * M> squared(const Expansion<M>& e) {
    return full_product(e, e);
}

template <int M>
NOLI_HD inline int sign_of(const Expansion<M>& e) {
    if (e.size == 0) return 0;
    return e.term[e.size - 1] > 0.0 ? 1 : -1;
}

NOLI_HD inline Expansion<1> single(double value) {
    Expansion<1> out;
    out.size = 0;
    out.push_nonzero(value);
    return out;
}

/// Sign of R^2 - |x - c|^2.
[[gnu::noinline]] NOLI_HD inline int sphere_side_exact(const Wall& wall, const Vec3d& x) {
    const ExactVec3 y = exact_difference(x, wall.center);
    const auto r_sq = sum(sum(squared(y.x), squared(y.y)), squared(y.z));
    return sign_of(sum(squared(single(wall.radius)), negated(r_sq)));
}

/// Sign of R^2 |a|^2 - |a x (x - c)|^2: the direction a need not be of unit length.
[[gnu::noinline]] NOLI_HD inline int cylinder_side_exact(const Wall& wall,
                                                         const Vec3d& x) {
    const ExactVec3 y = exact_difference(x, wall.center);
    const Vec3d& a = wall.normal;
    const auto w_x = sum(scaled(y.z, a.y), negated(scaled(y.y, a.z)));
    const auto w_y = sum(scaled(y.x, a.z), negated(scaled(y.z, a.x)));
    const auto w_z = sum(scaled(y.y, a.x), negated(scaled(y.x, a.y)));
    const auto a_sq =
        sum(sum(squared(single(a.x)), squared(single(a.y))), squared(single(a.z)));
    const auto limit = full_product(a_sq, squared(single(wall.radius)));
    const auto w_sq = sum(sum(squared(w_x), squared(w_y)), squared(w_z));
    return sign_of(sum(limit, negated(w_sq)));
}

/// The side by doubles where they tell it, else by exact arithmetic.
NOLI_HD inline int inside_side(const Wall& wall, const Vec3d& x) {
    const double rough = wall_distance(wall, x);
    const double size = size_1(x) + size_1(wall.center) + wall.radius;
    if (std::fabs(rough) > 32.0 * kUnitRoundoff * size) return rough > 0.0 ? 1 : -1;
    return wall.shape == WallShape::Sphere ? sphere_side_exact(wall, x)
                                           : cylinder_side_exact(wall, x);
}

}  // namespace detail

/// 1 where it is free, 0 on the wall, -1 beyond it. A NaN or infinity gives any of them.
/// Exact in the range of geometry/expansion.hpp; for a cylinder its direction's non-zero
/// components are to be above 2^-100.
NOLI_HD inline int wall_side(const Wall& wall, const Vec3d& x) {
    if (wall.shape != WallShape::HalfSpace) return detail::inside_side(wall, x);
    return plane_side(x, wall.normal, wall.offset);
}

}  // namespace noli
