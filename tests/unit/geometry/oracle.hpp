// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Independent truths for the tests of src/geometry: random inputs of all kinds,
/// distances by enumeration in 113-bit arithmetic, exact signs in 128-bit integers.

#include "core/stencil.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace noli::test {

class Random {
  public:
    explicit Random(unsigned seed) : engine_(seed) {}
    double uniform(double lo, double hi) {
        return std::uniform_real_distribution<double>(lo, hi)(engine_);
    }
    int integer(int lo, int hi) {
        return std::uniform_int_distribution<int>(lo, hi)(engine_);
    }
    bool chance(double probability) { return uniform(0.0, 1.0) < probability; }
    /// 10^u with u uniform in [lo, hi].
    double log_uniform(double lo, double hi) { return std::pow(10.0, uniform(lo, hi)); }
    Vec3d vec(double size = 1.0) {
        return {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
    }
    template <int S>
    Stencil<S> stencil(double size = 1.0) {
        Stencil<S> s;
        for (Vec3d& x : s.x)
            x = vec(size);
        return s;
    }

  private:
    std::mt19937_64 engine_;
};

// ---- distances
// -----------------------------------------------------------------------------------

__extension__ typedef __float128 Quad;
using Vec3q = Vec3<Quad>;

inline Vec3q quad(const Vec3d& a) {
    return {Quad(a.x), Quad(a.y), Quad(a.z)};
}

inline Quad quad_sqrt(Quad a) {
    if (!(a > 0)) return 0;
    Quad root = Quad(std::sqrt(double(a)));
    if (root == 0) return 0;
    root = (root + a / root) / 2;
    return (root + a / root) / 2;
}

inline Quad point_segment_sq(const Vec3q& p, const Vec3q& a, const Vec3q& b) {
    const Vec3q e = b - a;
    const Quad length_sq = dot(e, e);
    Quad t = length_sq > 0 ? dot(p - a, e) / length_sq : Quad(0);
    t = t < 0 ? Quad(0) : (t > 1 ? Quad(1) : t);
    return norm_sq(p - a - t * e);
}

/// Squared distance of point x0 and triangle x1 x2 x3: the stationary point of the plane
/// if it is inside, else the best of the three sides.
inline double point_triangle_sq(const Stencil<4>& s) {
    const Vec3q p = quad(s.x[0]), a = quad(s.x[1]), b = quad(s.x[2]), c = quad(s.x[3]);
    Quad best = std::min({point_segment_sq(p, a, b),
                          point_segment_sq(p, b, c),
                          point_segment_sq(p, c, a)});
    const Vec3q e = b - a, f = c - a, r = p - a;
    const Vec3q N = cross(e, f);
    const Quad nn = norm_sq(N);
    if (nn > 0) {
        const Quad u = dot(cross(r, f), N) / nn;
        const Quad v = dot(cross(e, r), N) / nn;
        const Quad volume = dot(r, N);
        if (u >= 0 && v >= 0 && u + v <= 1) best = std::min(best, volume * volume / nn);
    }
    return double(best);
}

/// Squared distance of segments x0 x1 and x2 x3, likewise.
inline double edge_edge_sq(const Stencil<4>& s) {
    const Vec3q a0 = quad(s.x[0]), a1 = quad(s.x[1]), b0 = quad(s.x[2]),
                b1 = quad(s.x[3]);
    Quad best = std::min({point_segment_sq(a0, b0, b1),
                          point_segment_sq(a1, b0, b1),
                          point_segment_sq(b0, a0, a1),
                          point_segment_sq(b1, a0, a1)});
    const Vec3q u = a1 - a0, v = b1 - b0, w = a0 - b0;
    const Vec3q N = cross(u, v);
    const Quad nn = norm_sq(N);
    if (nn > 0) {
        const Quad sigma = dot(cross(v, w), N) / nn;
        const Quad tau = dot(cross(u, w), N) / nn;
        const Quad volume = dot(w, N);
        if (sigma >= 0 && sigma <= 1 && tau >= 0 && tau <= 1)
            best = std::min(best, volume * volume / nn);
    }
    return double(best);
}

/// The same by minimising a convex function of one variable, with the other one
/// eliminated: ternary search, no case distinctions.
template <class Line>
double least_point_segment_sq(Line&& segment_at) {
    long double lo = 0, hi = 1;
    const auto value = [&](long double t) {
        Vec3<long double> p, a, b;
        segment_at(t, p, a, b);
        const Vec3<long double> e = b - a;
        const long double length_sq = dot(e, e);
        long double s = length_sq > 0 ? dot(p - a, e) / length_sq : 0;
        s = std::clamp(s, 0.0L, 1.0L);
        return norm_sq(p - a - s * e);
    };
    for (int i = 0; i < 100; ++i) {
        const long double third = (hi - lo) / 3;
        if (value(lo + third) < value(hi - third))
            hi -= third;
        else
            lo += third;
    }
    return double(std::min({value(0), value(1), value((lo + hi) / 2)}));
}

inline Vec3<long double> extended(const Vec3d& a) {
    return {a.x, a.y, a.z};
}

inline double point_triangle_sq_by_search(const Stencil<4>& s) {
    const auto p = extended(s.x[0]), a = extended(s.x[1]);
    const auto e = extended(s.x[2]) - a, f = extended(s.x[3]) - a;
    return least_point_segment_sq([=](long double u, auto& point, auto& from, auto& to) {
        point = p;
        from = a + u * e;
        to = from + (1 - u) * f;
    });
}

inline double edge_edge_sq_by_search(const Stencil<4>& s) {
    const auto a0 = extended(s.x[0]), u = extended(s.x[1]) - a0;
    const auto b0 = extended(s.x[2]), b1 = extended(s.x[3]);
    return least_point_segment_sq([=](long double t, auto& point, auto& from, auto& to) {
        point = a0 + t * u;
        from = b0;
        to = b1;
    });
}

/// Four points near each other in every degenerate way: repeated points, collinear and
/// coplanar ones, parallel and nearly parallel edges, slivers.
inline Stencil<4> degenerate_stencil(Random& random) {
    Stencil<4> s = random.stencil<4>();
    const int kind = random.integer(0, 7);
    const double tiny = random.chance(0.3) ? 0.0 : random.log_uniform(-17, -3);
    const int i = random.integer(0, 3), j = random.integer(0, 3),
              k = random.integer(0, 3);
    if (kind == 0) s.x[i] = s.x[j] + tiny * random.vec();
    if (kind == 1)
        s.x[i] = s.x[j] + random.uniform(-1, 2) * (s.x[k] - s.x[j]) + tiny * random.vec();
    if (kind == 2)
        s.x[3] = s.x[2] + random.uniform(-2, 2) * (s.x[1] - s.x[0]) + tiny * random.vec();
    if (kind == 3)
        s.x[0] = s.x[1] + random.uniform(-1, 2) * (s.x[2] - s.x[1])
               + random.uniform(-1, 2) * (s.x[3] - s.x[1]) + tiny * random.vec();
    if (kind == 4)
        for (int q = 1; q < 4; ++q)
            s.x[q] =
                s.x[0] + random.uniform(-1, 1) * Vec3d{1, 1, 0} + tiny * random.vec();
    if (kind == 5)
        for (Vec3d& x : s.x)
            x = {double(random.integer(-1, 1)),
                 double(random.integer(-1, 1)),
                 double(random.integer(-1, 1))};
    if (kind == 6)
        s.x[3] = s.x[1] + random.uniform(-1, 2) * (s.x[2] - s.x[1]) + tiny * random.vec();
    if (kind == 7) {
        const double size = random.log_uniform(-6, 6);
        for (Vec3d& x : s.x)
            x = size * x;
    }
    return s;
}

inline double size_of(const Stencil<4>& s) {
    double size = 0;
    for (const Vec3d& x : s.x)
        size = std::max(size, max_abs(x));
    return size;
}

// ---- exact signs
// ---------------------------------------------------------------------------------

__extension__ typedef __int128 Int128;

/// Coordinates below 2^40 in magnitude keep every determinant below 2^127.
struct IntPoint {
    Int128 x, y, z;
};

inline IntPoint operator-(const IntPoint& a, const IntPoint& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}

inline int sign(Int128 a) {
    return (a > 0) - (a < 0);
}

inline int orient3d(const IntPoint& a,
                    const IntPoint& b,
                    const IntPoint& c,
                    const IntPoint& d) {
    const IntPoint u = b - a, v = c - a, w = d - a;
    return sign((u.y * v.z - u.z * v.y) * w.x + (u.z * v.x - u.x * v.z) * w.y
                + (u.x * v.y - u.y * v.x) * w.z);
}

}  // namespace noli::test
