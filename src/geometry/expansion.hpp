// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Exact sums and products of doubles, as expansions.
///
/// An expansion is a sum of doubles whose bits do not overlap, smallest magnitude first,
/// zeros left out. Adding or scaling expansions makes no rounding error at all, so the
/// sign of the result is the sign of its last (largest) term.
///
/// Source: [Shewchuk1997] sections 2.2-2.5. Round-to-nearest-even is assumed, as is the
/// absence of overflow and underflow: exact while every non-zero coordinate lies in
/// [2^-300, 2^300].
///
/// The compiler must not fuse a product into a following sum here: the host is compiled
/// with -ffp-contract=off, and device code uses intrinsics, which are never fused.

#include "core/device.hpp"

#include <cmath>

namespace noli::detail {

NOLI_HD inline double add_rn(double a, double b) {
#if defined(__CUDA_ARCH__)
    return __dadd_rn(a, b);
#else
    return a + b;
#endif
}

NOLI_HD inline double mul_rn(double a, double b) {
#if defined(__CUDA_ARCH__)
    return __dmul_rn(a, b);
#else
    return a * b;
#endif
}

/// hi + lo, where hi is the rounded result and lo its rounding error.
struct TwoTerms {
    double hi, lo;
};

/// a + b without error.
NOLI_HD inline TwoTerms two_sum(double a, double b) {
    const double sum = add_rn(a, b);
    const double b_part = add_rn(sum, -a);
    const double a_part = add_rn(sum, -b_part);
    return {sum, add_rn(add_rn(a, -a_part), add_rn(b, -b_part))};
}

/// a - b without error.
NOLI_HD inline TwoTerms two_diff(double a, double b) {
    return two_sum(a, -b);
}

/// a * b without error.
NOLI_HD inline TwoTerms two_prod(double a, double b) {
    const double product = mul_rn(a, b);
    return {product, std::fma(a, b, -product)};
}

/// At most Capacity terms; term[0..size-1] are non-zero and grow in magnitude.
template <int Capacity>
struct Expansion {
    int size;
    double term[Capacity];

    NOLI_HD void push_nonzero(double value) {
        // Exact arithmetic never fills more than Capacity; NaN and infinity would.
        if (value != 0.0 && size < Capacity) term[size++] = value;
    }
};

NOLI_HD inline Expansion<2> make_expansion(TwoTerms t) {
    Expansion<2> out;
    out.size = 0;
    out.push_nonzero(t.lo);
    out.push_nonzero(t.hi);
    return out;
}

/// Exact sum: terms of both merged by magnitude, then summed with carried rounding
/// errors. Source: [Shewchuk1997] Theorem 13 (keeps expansions strongly non-overlapping).
template <int M, int N>
NOLI_HD inline Expansion<M + N> sum(const Expansion<M>& e, const Expansion<N>& f) {
    Expansion<M + N> out;
    out.size = 0;
    int i = 0;
    int j = 0;
    double carry = 0.0;
    NOLI_ROLLED
    while (i < e.size || j < f.size) {
        const bool take_e =
            j == f.size || (i < e.size && std::fabs(e.term[i]) < std::fabs(f.term[j]));
        const double next = take_e ? e.term[i++] : f.term[j++];
        const TwoTerms s = two_sum(carry, next);
        out.push_nonzero(s.lo);
        carry = s.hi;
    }
    out.push_nonzero(carry);
    return out;
}

/// Exact product with one double. Source: [Shewchuk1997] Theorem 19.
template <int M>
NOLI_HD inline Expansion<2 * M> scaled(const Expansion<M>& e, double factor) {
    Expansion<2 * M> out;
    out.size = 0;
    double carry = 0.0;
    NOLI_ROLLED
    for (int i = 0; i < e.size; ++i) {
        const TwoTerms part = two_prod(e.term[i], factor);
        const TwoTerms low = two_sum(carry, part.lo);
        out.push_nonzero(low.lo);
        const TwoTerms high = two_sum(part.hi, low.hi);
        out.push_nonzero(high.lo);
        carry = high.hi;
    }
    out.push_nonzero(carry);
    return out;
}

/// Exact product with a two-term expansion, such as a coordinate difference.
template <int M>
NOLI_HD inline Expansion<4 * M> product(const Expansion<M>& e, const Expansion<2>& f) {
    Expansion<4 * M> out;
    out.size = 0;
    if (f.size == 0) return out;
    if (f.size == 1) {
        const Expansion<2 * M> single = scaled(e, f.term[0]);
        NOLI_ROLLED
        for (int i = 0; i < single.size; ++i)
            out.push_nonzero(single.term[i]);
        return out;
    }
    return sum(scaled(e, f.term[0]), scaled(e, f.term[1]));
}

template <int M>
NOLI_HD inline Expansion<M> negated(Expansion<M> e) {
    NOLI_ROLLED
    for (int i = 0; i < e.size; ++i)
        e.term[i] = -e.term[i];
    return e;
}

/// The double next to the exact value; relative error below 2^-50, sign exact.
template <int M>
NOLI_HD inline double rounded(const Expansion<M>& e) {
    double value = 0.0;
    NOLI_ROLLED
    for (int i = 0; i < e.size; ++i)
        value = add_rn(value, e.term[i]);
    return value;
}

/// a d - b c, exactly.
NOLI_HD inline Expansion<16> det2_exact(const Expansion<2>& a,
                                        const Expansion<2>& b,
                                        const Expansion<2>& c,
                                        const Expansion<2>& d) {
    return sum(product(a, d), negated(product(b, c)));
}

/// a d - b c to a few roundings of its value, sign exact. Coordinate differences of
/// neighbours have one term as a rule; then four terms remain. Either the rounded
/// products differ enough to dominate their rounding errors, or their difference is exact
/// (hi.lo == 0) and so are the sums below down to the sign.
NOLI_HD inline double det2_rounded(const Expansion<2>& a,
                                   const Expansion<2>& b,
                                   const Expansion<2>& c,
                                   const Expansion<2>& d) {
    if (a.size > 1 || b.size > 1 || c.size > 1 || d.size > 1)
        return rounded(det2_exact(a, b, c, d));
    const TwoTerms plus =
        a.size * d.size == 0 ? TwoTerms{0.0, 0.0} : two_prod(a.term[0], d.term[0]);
    const TwoTerms minus =
        b.size * c.size == 0 ? TwoTerms{0.0, 0.0} : two_prod(b.term[0], c.term[0]);
    const TwoTerms hi = two_diff(plus.hi, minus.hi);
    const TwoTerms lo = two_diff(plus.lo, minus.lo);
    const TwoTerms middle = two_sum(hi.lo, lo.hi);
    const TwoTerms top = two_sum(hi.hi, middle.hi);
    const TwoTerms rest = two_sum(middle.lo, lo.lo);
    const TwoTerms joint = two_sum(top.lo, rest.hi);
    return add_rn(top.hi, add_rn(joint.hi, add_rn(joint.lo, rest.lo)));
}

}  // namespace noli::detail
