// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Eigenvalues and eigenvectors of small symmetric matrices inside kernels: closed form
/// for 2x2, cyclic Jacobi rotations for the fixed sizes that the exact contact Hessians
/// need (3, 5, 9). Jacobi keeps the eigenvectors orthogonal to rounding, whatever the
/// spectrum.

#include "core/device.hpp"

#include <cmath>

namespace noli {

/// Eigen-decomposition of a symmetric N x N matrix: A = sum_k values[k] vectors[k]
/// vectors[k]^T. vectors[k][i] is component i of the k-th unit eigenvector. Values come
/// in no order.
template <int N>
struct SymmetricEigen {
    double values[N];
    double vectors[N][N];
};

/// A plane rotation (cosine, sine).
struct Rotation2 {
    double cos, sin;
};

namespace detail {

/// sqrt(a^2 + b^2) without overflow or underflow.
NOLI_HD inline double hypot2(double a, double b) {
    const double x = std::fabs(a);
    const double y = std::fabs(b);
    const double big = std::fmax(x, y);
    if (!(big > 0.0)) return 0.0;
    const double ratio = std::fmin(x, y) / big;
    return big * std::sqrt(1.0 + ratio * ratio);
}

/// Rotation by theta = atan2(2 b, a - c) / 2, which turns the axes into the eigenvectors
/// of [[a, b], [b, c]]: (cos, sin) belongs to the larger eigenvalue, (-sin, cos) to the
/// smaller. Half-angle form: no trigonometric function and no cancellation for tiny b.
NOLI_HD inline Rotation2 givens_angle(double a, double b, double c) {
    const double p = 0.5 * (a - c);
    const double r = hypot2(p, b);
    if (!(r > 0.0)) return {1.0, 0.0};
    const double cos2 = p / r;
    const double sin2 = b / r;
    if (cos2 >= 0.0) {
        const double cosine = std::sqrt(0.5 * (1.0 + cos2));
        return {cosine, 0.5 * sin2 / cosine};
    }
    const double sine = std::sqrt(0.5 * (1.0 - cos2));
    return {0.5 * sin2 / sine, sine};
}

}  // namespace detail

/// Eigenvalues (larger first) and eigenvectors of [[a, b], [b, c]].
/// Source: MATH 3.3, trace/determinant form with the Givens angle.
NOLI_HD inline SymmetricEigen<2> eigen_symmetric_2x2(double a, double b, double c) {
    const double mean = 0.5 * (a + c);
    const double radius = detail::hypot2(0.5 * (a - c), b);
    const Rotation2 rot = detail::givens_angle(a, b, c);
    return {{mean + radius, mean - radius}, {{rot.cos, rot.sin}, {-rot.sin, rot.cos}}};
}

namespace detail {

/// One Jacobi rotation of the plane (p, q) that makes A[p][q] zero. Rows of V are the
/// vectors.
template <int N>
NOLI_HD inline void jacobi_rotate(double (&A)[N][N], double (&V)[N][N], int p, int q) {
    const double off = A[p][q];
    const double theta = 0.5 * (A[q][q] - A[p][p]) / off;
    const double sign = theta >= 0.0 ? 1.0 : -1.0;
    // the smaller of the two angles: the iteration then converges for every matrix
    const double t = sign / (std::fabs(theta) + hypot2(theta, 1.0));
    const double c = 1.0 / std::sqrt(1.0 + t * t);
    const double s = t * c;

    A[p][p] -= t * off;
    A[q][q] += t * off;
    A[p][q] = A[q][p] = 0.0;
    for (int k = 0; k < N; ++k) {
        if (k != p && k != q) {
            const double kp = A[k][p];
            const double kq = A[k][q];
            A[k][p] = A[p][k] = c * kp - s * kq;
            A[k][q] = A[q][k] = s * kp + c * kq;
        }
        const double vp = V[p][k];
        const double vq = V[q][k];
        V[p][k] = c * vp - s * vq;
        V[q][k] = s * vp + c * vq;
    }
}

}  // namespace detail

/// Eigen-decomposition of a symmetric matrix by cyclic Jacobi rotations.
///
/// In:      A  symmetric; both triangles are read. Finite entries.
/// Out:     orthonormal eigenvectors, residual and orthogonality of a few N eps ||A||
/// Bounded: at most kMaxSweeps sweeps; small matrices need 4 to 8.
template <int N>
NOLI_HD inline SymmetricEigen<N> eigen_symmetric(const double (&A)[N][N]) {
    constexpr int kMaxSweeps = 24;
    constexpr double kNegligible = 1e-18;  // of the largest entry: far below rounding

    double work[N][N];
    SymmetricEigen<N> out;
    double scale = 0.0;
    for (int i = 0; i < N; ++i) {
        for (int j = 0; j < N; ++j) {
            work[i][j] = A[i][j];
            out.vectors[i][j] = i == j ? 1.0 : 0.0;
            scale = std::fmax(scale, std::fabs(A[i][j]));
        }
    }
    bool rotated = scale > 0.0;
    for (int sweep = 0; sweep < kMaxSweeps && rotated; ++sweep) {
        rotated = false;
        for (int p = 0; p < N - 1; ++p) {
            for (int q = p + 1; q < N; ++q) {
                if (!(std::fabs(work[p][q]) > kNegligible * scale)) continue;
                detail::jacobi_rotate(work, out.vectors, p, q);
                rotated = true;
            }
        }
    }
    for (int i = 0; i < N; ++i)
        out.values[i] = work[i][i];
    return out;
}

}  // namespace noli
