// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How a piece moves as a whole in a displacement: sums over its vertices, what it can
/// turn about, and the shift and rotation vector that fit best.

#include "core/vec.hpp"

#include <cmath>

namespace noli {

/// rad. A turn by it stretches a piece by 5e-11.
inline constexpr double kLeastTurn = 1e-5;

/// How a piece moves as a whole.
struct PieceTurn {
    Vec3d center;  ///< of mass, or of the prescribed vertices, m
    Vec3d turn;    ///< rotation vector; 0 where the piece is held or hardly turns
    /// What the direction lacks of its turn and of its shift, m; 0 where contacts act.
    Vec3d missing_turn, missing_shift;

    [[nodiscard]] NOLI_HD PieceTurn without_tiny() const {
        PieceTurn out = *this;
        if (norm_sq(turn) < kLeastTurn * kLeastTurn) out.turn = {0, 0, 0};
        return out;
    }
    [[nodiscard]] NOLI_HD bool corrects() const {
        return norm_sq(turn) + norm_sq(missing_turn) + norm_sq(missing_shift) > 0.0;
    }
};

namespace detail {

NOLI_HD inline double trace(const Mat3d& m) {
    return m(0, 0) + m(1, 1) + m(2, 2);
}

/// sum of m (r - c)(r - c)^T from the sums about zero.
NOLI_HD inline Mat3d second_moment_about(const Mat3d& square,
                                         double mass,
                                         const Vec3d& moment,
                                         const Vec3d& c) {
    return square + (-1.0) * (outer(c, moment) + outer(moment, c)) + mass * outer(c, c);
}

/// What a piece can turn about, and how that moves itself.
struct Pivot {
    enum class Kind { None, Line, Point };
    Vec3d center, shift;  ///< m
    Vec3d axis;           ///< unit, of a line
    Kind kind;
};

/// Of the second derivative along a turn, over inertia: below it the piece is about to
/// tip over, and a turn by it would go too far.
inline constexpr double kLeastStiffness = 0.01;

/// Inertia about a pivot.
struct Spinner {
    Pivot pivot;
    Mat3d inertia;      ///< tensor, kg m^2
    double about_axis;  ///< the same about the axis of a line
    bool turns;         ///< false where it has none

    /// Second derivative of inertia along turns x = c + exp(w) r, with V = sum q r^T of
    /// its gradient q: I + sym(V) - tr(V) 1. Turns nothing where it is not positive.
    [[nodiscard]] NOLI_HD Spinner pulled_by(const Mat3d& v) const {
        Spinner out = *this;
        out.inertia += 0.5 * (v + transpose(v)) + (-trace(v)) * identity3();
        const Mat3d& a = out.inertia;
        if (pivot.kind == Pivot::Kind::Point) {
            out.turns = a(0, 0) > 0.0 && a(0, 0) * a(1, 1) > a(0, 1) * a(0, 1)
                     && det(a) > kLeastStiffness * det(inertia);
        } else {
            out.about_axis = dot(pivot.axis, a * pivot.axis);
            out.turns = out.about_axis > kLeastStiffness * about_axis;
        }
        return out;
    }

    /// Rotation vector of a spin, kg m^2.
    [[nodiscard]] NOLI_HD Vec3d turned_by(const Vec3d& spin) const {
        if (pivot.kind == Pivot::Kind::Point) return inverse(inertia) * spin;
        return (dot(pivot.axis, spin) / about_axis) * pivot.axis;
    }
};

/// Sums over the prescribed vertices of a piece.
struct HeldVertices {
    int count;
    Vec3d place, shift;  ///< sums of r and p
    Mat3d square;        ///< sum of r r^T
    double shift_sq;     ///< sum of |p|^2

    NOLI_HD void add(const Vec3d& r, const Vec3d& p) {
        ++count;
        place += r;
        shift += p;
        square += outer(r, r);
        shift_sq += norm_sq(p);
    }
    NOLI_HD void add(const HeldVertices& b) {
        count += b.count;
        place += b.place;
        shift += b.shift;
        square += b.square;
        shift_sq += b.shift_sq;
    }

    /// A point or a line, where the vertices are on one and all move alike; the sums of
    /// the whole piece say how large it is and how far it moves (sum of m |p|^2).
    [[nodiscard]] NOLI_HD Pivot pivot(const Mat3d& piece_square,
                                      double mass,
                                      const Vec3d& moment,
                                      double motion_sq) const {
        constexpr double kNothing = 1e-16;  // of a square
        const double n = count;
        Pivot out{(1.0 / n) * place, (1.0 / n) * shift, {0, 0, 0}, Pivot::Kind::None};
        const double turning = shift_sq - n * norm_sq(out.shift);
        if (turning > kNothing * n * motion_sq / mass) return out;
        const Mat3d spread = second_moment_about(square, n, place, out.center);
        const double size =
            trace(second_moment_about(piece_square, mass, moment, out.center)) / mass;
        const double width = trace(spread);
        if (width <= kNothing * n * size) {
            out.kind = Pivot::Kind::Point;
            return out;
        }
        int widest = 0;
        for (int k = 1; k < 3; ++k)
            if (spread(k, k) > spread(widest, widest)) widest = k;
        Vec3d along{spread(0, widest), spread(1, widest), spread(2, widest)};
        out.axis = (1.0 / norm(along)) * along;
        // What is left beside the line.
        if (width - dot(out.axis, spread * out.axis) <= 1e-12 * width)
            out.kind = Pivot::Kind::Line;
        return out;
    }
};

/// Sums over some vertices of a piece; positions from the piece's first vertex.
struct TurnSums {
    double mass;
    Vec3d moment;        ///< m r
    Vec3d displacement;  ///< m p
    Vec3d spin;          ///< m r x p
    Mat3d square;        ///< m r r^T
    double motion_sq;    ///< m |p|^2
    Vec3d pull;          ///< q, the gradient of inertia, of vertices that are not held
    Vec3d torque;        ///< r x -q of them
    Mat3d virial;        ///< q r^T of them
    HeldVertices held;

    NOLI_HD void add(
        double m, const Vec3d& r, const Vec3d& p, const Vec3d& q, bool is_held) {
        mass += m;
        moment += m * r;
        displacement += m * p;
        spin += m * cross(r, p);
        square += m * outer(r, r);
        motion_sq += m * norm_sq(p);
        if (is_held) return held.add(r, p);
        pull += q;
        torque += cross(q, r);
        virial += outer(q, r);
    }
    NOLI_HD void add(const TurnSums& b) {
        mass += b.mass;
        moment += b.moment;
        displacement += b.displacement;
        spin += b.spin;
        square += b.square;
        motion_sq += b.motion_sq;
        pull += b.pull;
        torque += b.torque;
        virial += b.virial;
        held.add(b.held);
    }

    /// How the direction moves the piece. Where nothing touches it, elasticity has no say
    /// in that: it goes by what inertia makes of the net force and torque, times `share`.
    [[nodiscard]] NOLI_HD PieceTurn turn(const Vec3d& origin,
                                         bool is_touched,
                                         double share) const {
        PieceTurn out{origin, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
        if (!(mass > 0.0)) return out;
        const bool is_free = held.count == 0;
        const Pivot pivot = is_free ? Pivot{(1.0 / mass) * moment,
                                            (1.0 / mass) * displacement,
                                            {0, 0, 0},
                                            Pivot::Kind::Point}
                                    : held.pivot(square, mass, moment, motion_sq);
        const Vec3d& c = pivot.center;
        if (is_free && !is_touched)
            out.missing_shift = (-share / mass) * pull - pivot.shift;
        const Spinner spinner = about(pivot);
        if (!spinner.turns) return out;
        out.center = origin + c;
        const Vec3d arm = moment - mass * c;  // sum of m (r - c)
        out.turn =
            spinner.turned_by(spin - cross(c, displacement) - cross(arm, pivot.shift));
        if (is_touched || (!is_free && norm_sq(pivot.shift) > 0.0))
            return out.without_tiny();
        const Spinner newton = spinner.pulled_by(virial + (-1.0) * outer(pull, c));
        if (!newton.turns) return out.without_tiny();
        const Vec3d wanted = share * newton.turned_by(torque + cross(c, pull));
        out.missing_turn = wanted - out.turn;
        out.turn = wanted;
        return out.without_tiny();
    }

  private:
    [[nodiscard]] NOLI_HD Spinner about(const Pivot& pivot) const {
        Spinner out{pivot, zero3(), 1.0, false};
        if (pivot.kind == Pivot::Kind::None) return out;
        const Mat3d around = second_moment_about(square, mass, moment, pivot.center);
        const double size = trace(around);
        out.inertia = size * identity3() + (-1.0) * around;
        if (pivot.kind == Pivot::Kind::Point) {
            out.turns = det(out.inertia) > 1e-12 * size * size * size;
        } else {
            out.about_axis = dot(pivot.axis, out.inertia * pivot.axis);
            out.turns = out.about_axis > 1e-12 * size;
        }
        return out;
    }
};

/// (exp(w) - 1 - w x) r
NOLI_HD inline Vec3d turn_correction(const Vec3d& w, const Vec3d& r) {
    const double angle_sq = norm_sq(w);
    const double angle = std::sqrt(angle_sq);
    const bool small = angle < 1e-3;
    // sin(a)/a - 1 and (1 - cos(a))/a^2
    const double first = small ? -angle_sq / 6.0 : std::sin(angle) / angle - 1.0;
    const double half = small ? 0.5 : std::sin(0.5 * angle) / angle;
    const double second = small ? 0.5 - angle_sq / 24.0 : 2.0 * half * half;
    const Vec3d across = cross(w, r);
    return first * across + second * cross(w, across);
}

}  // namespace detail

}  // namespace noli
