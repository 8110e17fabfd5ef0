// SPDX-License-Identifier: Apache-2.0
#pragma once
/// W doubles that are computed on together (GCC vector extensions; g++ and clang only).
/// Comparisons give a mask; select(mask, a, b) picks per lane. The same function
/// templates exist for double, so a formula templated on T reads the same for both.

#include <cmath>

namespace noli {

namespace detail {

// Spelled out: g++ ignores vector_size with a template-dependent argument.
template <int W>
struct RawPack;
template <>
struct RawPack<2> {
    typedef double Values __attribute__((vector_size(16)));
    typedef long long Mask __attribute__((vector_size(16)));
};
template <>
struct RawPack<4> {
    typedef double Values __attribute__((vector_size(32)));
    typedef long long Mask __attribute__((vector_size(32)));
};
template <>
struct RawPack<8> {
    typedef double Values __attribute__((vector_size(64)));
    typedef long long Mask __attribute__((vector_size(64)));
};

}  // namespace detail

template <int W>
struct Pack {
    using Raw = typename detail::RawPack<W>::Values;
    using RawMask = typename detail::RawPack<W>::Mask;
    struct Mask {
        RawMask m;
        friend Mask operator&(Mask a, Mask b) { return {a.m & b.m}; }
        friend Mask operator|(Mask a, Mask b) { return {a.m | b.m}; }
        friend Mask operator!(Mask a) { return {~a.m}; }
    };

    Raw v;

    Pack() = default;
    // Spelled out so that aggregates of packs are copied pack by pack: g++ copies trivial
    // ones as 16-byte pieces, and loading a pack from those stalls (1.6x on the elastic
    // Hessian, AVX2).
    Pack(const Pack& b) : v(b.v) {}
    Pack& operator=(const Pack& b) {
        v = b.v;
        return *this;
    }
    Pack(double s) : v(s - Raw{}) {}  // NOLINT: scalars broadcast on purpose
    static Pack from(Raw raw) {
        Pack p;
        p.v = raw;
        return p;
    }

    double operator[](int lane) const { return v[lane]; }
    void set(int lane, double s) { v[lane] = s; }

    Pack& operator+=(const Pack& b) { return v += b.v, *this; }
    Pack& operator-=(const Pack& b) { return v -= b.v, *this; }
    Pack& operator*=(const Pack& b) { return v *= b.v, *this; }
    Pack& operator/=(const Pack& b) { return v /= b.v, *this; }
    friend Pack operator+(const Pack& a, const Pack& b) { return from(a.v + b.v); }
    friend Pack operator-(const Pack& a, const Pack& b) { return from(a.v - b.v); }
    friend Pack operator*(const Pack& a, const Pack& b) { return from(a.v * b.v); }
    friend Pack operator/(const Pack& a, const Pack& b) { return from(a.v / b.v); }
    friend Pack operator-(const Pack& a) { return from(-a.v); }
    friend Mask operator<(const Pack& a, const Pack& b) { return {a.v < b.v}; }
    friend Mask operator<=(const Pack& a, const Pack& b) { return {a.v <= b.v}; }
    friend Mask operator>(const Pack& a, const Pack& b) { return {a.v > b.v}; }
    friend Mask operator>=(const Pack& a, const Pack& b) { return {a.v >= b.v}; }

    friend Pack select(Mask mask, const Pack& a, const Pack& b) {
        return from(mask.m ? a.v : b.v);
    }
    friend Pack sqrt(const Pack& a) {
        Pack r;
        for (int i = 0; i < W; ++i)
            r.v[i] = __builtin_sqrt(a.v[i]);
        return r;
    }
    friend Pack fabs(const Pack& a) {
        const RawMask sign_bit = RawMask{} + static_cast<long long>(1ULL << 63);
        return from(reinterpret_cast<Raw>(reinterpret_cast<RawMask>(a.v) & ~sign_bit));
    }
    /// Per-lane call of a scalar function that has no vector form (log, exp, atan2 ...).
    template <class F>
    friend Pack map_lanes(const Pack& a, F f) {
        Pack r;
        for (int i = 0; i < W; ++i)
            r.v[i] = f(a.v[i]);
        return r;
    }
    friend bool any(Mask mask) {
        long long acc = 0;
        for (int i = 0; i < W; ++i)
            acc |= mask.m[i];
        return acc != 0;
    }
};

}  // namespace noli
