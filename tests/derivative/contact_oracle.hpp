// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Oracle of the contact tests: the energies written down naively (cross products, ln,
/// powers) on numbers that carry their gradient and Hessian, so that every second
/// derivative is exact to rounding and shares no code with src/energy; plus random and
/// special pairs.

#include "core/stencil.hpp"
#include "geometry/pair_geometry.hpp"

#include <Eigen/Dense>

#include <array>
#include <cmath>
#include <random>

namespace noli::test {

/// A value with its gradient and Hessian with respect to N variables.
template <int N>
struct Jet {
    using Gradient = Eigen::Matrix<double, N, 1>;
    using Hessian = Eigen::Matrix<double, N, N>;
    double v = 0.0;
    Gradient g = Gradient::Zero();
    Hessian h = Hessian::Zero();

    Jet() = default;
    Jet(double value) : v(value) {}  // NOLINT: constants convert on purpose

    friend Jet operator+(const Jet& a, const Jet& b) {
        return make(a.v + b.v, a.g + b.g, a.h + b.h);
    }
    friend Jet operator-(const Jet& a, const Jet& b) {
        return make(a.v - b.v, a.g - b.g, a.h - b.h);
    }
    friend Jet operator*(const Jet& a, const Jet& b) {
        return make(
            a.v * b.v,
            a.v * b.g + b.v * a.g,
            a.v * b.h + b.v * a.h + a.g * b.g.transpose() + b.g * a.g.transpose());
    }
    friend Jet operator/(const Jet& a, const Jet& b) {
        return a * chain(b, 1.0 / b.v, -1.0 / (b.v * b.v), 2.0 / (b.v * b.v * b.v));
    }
    friend Jet log(const Jet& a) {
        return chain(a, std::log(a.v), 1.0 / a.v, -1.0 / (a.v * a.v));
    }
    friend Jet sqrt(const Jet& a) {
        const double root = std::sqrt(a.v);
        return chain(a, root, 0.5 / root, -0.25 / (a.v * root));
    }

  private:
    static Jet make(double value, const Gradient& gradient, const Hessian& hessian) {
        Jet out(value);
        out.g = gradient;
        out.h = hessian;
        return out;
    }
    static Jet chain(const Jet& a, double f, double df, double ddf) {
        return make(f, df * a.g, df * a.h + ddf * a.g * a.g.transpose());
    }
};

template <class T>
using Point = std::array<T, 3>;

template <class T>
Point<T> minus(const Point<T>& a, const Point<T>& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class T>
Point<T> times(const Point<T>& a, const Point<T>& b) {
    return {
        a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <class T>
T scalar(const Point<T>& a, const Point<T>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Squared distance of a pair; MATH 2.1 / check_math section 2.
template <class T>
T distance_sq_of(PairKind kind, const Point<T>* x) {
    if (kind == PairKind::PointPoint) return scalar(minus(x[0], x[1]), minus(x[0], x[1]));
    if (kind == PairKind::PointEdge) {
        const Point<T> n = times(minus(x[0], x[1]), minus(x[0], x[2]));
        return scalar(n, n) / scalar(minus(x[2], x[1]), minus(x[2], x[1]));
    }
    const bool triangle = kind == PairKind::PointTriangle;
    const Point<T> n = triangle ? times(minus(x[2], x[1]), minus(x[3], x[1]))
                                : times(minus(x[1], x[0]), minus(x[3], x[2]));
    const T height = scalar(triangle ? minus(x[0], x[1]) : minus(x[2], x[0]), n);
    return height * height / scalar(n, n);
}

/// (-1)^r (D - Dhat)^2 ln(D / Dhat)^r, MATH 1.2.
template <class T>
T barrier_of(int exponent, const T& d_sq, double dhat) {
    const T gap = d_sq - T(dhat * dhat);
    const T log_ratio = log(d_sq / T(dhat * dhat));
    return exponent == 1 ? T(-1.0) * gap * gap * log_ratio
                         : gap * gap * log_ratio * log_ratio;
}

/// 2 gamma / eps - gamma^2 / eps^2, MATH 3.1, gamma from the four points.
template <class T>
T mollifier_of(const Point<T>* x, double eps) {
    const Point<T> k = times(minus(x[1], x[0]), minus(x[3], x[2]));
    const T gamma = scalar(k, k);
    return T(2.0 / eps) * gamma - T(1.0 / (eps * eps)) * gamma * gamma;
}

/// The points of a stencil as variables 0 .. 3S-1.
template <int S>
std::array<Point<Jet<3 * S>>, S> variables(const Stencil<S>& x) {
    std::array<Point<Jet<3 * S>>, S> out;
    for (int i = 0; i < S; ++i) {
        for (int c = 0; c < 3; ++c) {
            out[i][c] = Jet<3 * S>(x.x[i][c]);
            out[i][c].g[3 * i + c] = 1.0;
        }
    }
    return out;
}

/// Exact value, gradient and Hessian of b(D) of a pair, kappa = 1.
template <int S>
Jet<3 * S> pair_oracle(PairKind kind, const Stencil<S>& x, int exponent, double dhat) {
    const auto points = variables(x);
    return barrier_of(exponent, distance_sq_of(kind, points.data()), dhat);
}

template <int S>
Eigen::Matrix<double, 3 * S, 1> flat(const Vec3d (&q)[S]) {
    Eigen::Matrix<double, 3 * S, 1> out;
    for (int i = 0; i < S; ++i)
        for (int c = 0; c < 3; ++c)
            out[3 * i + c] = q[i][c];
    return out;
}

/// sum_k q_k q_k^T.
template <int S, int R>
Eigen::Matrix<double, 3 * S, 3 * S> dense(const StencilModes<S, R>& modes) {
    Eigen::Matrix<double, 3 * S, 3 * S> out;
    out.setZero();
    for (int k = 0; k < modes.rank; ++k)
        out += flat(modes.q[k]) * flat(modes.q[k]).transpose();
    return out;
}

/// Positive semi-definite part of a symmetric matrix.
template <class M>
M positive_part(const M& symmetric) {
    const Eigen::SelfAdjointEigenSolver<M> eigen(symmetric);
    return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal()
         * eigen.eigenvectors().transpose();
}

/// ||a - b|| / ||b||.
template <class A, class B>
double relative_error(const A& a, const B& b) {
    return (a - b).norm() / b.norm();
}

/// Fourth-order central differences of f : R^{3S} -> R^m (columns are the variables).
template <int S, class F>
Eigen::MatrixXd central_differences(const F& f, const Stencil<S>& x, double h) {
    Eigen::MatrixXd out;
    for (int k = 0; k < 3 * S; ++k) {
        const auto at = [&](double t) -> Eigen::VectorXd {
            Stencil<S> y = x;
            y.x[k / 3][k % 3] += t * h;
            return f(y);
        };
        const Eigen::VectorXd column =
            (8.0 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12.0 * h);
        if (k == 0) out.resize(column.size(), 3 * S);
        out.col(k) = column;
    }
    return out;
}

/// Random pairs whose closest points lie inside their class.
class PairSampler {
  public:
    explicit PairSampler(unsigned seed) : rng_(seed) {}

    double uniform(double lo, double hi) {
        return std::uniform_real_distribution<>(lo, hi)(rng_);
    }
    Vec3d normal() {
        std::normal_distribution<> n;
        const double x = n(rng_);
        const double y = n(rng_);
        return {x, y, n(rng_)};
    }
    Vec3d unit_across(const Vec3d& a) { return normalized(cross(a, normal())); }

    Stencil<2> point_point(double d) {
        const Vec3d a = normal();
        return {{a, a + d * normalized(normal())}};
    }
    Stencil<3> point_edge(double d, double size) {
        const Vec3d a = size * normal();
        const Vec3d b = a + (size * uniform(0.7, 2.0)) * normalized(normal());
        return {{a + uniform(0.1, 0.9) * (b - a) + d * unit_across(b - a), a, b}};
    }
    Stencil<4> point_triangle(double d, double size) {
        for (;;) {
            const Vec3d a = size * normal();
            const Vec3d b = size * normal();
            const Vec3d c = size * normal();
            const Vec3d n = cross(b - a, c - a);
            if (norm(n) < 0.3 * size * size) continue;
            const double s = uniform(0.1, 0.6);
            const double t = uniform(0.1, 0.9 - s);
            const double side = uniform(-1.0, 1.0) < 0.0 ? -d : d;
            return {{a + s * (b - a) + t * (c - a) + side * normalized(n), a, b, c}};
        }
    }
    Stencil<4> edge_edge(double d, double size) {
        for (;;) {
            const Vec3d u = size * normal();
            const Vec3d v = size * normal();
            const Vec3d n = cross(u, v);
            if (norm(n) < 0.3 * norm(u) * norm(v)) continue;
            return crossing_edges(u, v, d);
        }
    }
    /// Edges u and v at an angle given by v, with their closest points inside.
    Stencil<4> crossing_edges(const Vec3d& u, const Vec3d& v, double d) {
        const Vec3d o = normal();
        const Vec3d a0 = o - uniform(0.1, 0.9) * u;
        const Vec3d b0 = o + d * normalized(cross(u, v)) - uniform(0.1, 0.9) * v;
        return {{a0, a0 + u, b0, b0 + v}};
    }
    /// Unit edges at the given angle (0: parallel) whose closest features are a1 and b0
    /// (PP), b0 and the first edge (PE), or both edges (EE); as check_math's mcase.
    Stencil<4> near_parallel(PairKind kind, double angle, double d) {
        const Vec3d u = normalized(normal());
        const Vec3d n = unit_across(u);
        const Vec3d v = std::cos(angle) * u + std::sin(angle) * cross(n, u);
        const Vec3d a0 = normal();
        Vec3d b0 = a0 + 0.5 * u + d * n;
        if (kind == PairKind::EdgeEdge) b0 -= 0.4 * v;
        if (kind == PairKind::PointPoint) b0 = a0 + u + d * normalized(n + 0.3 * u);
        return {{a0, a0 + u, b0, b0 + v}};
    }

  private:
    std::mt19937_64 rng_;
};

/// Calls f(kind, stencil) for one random pair of each kind.
template <class F>
void for_each_kind(PairSampler& sampler, double d, double size, const F& f) {
    f(PairKind::PointPoint, sampler.point_point(d));
    f(PairKind::PointEdge, sampler.point_edge(d, size));
    f(PairKind::PointTriangle, sampler.point_triangle(d, size));
    f(PairKind::EdgeEdge, sampler.edge_edge(d, size));
}

}  // namespace noli::test
