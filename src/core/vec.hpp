// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Small vectors and matrices for kernels, templated on the scalar: double or a SIMD
/// pack. Aggregates without constructors, so that arrays of them can be left
/// uninitialised.

#include "core/device.hpp"

#include <cmath>

namespace noli {

template <class T>
struct Vec2 {
    T x, y;
};

template <class T>
struct Vec3 {
    T x, y, z;

    NOLI_HD T& operator[](int i) { return i == 0 ? x : (i == 1 ? y : z); }
    NOLI_HD const T& operator[](int i) const { return i == 0 ? x : (i == 1 ? y : z); }

    NOLI_HD Vec3& operator+=(const Vec3& b) {
        x += b.x;
        y += b.y;
        z += b.z;
        return *this;
    }
    NOLI_HD Vec3& operator-=(const Vec3& b) {
        x -= b.x;
        y -= b.y;
        z -= b.z;
        return *this;
    }
    NOLI_HD Vec3& operator*=(const T& s) {
        x *= s;
        y *= s;
        z *= s;
        return *this;
    }
};

template <class T>
NOLI_HD inline Vec3<T> operator+(Vec3<T> a, const Vec3<T>& b) {
    return a += b;
}
template <class T>
NOLI_HD inline Vec3<T> operator-(Vec3<T> a, const Vec3<T>& b) {
    return a -= b;
}
template <class T>
NOLI_HD inline Vec3<T> operator-(const Vec3<T>& a) {
    return {-a.x, -a.y, -a.z};
}
template <class T>
NOLI_HD inline Vec3<T> operator*(const T& s, Vec3<T> a) {
    return a *= s;
}
template <class T>
NOLI_HD inline Vec3<T> operator*(Vec3<T> a, const T& s) {
    return a *= s;
}
template <class T>
NOLI_HD inline T dot(const Vec3<T>& a, const Vec3<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
NOLI_HD inline Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
NOLI_HD inline T norm_sq(const Vec3<T>& a) {
    return dot(a, a);
}
template <class T>
NOLI_HD inline T norm(const Vec3<T>& a) {
    using std::sqrt;
    return sqrt(dot(a, a));
}
template <class T>
NOLI_HD inline Vec3<T> normalized(const Vec3<T>& a) {
    return (T(1) / norm(a)) * a;
}

/// The larger of two numbers; b if one is not a number. Unlike std::fmax no call.
NOLI_HD inline double larger(double a, double b) {
    return a > b ? a : b;
}

/// Largest absolute component.
NOLI_HD inline double max_abs(const Vec3<double>& a) {
    return larger(std::fabs(a.x), larger(std::fabs(a.y), std::fabs(a.z)));
}

/// 3x3 matrix, row-major: m(row, col).
template <class T>
struct Mat3 {
    T a[9];

    NOLI_HD T& operator()(int row, int col) { return a[3 * row + col]; }
    NOLI_HD const T& operator()(int row, int col) const { return a[3 * row + col]; }
    [[nodiscard]] NOLI_HD Vec3<T> col(int j) const { return {a[j], a[3 + j], a[6 + j]}; }
    [[nodiscard]] NOLI_HD Vec3<T> row(int i) const {
        return {a[3 * i], a[3 * i + 1], a[3 * i + 2]};
    }

    NOLI_HD Mat3& operator+=(const Mat3& b) {
        for (int k = 0; k < 9; ++k)
            a[k] += b.a[k];
        return *this;
    }
    NOLI_HD Mat3& operator*=(const T& s) {
        for (int k = 0; k < 9; ++k)
            a[k] *= s;
        return *this;
    }
};

template <class T>
NOLI_HD inline Mat3<T> operator+(Mat3<T> a, const Mat3<T>& b) {
    return a += b;
}
template <class T>
NOLI_HD inline Mat3<T> operator*(const T& s, Mat3<T> m) {
    return m *= s;
}
template <class T>
NOLI_HD inline Vec3<T> operator*(const Mat3<T>& m, const Vec3<T>& v) {
    return {m.a[0] * v.x + m.a[1] * v.y + m.a[2] * v.z,
            m.a[3] * v.x + m.a[4] * v.y + m.a[5] * v.z,
            m.a[6] * v.x + m.a[7] * v.y + m.a[8] * v.z};
}
template <class T>
NOLI_HD inline Mat3<T> operator*(const Mat3<T>& m, const Mat3<T>& n) {
    Mat3<T> out;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            out(i, j) = m(i, 0) * n(0, j) + m(i, 1) * n(1, j) + m(i, 2) * n(2, j);
    return out;
}
template <class T>
NOLI_HD inline Mat3<T> transpose(const Mat3<T>& m) {
    return {m.a[0], m.a[3], m.a[6], m.a[1], m.a[4], m.a[7], m.a[2], m.a[5], m.a[8]};
}
/// a bᵀ
template <class T>
NOLI_HD inline Mat3<T> outer(const Vec3<T>& a, const Vec3<T>& b) {
    return {a.x * b.x,
            a.x * b.y,
            a.x * b.z,
            a.y * b.x,
            a.y * b.y,
            a.y * b.z,
            a.z * b.x,
            a.z * b.y,
            a.z * b.z};
}
template <class T>
NOLI_HD inline Mat3<T> from_columns(const Vec3<T>& a,
                                    const Vec3<T>& b,
                                    const Vec3<T>& c) {
    return {a.x, b.x, c.x, a.y, b.y, c.y, a.z, b.z, c.z};
}
template <class T>
NOLI_HD inline T det(const Mat3<T>& m) {
    return dot(m.col(0), cross(m.col(1), m.col(2)));
}
/// Cofactor matrix, d det(m) / d m.
template <class T>
NOLI_HD inline Mat3<T> cofactor(const Mat3<T>& m) {
    return from_columns(
        cross(m.col(1), m.col(2)), cross(m.col(2), m.col(0)), cross(m.col(0), m.col(1)));
}
template <class T>
NOLI_HD inline Mat3<T> inverse(const Mat3<T>& m) {
    return (T(1) / det(m)) * transpose(cofactor(m));
}
NOLI_HD inline Mat3<double> identity3() {
    return {1, 0, 0, 0, 1, 0, 0, 0, 1};
}
NOLI_HD inline Mat3<double> zero3() {
    return {0, 0, 0, 0, 0, 0, 0, 0, 0};
}

using Vec2d = Vec2<double>;
using Vec3d = Vec3<double>;
using Mat3d = Mat3<double>;

struct Int2 {
    int v[2];
    NOLI_HD int operator[](int i) const { return v[i]; }
    NOLI_HD int& operator[](int i) { return v[i]; }
    friend bool operator==(const Int2&, const Int2&) = default;
};
struct Int3 {
    int v[3];
    NOLI_HD int operator[](int i) const { return v[i]; }
    NOLI_HD int& operator[](int i) { return v[i]; }
    friend bool operator==(const Int3&, const Int3&) = default;
};
struct Int4 {
    int v[4];
    NOLI_HD int operator[](int i) const { return v[i]; }
    NOLI_HD int& operator[](int i) { return v[i]; }
    friend bool operator==(const Int4&, const Int4&) = default;
};

}  // namespace noli
