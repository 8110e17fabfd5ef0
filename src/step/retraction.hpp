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
/// I is the piece's tensor of inertia, r_i the position from its centre. Where no contact
/// acts on the piece, shift and w are Newton's for inertia alone (piece_turn.hpp):
/// neither changes elastic energy, but the Hessian of a stressed body resists turns, and
/// of a small stiff body rounding alone holds it more than inertia does. The bending to a
/// rotation is of second order: it changes neither the end of Newton's method nor the
/// momentum. It may be many times a gap all the same, and lead into the contact that the
/// direction avoids; then Newton goes along the uncorrected direction, and a piece that
/// turns by less than kLeastTurn is not corrected at all. Source: retraction of a step
/// onto rotations, [Absil2008] 4.1; here of every connected piece that can turn: about
/// its centre of mass where nothing of it is prescribed, about a prescribed point or line
/// of it, a hinge, that does not turn itself (piece_turn.hpp).

#include "core/vec.hpp"
#include "core/view.hpp"
#include "exec/later.hpp"
#include "linear/rigid_aggregates.hpp"
#include "model/model.hpp"
#include "objective/inertia.hpp"
#include "step/piece_turn.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

namespace noli {

namespace detail {

/// A run of the members of a piece.
struct PieceChunk {
    int piece, begin, end;
};

template <class Exec>
void sum_turns(Exec& exec,
               View<const PieceChunk> chunks,
               View<const int> members,
               View<const int> first_member,
               InertiaViews inertia,
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
            sums.add(inertia_diagonal(inertia, v),
                     x[v] - origin,
                     p[v],
                     inertia_gradient(inertia, x[v], v),
                     fixed[v] != 0);
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
                View<const int> body,
                View<const std::uint8_t> touched,
                double share,
                View<PieceTurn> out) {
    exec.for_each("step/find_turns", out.size, [=] NOLI_HD(int piece) {
        TurnSums total{};
        for (int c = first_chunk[piece]; c < first_chunk[piece + 1]; ++c)
            total.add(sums[c]);
        const int v = members[first_member[piece]];
        out[piece] = total.turn(x[v], touched[body[v]] != 0, share);
    });
}

/// p += corrections; returns the largest component of one, 0 if there is none.
template <class Exec>
Later apply_turns(Exec& exec,
                  View<const int> piece_of_vertex,
                  View<const PieceTurn> turns,
                  View<const std::uint8_t> fixed,
                  View<const Vec3d> x,
                  View<Vec3d> p) {
    return exec.max_later("step/apply_turns", p.size, [=] NOLI_HD(int v) {
        const int piece = piece_of_vertex[v];
        if (piece < 0 || fixed[v]) return 0.0;
        const PieceTurn& turn = turns[piece];
        if (!turn.corrects()) return 0.0;
        const Vec3d r = x[v] - turn.center;
        const Vec3d correction = turn.missing_shift + cross(turn.missing_turn, r)
                               + turn_correction(turn.turn, r);
        p[v] += correction;
        return max_abs(correction);
    });
}

}  // namespace detail

/// What a direction was solved for.
struct RetractionInput {
    InertiaViews inertia;
    View<const std::uint8_t> fixed;    ///< prescribed vertices stay as they are
    View<const int> body;              ///< per vertex
    View<const std::uint8_t> touched;  ///< per body: 1 = contacts act on it
};

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

    /// Corrects the direction p (m) at x, a `share` of the one that was solved for.
    /// Returns the largest component of a correction, m.
    Later correct(Exec& exec,
                  const RetractionInput& in,
                  View<const Vec3d> x,
                  double share,
                  View<Vec3d> p) {
        if (turns_.size() == 0) return {-1, 0.0};
        detail::sum_turns(exec,
                          View<const detail::PieceChunk>(chunks_.view()),
                          View<const int>(members_.view()),
                          View<const int>(first_member_.view()),
                          in.inertia,
                          in.fixed,
                          x,
                          View<const Vec3d>(p),
                          sums_.view());
        detail::find_turns(exec,
                           View<const int>(first_chunk_.view()),
                           View<const detail::TurnSums>(sums_.view()),
                           View<const int>(members_.view()),
                           View<const int>(first_member_.view()),
                           x,
                           in.body,
                           in.touched,
                           share,
                           turns_.view());
        return detail::apply_turns(exec,
                                   View<const int>(piece_of_vertex_.view()),
                                   View<const PieceTurn>(turns_.view()),
                                   in.fixed,
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
