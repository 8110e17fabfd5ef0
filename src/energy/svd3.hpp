// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Singular values of a 3x3 matrix, and the positive part of a symmetric one, without
/// iterations.
///
/// Jacobi sweeps are one long chain of dependent square roots; in packs that latency, not
/// the arithmetic, would be the cost of the elastic Hessian. Both functions here deflate
/// instead:
///
///   1. Of the three eigenvalues of a symmetric S one lies apart from the other two. With
///      S = q I + p B and cos(3 t) = |det B| / 2 it is q +- 2 p cos(t), and its distance
///      to the others is at least sqrt(3) p: it and its axis w are well conditioned for
///      every S, repeated eigenvalues included.
///   2. In a basis (x, y, w) the rest is a 2x2 problem, which has a closed form.
///
/// For F = U diag(sigma) V^T and S = F^T F the left axis z belonging to w is F w / |F w|
/// when w is the largest stretch, and F x cross F y otherwise; in both cases the
/// couplings that are dropped are of the size of rounding errors in |F|, so small
/// singular values keep the absolute accuracy of F although S holds their squares.
///
/// No branch depends on data, and every width does the same operations in the same order.

#include "core/scalar.hpp"

namespace noli {

/// Symmetric 3x3 matrix.
template <class T>
struct Symmetric3 {
    T xx, yy, zz, xy, xz, yz;
};

/// F = u diag(sigma) v^T.
template <class T>
struct Svd3 {
    Mat3<T> u;      ///< rotation
    Vec3<T> sigma;  ///< sigma.x >= sigma.y >= |sigma.z|; sigma.z has the sign of det F
    Mat3<T> v;      ///< rotation
};

namespace detail {

/// Squared lengths below this count as zero: their inverse square root would not be
/// finite.
inline constexpr double kTinySq = 1e-290;

template <class T>
NOLI_HD inline T positive_part(const T& x) {
    return select(x > T(0.0), x, T(0.0));
}

/// 1 / sqrt(length_sq), or 0 where that is not finite.
template <class T>
NOLI_HD inline T inverse_length(const T& length_sq) {
    const auto ok = length_sq > T(kTinySq);
    return select(ok, T(1.0) / sqrt(select(ok, length_sq, T(1.0))), T(0.0));
}

/// Right-handed orthonormal basis (x, y, z) around a given unit z.
template <class T>
struct AxisFrame {
    Vec3<T> x, y, z;
};

/// The two tangents come from the reflection-free form with one division; its denominator
/// is at least 1, so the basis is orthonormal to rounding for every unit z.
template <class T>
NOLI_HD inline AxisFrame<T> axis_frame(const Vec3<T>& z) {
    const T sign = select(z.z >= T(0.0), T(1.0), T(-1.0));
    const T a = T(-1.0) / (sign + z.z);
    const T b = z.x * z.y * a;
    const T sx = sign * z.x;
    return {{T(1.0) + sx * z.x * a, sign * b, -sx}, {b, sign + z.y * z.y * a, -z.y}, z};
}

/// The root c in [cos(pi/6), 1] of 4 c^3 - 3 c = r for r in [0, 1], that is cos(acos(r) /
/// 3). Interpolation in Chebyshev points (error 3e-10) and one Newton step whose slope 1
/// / f'(c) is the derivative of the same polynomial: accurate to rounding without a
/// division.
template <class T>
NOLI_HD inline T third_angle_cosine(const T& r) {
    const T r2 = r * r;
    const T r4 = r2 * r2;
    const T c01 = T(0.8660254040506653) + r * T(0.16666661320132917);
    const T c23 = T(-0.048110721147272) + r * T(0.024667377784691635);
    const T c45 = T(-0.01542598645029998) + r * T(0.01029058277553216);
    const T c67 = T(-0.006450228776015649) + r * T(0.0032527466854347007);
    const T c89 = T(-0.0010891056513859213) + r * T(0.00017331767375223283);
    const T c = (c01 + r2 * c23) + r4 * ((c45 + r2 * c67) + r4 * c89);

    const T d01 = T(0.16666661320132917) + r * T(2 * -0.048110721147272);
    const T d23 = T(3 * 0.024667377784691635) + r * T(4 * -0.01542598645029998);
    const T d45 = T(5 * 0.01029058277553216) + r * T(6 * -0.006450228776015649);
    const T d67 = T(7 * 0.0032527466854347007) + r * T(8 * -0.0010891056513859213);
    const T slope =
        (d01 + r2 * d23) + r4 * ((d45 + r2 * d67) + r4 * T(9 * 0.00017331767375223283));
    return c - (c * (T(4.0) * (c * c) - T(3.0)) - r) * slope;
}

/// The unit eigenvector whose eigenvalue lies farthest from the other two.
template <class T>
struct IsolatedAxis {
    Vec3<T> axis;
    decltype(T{}
             < T{}) is_largest;  ///< its eigenvalue is the largest one; else the smallest
};

template <class T>
NOLI_HD inline IsolatedAxis<T> isolated_axis(const Symmetric3<T>& s) {
    const T mean = (s.xx + s.yy + s.zz) * T(1.0 / 3.0);
    const T dx = s.xx - mean;
    const T dy = s.yy - mean;
    const T dz = s.zz - mean;
    const T radius_sq = (dx * dx + dy * dy + dz * dz) * T(1.0 / 6.0)
                      + (s.xy * s.xy + s.xz * s.xz + s.yz * s.yz) * T(1.0 / 3.0);
    const T scale = inverse_length(radius_sq);
    const T bx = dx * scale;
    const T by = dy * scale;
    const T bz = dz * scale;
    const T xy = s.xy * scale;
    const T xz = s.xz * scale;
    const T yz = s.yz * scale;

    const T half_det = T(0.5)
                     * (bx * (by * bz - yz * yz) - xy * (xy * bz - yz * xz)
                        + xz * (xy * yz - by * xz));
    const auto is_largest = half_det >= T(0.0);
    const T size = select(is_largest, half_det, -half_det);
    const T twice_cosine =
        T(2.0) * third_angle_cosine(select(size < T(1.0), size, T(1.0)));
    const T value = select(is_largest, twice_cosine, -twice_cosine);

    // The adjugate of B - value I is gamma w w^T with gamma >= 3; its longest column is
    // safe.
    const T nx = bx - value;
    const T ny = by - value;
    const T nz = bz - value;
    const Vec3<T> cx{ny * nz - yz * yz, xz * yz - xy * nz, xy * yz - xz * ny};
    const Vec3<T> cy{cx.y, nx * nz - xz * xz, xy * xz - yz * nx};
    const Vec3<T> cz{cx.z, cy.z, nx * ny - xy * xy};
    const auto y_over_x = cy.y > cx.x;
    const Vec3<T> c = select3(y_over_x, cy, cx);
    const Vec3<T> longest = select3(cz.z > select(y_over_x, cy.y, cx.x), cz, c);
    return {inverse_length(norm_sq(longest)) * longest, is_largest};
}

/// [[m00, m01], [m10, m11]] = R(u) diag(large, small) R(v)^T with plane rotations R.
template <class T>
struct Svd2 {
    T u_cos, u_sin, v_cos, v_sin;
    T large, small;  ///< large >= |small|; small has the sign of the determinant
};

template <class T>
NOLI_HD inline Svd2<T> svd2(const T& m00, const T& m01, const T& m10, const T& m11) {
    // m is a scaled rotation by (u - v) plus a scaled reflection of angle (u + v)
    const T rot_x = T(0.5) * (m00 + m11);
    const T rot_y = T(0.5) * (m10 - m01);
    const T ref_x = T(0.5) * (m00 - m11);
    const T ref_y = T(0.5) * (m10 + m01);
    const T rot_sq = rot_x * rot_x + rot_y * rot_y;
    const T ref_sq = ref_x * ref_x + ref_y * ref_y;
    const T rot_inv = inverse_length(rot_sq);
    const T ref_inv = inverse_length(ref_sq);
    const auto has_rot = rot_sq > T(kTinySq);
    const auto has_ref = ref_sq > T(kTinySq);
    const T diff_cos = select(has_rot, rot_x * rot_inv, T(1.0));
    const T diff_sin = rot_y * rot_inv;
    const T sum_cos = select(has_ref, ref_x * ref_inv, T(1.0));
    const T sum_sin = ref_y * ref_inv;

    // v = half the angle between them; the form without cancellation on either half plane
    const T cos2 = sum_cos * diff_cos + sum_sin * diff_sin;
    const T sin2 = sum_sin * diff_cos - sum_cos * diff_sin;
    const auto right = cos2 >= T(0.0);
    const T main = T(1.0) + select(right, cos2, -cos2);
    const T inv = T(1.0) / sqrt(main * main + sin2 * sin2);
    Svd2<T> out;
    out.v_cos = inv * select(right, main, sin2);
    out.v_sin = inv * select(right, sin2, main);
    out.u_cos = out.v_cos * diff_cos - out.v_sin * diff_sin;
    out.u_sin = out.v_sin * diff_cos + out.v_cos * diff_sin;
    const T rot = rot_sq * rot_inv;
    const T ref = ref_sq * ref_inv;
    out.large = rot + ref;
    out.small = rot - ref;
    return out;
}

/// Columns (w, a, b) where `first`, else (a, b, w): both have the orientation of (a, b,
/// w).
template <class Mask, class T>
NOLI_HD inline Mat3<T> order_columns(Mask first,
                                     const Vec3<T>& w,
                                     const Vec3<T>& a,
                                     const Vec3<T>& b) {
    return from_columns(select3(first, w, a), select3(first, a, b), select3(first, b, w));
}

}  // namespace detail

/// Singular value decomposition with rotations on both sides.
///
/// In:      F      any finite matrix, entries within about 1e-70 .. 1e+45 in size or zero
/// Out:     u, v   rotations to a few eps; any admissible choice where sigma repeats
///          sigma  |F - u diag(sigma) v^T| is a few eps |F|, also when F is singular
template <class T>
NOLI_HD inline Svd3<T> svd3(const Mat3<T>& F) {
    const Vec3<T> f0 = F.col(0);
    const Vec3<T> f1 = F.col(1);
    const Vec3<T> f2 = F.col(2);
    const Symmetric3<T> s{
        norm_sq(f0), norm_sq(f1), norm_sq(f2), dot(f0, f1), dot(f0, f2), dot(f1, f2)};
    const detail::IsolatedAxis<T> right = detail::isolated_axis(s);
    const detail::AxisFrame<T> v = detail::axis_frame(right.axis);

    const Vec3<T> fx = F * v.x;
    const Vec3<T> fy = F * v.y;
    const Vec3<T> fw = F * v.z;
    const Vec3<T> along = select3(right.is_largest, fw, cross(fx, fy));
    const T along_sq = norm_sq(along);
    const Vec3<T> unit = detail::inverse_length(along_sq) * along;
    const Vec3<T> any_axis{T(0.0), T(0.0), T(1.0)};
    const detail::AxisFrame<T> u =
        detail::axis_frame(select3(along_sq > T(detail::kTinySq), unit, any_axis));

    const detail::Svd2<T> m =
        detail::svd2(dot(u.x, fx), dot(u.x, fy), dot(u.y, fx), dot(u.y, fy));
    const Vec3<T> sigma_isolated_first{dot(u.z, fw), m.large, m.small};
    const Vec3<T> sigma_isolated_last{m.large, m.small, sigma_isolated_first.x};
    return {detail::order_columns(right.is_largest,
                                  u.z,
                                  m.u_cos * u.x + m.u_sin * u.y,
                                  m.u_cos * u.y - m.u_sin * u.x),
            select3(right.is_largest, sigma_isolated_first, sigma_isolated_last),
            detail::order_columns(right.is_largest,
                                  v.z,
                                  m.v_cos * v.x + m.v_sin * v.y,
                                  m.v_cos * v.y - m.v_sin * v.x)};
}

/// The nearest positive semi-definite matrix: negative eigenvalues become 0.
/// Error: a few eps times the largest entry.
template <class T>
NOLI_HD inline Symmetric3<T> positive_part(const Symmetric3<T>& a) {
    const detail::AxisFrame<T> f = detail::axis_frame(detail::isolated_axis(a).axis);
    const auto times = [&a](const Vec3<T>& p) {
        return Vec3<T>{a.xx * p.x + a.xy * p.y + a.xz * p.z,
                       a.xy * p.x + a.yy * p.y + a.yz * p.z,
                       a.xz * p.x + a.yz * p.y + a.zz * p.z};
    };
    const Vec3<T> ax = times(f.x);
    const Vec3<T> ay = times(f.y);
    const T m_xx = dot(f.x, ax);
    const T m_xy = dot(f.x, ay);
    const T m_yy = dot(f.y, ay);
    const T isolated = detail::positive_part(dot(f.z, times(f.z)));

    const T mean = T(0.5) * (m_xx + m_yy);
    const T diff = T(0.5) * (m_xx - m_yy);
    const T radius_sq = diff * diff + m_xy * m_xy;
    const T inverse_radius = detail::inverse_length(radius_sq);
    const T radius = radius_sq * inverse_radius;
    const T high = detail::positive_part(mean + radius);
    const T low = detail::positive_part(mean - radius);
    const T shrink = T(0.5) * (high - low) * inverse_radius;
    const T new_mean = T(0.5) * (high + low);

    const Vec3<T> w = isolated * f.z;
    const Vec3<T> p = (new_mean + shrink * diff) * f.x + (shrink * m_xy) * f.y;
    const Vec3<T> q = (shrink * m_xy) * f.x + (new_mean - shrink * diff) * f.y;
    return {w.x * f.z.x + p.x * f.x.x + q.x * f.y.x,
            w.y * f.z.y + p.y * f.x.y + q.y * f.y.y,
            w.z * f.z.z + p.z * f.x.z + q.z * f.y.z,
            w.x * f.z.y + p.x * f.x.y + q.x * f.y.y,
            w.x * f.z.z + p.x * f.x.z + q.x * f.y.z,
            w.y * f.z.z + p.y * f.x.z + q.y * f.y.z};
}

}  // namespace noli
