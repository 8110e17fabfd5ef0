// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Rotations in a Newton direction, carried out as rotations.
///
/// A Newton direction moves every vertex along a line. A piece that turns by an angle w
/// is stretched by w^2/2 on the way; of stiff material that costs more energy than the
/// turn gains, and Newton creeps along a curved valley. So the part of the direction that
/// turns a whole free piece about its centre of mass, w x r, becomes the rotation exp(w):
///
///     p_i += (exp(w) - 1 - w x) r_i,   w = I^-1 sum_i m_i r_i x p_i
///
/// I is the piece's tensor of inertia, r_i the position from its centre. The correction
/// is of second order: it changes neither the end of Newton's method nor the momentum.
/// Where it does not pay, against a contact say, Newton goes along the uncorrected
/// direction. Source: retraction of a step onto rotations, [Absil2008] 4.1; here of every
/// connected piece without prescribed vertices.

#include "core/vec.hpp"
#include "core/view.hpp"
#include "exec/later.hpp"
#include "linear/rigid_aggregates.hpp"
#include "model/model.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace noli {

/// What turns a piece: about its centre of mass, by |turn| radians.
struct PieceTurn {
    Vec3d center;  ///< m
    Vec3d turn;    ///< rotation vector; 0 where the piece is held
};

namespace detail {

/// Sums over some vertices of a piece; positions from the piece's first vertex.
struct TurnSums {
    double mass;
    Vec3d moment;        ///< m r
    Vec3d displacement;  ///< m p
    Vec3d spin;          ///< m r x p
    double square[6];    ///< m r r^T: xx yy zz xy xz yz
    int held;            ///< prescribed vertices

    NOLI_HD void add(double m, const Vec3d& r, const Vec3d& p, bool is_held) {
        mass += m;
        moment += m * r;
        displacement += m * p;
        spin += m * cross(r, p);
        square[0] += m * r.x * r.x;
        square[1] += m * r.y * r.y;
        square[2] += m * r.z * r.z;
        square[3] += m * r.x * r.y;
        square[4] += m * r.x * r.z;
        square[5] += m * r.y * r.z;
        held += is_held ? 1 : 0;
    }
    NOLI_HD void add(const TurnSums& b) {
        mass += b.mass;
        moment += b.moment;
        displacement += b.displacement;
        spin += b.spin;
        for (int k = 0; k < 6; ++k)
            square[k] += b.square[k];
        held += b.held;
    }

    /// Rotation vector about the centre of mass.
    [[nodiscard]] NOLI_HD PieceTurn turn(const Vec3d& origin) const {
        if (held > 0 || !(mass > 0.0)) return {origin, {0.0, 0.0, 0.0}};
        const Vec3d c = (1.0 / mass) * moment;
        const Vec3d spin_about_c = spin - cross(c, displacement);
        const double xx = square[0] - mass * c.x * c.x;
        const double yy = square[1] - mass * c.y * c.y;
        const double zz = square[2] - mass * c.z * c.z;
        const double xy = square[3] - mass * c.x * c.y;
        const double xz = square[4] - mass * c.x * c.z;
        const double yz = square[5] - mass * c.y * c.z;
        const Mat3d inertia{yy + zz, -xy, -xz, -xy, xx + zz, -yz, -xz, -yz, xx + yy};
        const double size = xx + yy + zz;
        if (!(det(inertia) > 1e-12 * size * size * size)) return {origin + c, {0, 0, 0}};
        return {origin + c, inverse(inertia) * spin_about_c};
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

/// A run of the members of a piece.
struct PieceChunk {
    int piece, begin, end;
};

template <class Exec>
void sum_turns(Exec& exec,
               View<const PieceChunk> chunks,
               View<const int> members,
               View<const int> first_member,
               View<const double> mass,
               View<const std::uint8_t> fixed,
               View<const Vec3d> x,
               View<const Vec3d> p,
               View<TurnSums> out) {
    exec.for_each("step/sum_turns", chunks.size, [=] NOLI_HD(int c) {
        const PieceChunk chunk = chunks[c];
        const Vec3d origin = x[members[first_member[chunk.piece]]];
        TurnSums sums{};
        for (int k = chunk.begin; k < chunk.end; ++k) {
            const int v = members[k];
            sums.add(mass[v], x[v] - origin, p[v], fixed[v] != 0);
        }
        out[c] = sums;
    });
}

template <class Exec>
void find_turns(Exec& exec,
                View<const int> first_chunk,
                View<const TurnSums> sums,
                View<const int> members,
                View<const int> first_member,
                View<const Vec3d> x,
                View<PieceTurn> out) {
    exec.for_each("step/find_turns", out.size, [=] NOLI_HD(int piece) {
        TurnSums total{};
        for (int c = first_chunk[piece]; c < first_chunk[piece + 1]; ++c)
            total.add(sums[c]);
        out[piece] = total.turn(x[members[first_member[piece]]]);
    });
}

/// p += corrections; returns the largest component of one.
template <class Exec>
Later apply_turns(Exec& exec,
                  View<const int> piece_of_vertex,
                  View<const PieceTurn> turns,
                  View<const Vec3d> x,
                  View<Vec3d> p) {
    return exec.max_later("step/apply_turns", p.size, [=] NOLI_HD(int v) {
        const int piece = piece_of_vertex[v];
        if (piece < 0) return 0.0;
        const PieceTurn& turn = turns[piece];
        const Vec3d correction = turn_correction(turn.turn, x[v] - turn.center);
        p[v] += correction;
        return max_abs(correction);
    });
}

}  // namespace detail

template <class Exec>
class Retraction {
  public:
    Retraction(Exec& exec, const Model& model) {
        std::vector<int> order(static_cast<std::size_t>(model.num_vertices));
        for (std::size_t v = 0; v < order.size(); ++v)
            order[v] = static_cast<int>(v);
        const RigidAggregates pieces =
            cut_aggregates(model.tets, order, std::numeric_limits<int>::max() / 2);
        upload(exec, pieces);
    }

    /// Corrects the direction p (m) at x. Vertices of `fixed` are prescribed; their
    /// pieces are left alone. Returns the largest component of a correction, m.
    Later correct(Exec& exec,
                  View<const double> mass,
                  View<const std::uint8_t> fixed,
                  View<const Vec3d> x,
                  View<Vec3d> p) {
        if (turns_.size() == 0) return {-1, 0.0};
        detail::sum_turns(exec,
                          View<const detail::PieceChunk>(chunks_.view()),
                          View<const int>(members_.view()),
                          View<const int>(first_member_.view()),
                          mass,
                          fixed,
                          x,
                          View<const Vec3d>(p),
                          sums_.view());
        detail::find_turns(exec,
                           View<const int>(first_chunk_.view()),
                           View<const detail::TurnSums>(sums_.view()),
                           View<const int>(members_.view()),
                           View<const int>(first_member_.view()),
                           x,
                           turns_.view());
        return detail::apply_turns(exec,
                                   View<const int>(piece_of_vertex_.view()),
                                   View<const PieceTurn>(turns_.view()),
                                   x,
                                   p);
    }

  private:
    template <class T>
    using Buffer = typename Exec::template Buffer<T>;
    static constexpr int kChunk = 256;  ///< vertices

    void upload(Exec& exec, const RigidAggregates& pieces) {
        std::vector<int> begin(static_cast<std::size_t>(pieces.count) + 1, 0);
        for (const int piece : pieces.of_vertex)
            if (piece >= 0) ++begin[static_cast<std::size_t>(piece) + 1];
        for (std::size_t k = 1; k < begin.size(); ++k)
            begin[k] += begin[k - 1];
        std::vector<int> members(static_cast<std::size_t>(begin.back()));
        std::vector<int> next(begin.begin(), begin.end() - 1);
        for (std::size_t v = 0; v < pieces.of_vertex.size(); ++v)
            if (const int piece = pieces.of_vertex[v]; piece >= 0)
                members[static_cast<std::size_t>(
                    next[static_cast<std::size_t>(piece)]++)] = static_cast<int>(v);
        std::vector<detail::PieceChunk> chunks;
        std::vector<int> first_chunk{0};
        for (int piece = 0; piece < pieces.count; ++piece) {
            const int end = begin[static_cast<std::size_t>(piece) + 1];
            for (int k = begin[static_cast<std::size_t>(piece)]; k < end; k += kChunk)
                chunks.push_back({piece, k, std::min(k + kChunk, end)});
            first_chunk.push_back(static_cast<int>(chunks.size()));
        }
        exec.upload(pieces.of_vertex, piece_of_vertex_);
        exec.upload(begin, first_member_);
        exec.upload(members, members_);
        exec.upload(chunks, chunks_);
        exec.upload(first_chunk, first_chunk_);
        sums_.resize(static_cast<int>(chunks.size()));
        turns_.resize(pieces.count);
    }

    Buffer<int> piece_of_vertex_, first_member_, members_, first_chunk_;
    Buffer<detail::PieceChunk> chunks_;
    Buffer<detail::TurnSums> sums_;
    Buffer<PieceTurn> turns_;
};

}  // namespace noli
