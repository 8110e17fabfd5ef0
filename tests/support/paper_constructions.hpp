// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The explicit constraint Jacobians of the GIPC supplement, sections 1 and 2, as a
/// reference for the closed forms of energy/: the current and the ideal shape E, Ebar of
/// a pair's simplex, F = E Ebar^-1, and both terms of its change of basis
///
///     dF/dx = (dE/dx) Ebar^-1  -  E Ebar^-1 (dEbar/dx) Ebar^-1            Eq. (4)
///
/// The ideal shape has the same closest points moved apart along the normal to distance
/// dhat. Points are x_1 .. x_s as in the supplement, which is the order of the library:
/// PP (p, q), PE (p, a, b), PT (p, a, b, c), EE (a0, a1, b0, b1). Printed errors are
/// corrected: the sign of the normal (1.1, 1.2), the length of n_e (1.3), the side on
/// which the ideal point lies (1.4).
/// Source: [Huang2024] supplement 1, 2; MATH 1.4, 2.2.

#include "core/stencil.hpp"
#include "energy/barrier.hpp"
#include "energy/contact_pair.hpp"
#include "support/moving.hpp"

#include <Eigen/Dense>

#include <array>

namespace noli::test {

/// E, Ebar and the normal n~ (K H n for PE and PP, n itself for PT and EE) of a pair on S
/// points; m = S - 1 is the dimension of its simplex.
template <int S>
struct Shape {
    static constexpr int kDim = S - 1;
    Eigen::Matrix<double, 3, kDim> current;
    Eigen::Matrix<double, kDim, kDim> ideal;
    Eigen::Matrix<double, 3, kDim> current_rate;
    Eigen::Matrix<double, kDim, kDim> ideal_rate;
    Eigen::Matrix<double, kDim, 1> normal;
    double d;  ///< distance, m

    Eigen::Matrix<double, 3, kDim> jacobian() const { return current * ideal.inverse(); }
};

namespace detail {

template <int S>
using MovingPoints = std::array<MovingVector, S>;

/// Columns x_i - x_1.
template <int S>
void set_current(const MovingPoints<S>& x, Shape<S>& out) {
    for (int i = 1; i < S; ++i) {
        out.current.col(i - 1) = x[i].at - x[0].at;
        out.current_rate.col(i - 1) = x[i].rate - x[0].rate;
    }
}

/// Columns selection * (x_i - x_1) of the ideal points.
template <int S>
void set_ideal(const MovingPoints<S>& x,
               const Eigen::Matrix<double, S - 1, 3>& selection,
               Shape<S>& out) {
    for (int i = 1; i < S; ++i) {
        out.ideal.col(i - 1) = selection * (x[i].at - x[0].at);
        out.ideal_rate.col(i - 1) = selection * (x[i].rate - x[0].rate);
    }
}

/// Turns n so that `side` lies on its positive side, and returns the distance.
inline MovingScalar oriented_distance(const MovingVector& side, MovingVector& n) {
    if (side.at.dot(n.at) < 0.0) n = -n;
    return dot(side, n);
}

/// Supplement 1.1 and 1.2.
inline Shape<4> tetrahedron(PairKind kind, const MovingPoints<4>& x, double dhat) {
    const bool triangle = kind == PairKind::PointTriangle;
    MovingVector n = triangle ? unit(cross(x[2] - x[1], x[3] - x[1]))
                              : unit(cross(x[1] - x[0], x[3] - x[2]));
    const MovingScalar d = oriented_distance(triangle ? x[0] - x[1] : x[2] - x[0], n);
    const MovingVector shift = (dhat - d) * n;
    MovingPoints<4> ideal = x;
    if (triangle) {
        ideal[0] = x[0] + shift;
    } else {
        ideal[2] = x[2] + shift;
        ideal[3] = x[3] + shift;
    }
    Shape<4> out;
    out.normal = n.at;
    out.d = d.at;
    set_current<4>(x, out);
    set_ideal<4>(ideal, Eigen::Matrix3d::Identity(), out);
    return out;
}

/// Supplement 1.3: the triangle is turned into the plane y = 0.
inline Shape<3> triangle(const MovingPoints<3>& x, double dhat) {
    const MovingVector n_t = unit(cross(x[1] - x[0], x[2] - x[0]));
    const MovingVector n_e = unit(cross(x[1] - x[2], n_t));
    const MovingScalar d = dot(x[0] - x[1], n_e);
    const MovingMatrix H = rotation_to_y(n_t);
    const MovingPoints<3> ideal = {H * (x[0] + (dhat - d) * n_e), H * x[1], H * x[2]};
    Eigen::Matrix<double, 2, 3> K;
    K << 1.0, 0.0, 0.0, 0.0, 0.0, 1.0;
    Shape<3> out;
    out.normal = K * H.at * n_e.at;
    out.d = d.at;
    set_current<3>(x, out);
    set_ideal<3>(ideal, K, out);
    return out;
}

/// Supplement 1.4: the segment is turned onto the y axis.
inline Shape<2> segment(const MovingPoints<2>& x, double dhat) {
    const MovingVector n = unit(x[0] - x[1]);
    const MovingScalar d = dot(x[0] - x[1], n);
    const MovingMatrix H = rotation_to_y(n);
    const MovingPoints<2> ideal = {H * (x[0] + (dhat - d) * n), H * x[1]};
    const Eigen::RowVector3d K = Eigen::RowVector3d::UnitY();
    Shape<2> out;
    out.normal = K * H.at * n.at;
    out.d = d.at;
    set_current<2>(x, out);
    set_ideal<2>(ideal, K, out);
    return out;
}

}  // namespace detail

/// Shape of a pair and its rates when the points move with `velocity`.
///
/// In:  x     closest points inside the kind's class
///      dhat  activation distance, m
template <int S>
Shape<S> paper_shape(PairKind kind,
                     const Stencil<S>& x,
                     double dhat,
                     const Stencil<S>& velocity = {}) {
    detail::MovingPoints<S> points;
    for (int i = 0; i < S; ++i)
        for (int c = 0; c < 3; ++c) {
            points[i].at[c] = x.x[i][c];
            points[i].rate[c] = velocity.x[i][c];
        }
    if constexpr (S == 2) {
        return detail::segment(points, dhat);
    } else if constexpr (S == 3) {
        return detail::triangle(points, dhat);
    } else {
        return detail::tetrahedron(kind, points, dhat);
    }
}

/// The two terms of Eq. (4); column k is vec of the derivative with respect to x_k, vec
/// stacking the columns of F.
template <int S>
struct ChangeOfBasis {
    Eigen::Matrix<double, 3 * (S - 1), 3 * S> first, second;

    Eigen::Matrix<double, 3 * (S - 1), 3 * S> sum() const { return first + second; }
};

template <int S>
ChangeOfBasis<S> change_of_basis(PairKind kind, const Stencil<S>& x, double dhat) {
    ChangeOfBasis<S> out;
    for (int k = 0; k < 3 * S; ++k) {
        Stencil<S> velocity{};
        velocity.x[k / 3][k % 3] = 1.0;
        const Shape<S> shape = paper_shape(kind, x, dhat, velocity);
        const auto inverse = shape.ideal.inverse().eval();
        const Eigen::Matrix<double, 3, S - 1> first = shape.current_rate * inverse;
        const Eigen::Matrix<double, 3, S - 1> second =
            -shape.current * inverse * shape.ideal_rate * inverse;
        out.first.col(k) = first.reshaped();
        out.second.col(k) = second.reshaped();
    }
    return out;
}

/// The barrier as a function of F: g = |F n~|^2, its stress and its eigenpairs.
template <int S>
struct JacobianSpace {
    using Vec = Eigen::Matrix<double, 3 * (S - 1), 1>;
    double g;
    double lambda1;             ///< J, of the eigenmatrix kept
    double lambda23;            ///< J, of the two twists dropped
    Vec stress;                 ///< vec(db/dF) = 2 b' F n~ n~^T, J
    Vec kept;                   ///< vec of the unit eigenmatrix F n~ n~^T / sqrt(g)
    std::array<Vec, 2> twists;  ///< vec(t n~^T), t orthonormal and perpendicular to F n~
};

template <int S>
JacobianSpace<S> jacobian_space(const Shape<S>& shape, const BarrierParams& params) {
    const Eigen::Vector3d stretched = shape.jacobian() * shape.normal;
    const auto vec_with = [&](const Eigen::Vector3d& left) {
        const Eigen::Matrix<double, 3, S - 1> out = left * shape.normal.transpose();
        return typename JacobianSpace<S>::Vec(out.reshaped());
    };
    JacobianSpace<S> out;
    out.g = stretched.squaredNorm();
    const double K = params.kappa * std::pow(params.dhat, 4);
    out.lambda1 = K * barrier_lambda1(params.exponent, out.g);
    out.lambda23 = K * barrier_lambda23(params.exponent, out.g);
    out.stress = vec_with(2.0 * K * barrier(params.exponent, out.g, 1.0).d1 * stretched);
    out.kept = vec_with(stretched / std::sqrt(out.g));
    const Eigen::Vector3d t = stretched.unitOrthogonal();
    out.twists = {vec_with(t), vec_with(stretched.normalized().cross(t))};
    return out;
}

}  // namespace noli::test
