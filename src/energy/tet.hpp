// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Elastic energy of one linear tetrahedron with its gradient and Hessian in the four
/// vertices. Templated on the scalar: double or a SIMD pack, one tetrahedron per lane.
///
/// With g_1, g_2, g_3 the rows of D_m^-1 (the gradients of the shape functions) and
/// F = sum_a (x_a - x_0) g_a^T, the force-like gradient is P g_a and the Hessian block
///
///     H_ab = U K_ab U^T,   h_a = V^T g_a,
///     K_ab(i,i) = A_ii h_a[i] h_b[i] + sum_{m != i} alpha_im h_a[m] h_b[m]
///     K_ab(i,j) = A_ij h_a[i] h_b[j] + beta_ij h_a[j] h_b[i]
///
/// with alpha, beta = (flip +- twist) / 2 of elastic_spectrum.hpp. This never forms the
/// 9x9 matrix d2Psi/dF2, nor its nine eigenmatrices. Vertex 0 follows from translation
/// invariance: the blocks of a row add up to zero.

#include "core/vec.hpp"
#include "energy/crush.hpp"
#include "energy/elastic.hpp"
#include "energy/elastic_spectrum.hpp"
#include "energy/svd3.hpp"

namespace noli {

/// A tetrahedron as the kernels see it.
template <class T>
struct TetShape {
    Vec3<T> x[4];    ///< positions, m
    Mat3<T> dm_inv;  ///< inverse of the rest edge matrix with columns X_a - X_0, 1/m
    T weight;  ///< factor on the energy density: rest volume (m^3) times dt^2 or the like
};

/// Derivative with respect to the four vertices.
template <class T>
struct TetGradient {
    Vec3<T> g[4];
};

/// Symmetric 12x12 matrix as the 3x3 blocks (0,0) (0,1) (0,2) (0,3) (1,1) (1,2) (1,3)
/// (2,2) (2,3) (3,3). Blocks of a row add up to zero; diagonal blocks are exactly
/// symmetric.
template <class T>
struct TetHessian {
    Mat3<T> block[10];
};

/// Energy, gradient and Hessian of one tetrahedron.
template <class T>
struct TetDerivatives {
    T energy;
    TetGradient<T> gradient;
    TetHessian<T> hessian;
};

/// F = D_s D_m^-1, with columns x_a - x_0 in D_s.
template <class T>
NOLI_HD inline Mat3<T> deformation_gradient(const Vec3<T> (&x)[4],
                                            const Mat3<T>& dm_inv) {
    const Mat3<T> ds = from_columns(x[1] - x[0], x[2] - x[0], x[3] - x[0]);
    return from_columns(ds * dm_inv.col(0), ds * dm_inv.col(1), ds * dm_inv.col(2));
}

namespace detail {

/// A spectrum in the coefficients that the blocks need; index i of diag and off stands
/// for the plane normal to axis i.
template <class T>
struct BlockCoefficients {
    Symmetric3<T> stretch;
    Vec3<T> diag;  ///< alpha
    Vec3<T> off;   ///< beta
};

template <class T>
NOLI_HD inline BlockCoefficients<T> block_coefficients(const ElasticSpectrum<T>& s,
                                                       const T& weight) {
    const T half = T(0.5) * weight;
    return {{weight * s.stretch.xx,
             weight * s.stretch.yy,
             weight * s.stretch.zz,
             weight * s.stretch.xy,
             weight * s.stretch.xz,
             weight * s.stretch.yz},
            half * (s.flip + s.twist),
            half * (s.flip - s.twist)};
}

/// K_ab of the file's head.
template <class T>
NOLI_HD inline Mat3<T> singular_frame_block(const BlockCoefficients<T>& c,
                                            const Vec3<T>& h,
                                            const Vec3<T>& k) {
    const T xx = h.x * k.x;
    const T yy = h.y * k.y;
    const T zz = h.z * k.z;
    const T xy = h.x * k.y;
    const T yx = h.y * k.x;
    const T xz = h.x * k.z;
    const T zx = h.z * k.x;
    const T yz = h.y * k.z;
    const T zy = h.z * k.y;
    return {c.stretch.xx * xx + c.diag.z * yy + c.diag.y * zz,
            c.stretch.xy * xy + c.off.z * yx,
            c.stretch.xz * xz + c.off.y * zx,
            c.stretch.xy * yx + c.off.z * xy,
            c.stretch.yy * yy + c.diag.z * xx + c.diag.x * zz,
            c.stretch.yz * yz + c.off.x * zy,
            c.stretch.xz * zx + c.off.y * xz,
            c.stretch.yz * zy + c.off.x * yz,
            c.stretch.zz * zz + c.diag.y * xx + c.diag.x * yy};
}

/// u k u^T
template <class T>
NOLI_HD inline Mat3<T> rotate_block(const Mat3<T>& u, const Mat3<T>& k) {
    const Mat3<T> uk = from_columns(u * k.col(0), u * k.col(1), u * k.col(2));
    return from_columns(uk * u.row(0), uk * u.row(1), uk * u.row(2));
}

/// u k u^T for symmetric k; exactly symmetric.
template <class T>
NOLI_HD inline Mat3<T> rotate_symmetric_block(const Mat3<T>& u, const Mat3<T>& k) {
    const Vec3<T> u0 = u.row(0);
    const Vec3<T> u1 = u.row(1);
    const Vec3<T> u2 = u.row(2);
    const Vec3<T> k0 = k * u0;
    const Vec3<T> k1 = k * u1;
    const Vec3<T> k2 = k * u2;
    const T xy = dot(u0, k1);
    const T xz = dot(u0, k2);
    const T yz = dot(u1, k2);
    return {dot(u0, k0), xy, xz, xy, dot(u1, k1), yz, xz, yz, dot(u2, k2)};
}

/// -(a + b + c)
template <class T>
NOLI_HD inline Mat3<T> minus_sum(const Mat3<T>& a, const Mat3<T>& b, const Mat3<T>& c) {
    return from_columns(-(a.col(0) + b.col(0) + c.col(0)),
                        -(a.col(1) + b.col(1) + c.col(1)),
                        -(a.col(2) + b.col(2) + c.col(2)));
}

/// -(a + b + c), of which only the upper triangle is computed.
template <class T>
NOLI_HD inline Mat3<T> minus_symmetric_sum(const Mat3<T>& a,
                                           const Mat3<T>& b,
                                           const Mat3<T>& c) {
    const T xy = -(a.a[1] + b.a[1] + c.a[1]);
    const T xz = -(a.a[2] + b.a[2] + c.a[2]);
    const T yz = -(a.a[5] + b.a[5] + c.a[5]);
    return {-(a.a[0] + b.a[0] + c.a[0]),
            xy,
            xz,
            xy,
            -(a.a[4] + b.a[4] + c.a[4]),
            yz,
            xz,
            yz,
            -(a.a[8] + b.a[8] + c.a[8])};
}

template <ElasticModel M, bool kResist, class T>
NOLI_HD inline TetHessian<T> tet_hessian(const TetShape<T>& tet,
                                         const Svd3<T>& svd,
                                         const LameParameters<T>& lame,
                                         bool project) {
    ElasticSpectrum<T> spectrum = elastic_spectrum<M>(svd.sigma, lame);
    if constexpr (kResist && may_invert(M)) {
        const T J = svd.sigma.x * svd.sigma.y * svd.sigma.z;
        if (any(J < T(kCrushVolume)))
            add_crush(crush_barrier(J, lame), svd.sigma, spectrum);
    }
    if (project) spectrum = positive_part(spectrum);
    const BlockCoefficients<T> c = block_coefficients(spectrum, tet.weight);

    const Mat3<T> vt = transpose(svd.v);
    const Vec3<T> h1 = vt * tet.dm_inv.row(0);
    const Vec3<T> h2 = vt * tet.dm_inv.row(1);
    const Vec3<T> h3 = vt * tet.dm_inv.row(2);
    const Mat3<T>& u = svd.u;
    const Mat3<T> b11 = rotate_symmetric_block(u, singular_frame_block(c, h1, h1));
    const Mat3<T> b22 = rotate_symmetric_block(u, singular_frame_block(c, h2, h2));
    const Mat3<T> b33 = rotate_symmetric_block(u, singular_frame_block(c, h3, h3));
    const Mat3<T> b12 = rotate_block(u, singular_frame_block(c, h1, h2));
    const Mat3<T> b13 = rotate_block(u, singular_frame_block(c, h1, h3));
    const Mat3<T> b23 = rotate_block(u, singular_frame_block(c, h2, h3));
    const Mat3<T> b01 = minus_sum(b11, transpose(b12), transpose(b13));
    const Mat3<T> b02 = minus_sum(b12, b22, transpose(b23));
    const Mat3<T> b03 = minus_sum(b13, b23, b33);
    return {{minus_symmetric_sum(b01, b02, b03),
             b01,
             b02,
             b03,
             b11,
             b12,
             b13,
             b22,
             b23,
             b33}};
}

template <class T>
NOLI_HD inline TetGradient<T> tet_gradient(const TetShape<T>& tet,
                                           const Mat3<T>& stress) {
    const Vec3<T> g1 = tet.weight * (stress * tet.dm_inv.row(0));
    const Vec3<T> g2 = tet.weight * (stress * tet.dm_inv.row(1));
    const Vec3<T> g3 = tet.weight * (stress * tet.dm_inv.row(2));
    return {{-(g1 + g2 + g3), g1, g2, g3}};
}

}  // namespace detail

namespace detail {

template <ElasticModel M, bool kResist, class T>
NOLI_HD inline void add_crush_energy(const Mat3<T>& F,
                                     const LameParameters<T>& lame,
                                     T& energy) {
    if constexpr (kResist && may_invert(M)) {
        const T J = det(F);
        if (any(J < T(kCrushVolume))) energy += crush_barrier(J, lame).energy;
    }
}

template <ElasticModel M, bool kResist, class T>
NOLI_HD inline void add_crush_stress(const Mat3<T>& F,
                                     const LameParameters<T>& lame,
                                     Mat3<T>& stress) {
    if constexpr (kResist && may_invert(M)) {
        const T J = det(F);
        if (any(J < T(kCrushVolume)))
            stress = combine(T(1.0), stress, crush_barrier(J, lame).d1, cofactor(F));
    }
}

}  // namespace detail

/// weight * energy density; with kResist that of crush.hpp is part of it, here and below.
template <ElasticModel M, bool kResist = false, class T>
NOLI_HD inline T tet_energy(const TetShape<T>& tet, const LameParameters<T>& lame) {
    const Mat3<T> F = deformation_gradient(tet.x, tet.dm_inv);
    T energy = elastic_energy<M>(F, lame);
    detail::add_crush_energy<M, kResist>(F, lame, energy);
    return tet.weight * energy;
}

/// Gradient of tet_energy.
template <ElasticModel M, bool kResist = false, class T>
NOLI_HD inline TetGradient<T> tet_gradient(const TetShape<T>& tet,
                                           const LameParameters<T>& lame) {
    const Mat3<T> F = deformation_gradient(tet.x, tet.dm_inv);
    Mat3<T> stress = elastic_stress<M>(F, lame);
    detail::add_crush_stress<M, kResist>(F, lame, stress);
    return detail::tet_gradient(tet, stress);
}

/// Hessian of tet_energy; with `project` its nearest positive semi-definite form in
/// F-space, without it the exact one.
template <ElasticModel M, bool kResist = false, class T>
NOLI_HD inline TetHessian<T> tet_hessian(const TetShape<T>& tet,
                                         const LameParameters<T>& lame,
                                         bool project = true) {
    return detail::tet_hessian<M, kResist>(
        tet, svd3(deformation_gradient(tet.x, tet.dm_inv)), lame, project);
}

/// All three at once; bitwise equal to the separate functions.
template <ElasticModel M, bool kResist = false, class T>
NOLI_HD inline TetDerivatives<T> tet_derivatives(const TetShape<T>& tet,
                                                 const LameParameters<T>& lame,
                                                 bool project = true) {
    const Mat3<T> F = deformation_gradient(tet.x, tet.dm_inv);
    const Svd3<T> svd = svd3(F);
    Mat3<T> rotation{};
    if constexpr (detail::kNeedsSvd<M>) rotation = detail::rotation_of(svd);
    T energy = detail::energy_density<M>(F, svd.sigma, lame);
    detail::add_crush_energy<M, kResist>(F, lame, energy);
    Mat3<T> stress = detail::stress<M>(F, rotation, lame);
    detail::add_crush_stress<M, kResist>(F, lame, stress);
    return {tet.weight * energy,
            detail::tet_gradient(tet, stress),
            detail::tet_hessian<M, kResist>(tet, svd, lame, project)};
}

}  // namespace noli
