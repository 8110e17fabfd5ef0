// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Values with their rate of change along one direction: enough forward differentiation
/// to carry a normal, a distance or a rotation through the constructions of the GIPC
/// supplement.

#include <Eigen/Dense>

namespace noli::test {

struct MovingScalar {
    double at, rate;
};

struct MovingVector {
    Eigen::Vector3d at, rate;
};

struct MovingMatrix {
    Eigen::Matrix3d at, rate;
};

inline MovingScalar operator-(double a, const MovingScalar& b) {
    return {a - b.at, -b.rate};
}
inline MovingVector operator-(const MovingVector& a) {
    return {-a.at, -a.rate};
}
inline MovingVector operator+(const MovingVector& a, const MovingVector& b) {
    return {a.at + b.at, a.rate + b.rate};
}
inline MovingVector operator-(const MovingVector& a, const MovingVector& b) {
    return {a.at - b.at, a.rate - b.rate};
}
inline MovingVector operator*(const MovingScalar& a, const MovingVector& b) {
    return {a.at * b.at, a.rate * b.at + a.at * b.rate};
}
inline MovingVector operator*(const MovingMatrix& a, const MovingVector& b) {
    return {a.at * b.at, a.rate * b.at + a.at * b.rate};
}
inline MovingScalar dot(const MovingVector& a, const MovingVector& b) {
    return {a.at.dot(b.at), a.rate.dot(b.at) + a.at.dot(b.rate)};
}
inline MovingVector cross(const MovingVector& a, const MovingVector& b) {
    return {a.at.cross(b.at), a.rate.cross(b.at) + a.at.cross(b.rate)};
}
inline MovingVector unit(const MovingVector& a) {
    const double length = a.at.norm();
    const Eigen::Vector3d n = a.at / length;
    return {n, (a.rate - n.dot(a.rate) * n) / length};
}

/// The rotation of Eq. (2) that takes the unit vector p to e_y: a half turn about their
/// bisector, or diag(-1, -1, 1) for p = -e_y (where it has no derivative).
inline MovingMatrix rotation_to_y(const MovingVector& p) {
    const Eigen::Vector3d q = p.at + Eigen::Vector3d::UnitY();
    const double size = q.squaredNorm();
    if (size == 0.0) {
        const Eigen::Vector3d half_turn(-1.0, -1.0, 1.0);
        return {half_turn.asDiagonal(), Eigen::Matrix3d::Zero()};
    }
    const Eigen::Matrix3d outer = q * q.transpose();
    const Eigen::Matrix3d change = p.rate * q.transpose() + q * p.rate.transpose();
    return {2.0 / size * outer - Eigen::Matrix3d::Identity(),
            2.0 / size * change - 4.0 * q.dot(p.rate) / (size * size) * outer};
}

}  // namespace noli::test
