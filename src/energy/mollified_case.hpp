// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The distance of a nearly parallel edge-edge pair: that of the sub-case that is closest
/// (point-point, point-edge or edge-edge), on all four vertices of the two edges; those
/// that take no part have weight zero. Source: MATH 3.1.

#include "core/stencil.hpp"
#include "energy/contact_frame.hpp"

namespace noli {

/// The sub-case of a mollified pair: local[i] is the place of its i-th point among
/// (a0, a1, b0, b1), points ordered as in its kind (PP: p, q; PE: p, a, b; EE: a0, a1,
/// b0, b1).
struct MollifiedCase {
    PairKind kind;
    int local[4];
};

namespace detail {

/// Copies a sub-case's frame to the four edge vertices, zero weights elsewhere.
template <int S, class Stage>
NOLI_HD inline ContactFrame<4> embed_frame(const MollifiedCase& sub,
                                           const Stencil<4>& x,
                                           Stage& stage) {
    Stencil<S> points;
    for (int j = 0; j < S; ++j)
        points.x[j] = x.x[sub.local[j]];
    const ContactFrame<S> from = contact_frame(sub.kind, points, stage);
    ContactFrame<4> to{};
    to.d = from.d;
    to.n = from.n;
    to.num_tangents = from.num_tangents;
    for (int k = 0; k < from.num_tangents; ++k)
        to.t[k] = from.t[k];
    for (int j = 0; j < S; ++j) {
        to.w[sub.local[j]] = from.w[j];
        for (int k = 0; k < from.num_tangents; ++k)
            to.v[k][sub.local[j]] = from.v[k][j];
    }
    return to;
}

template <int S, class Stage>
NOLI_HD inline PairGeometry<4> embed_geometry(const MollifiedCase& sub,
                                              const Stencil<4>& x,
                                              Stage& stage) {
    Stencil<S> points;
    for (int j = 0; j < S; ++j)
        points.x[j] = x.x[sub.local[j]];
    const PairGeometry<S> from = pair_geometry(sub.kind, points, stage);
    PairGeometry<4> to{};
    to.d = from.d;
    to.n = from.n;
    for (int j = 0; j < S; ++j)
        to.w[sub.local[j]] = from.w[j];
    return to;
}

template <class Stage>
NOLI_HD inline ContactFrame<4> mollified_frame(const MollifiedCase& sub,
                                               const Stencil<4>& x,
                                               Stage& stage) {
    if (sub.kind == PairKind::PointPoint) return embed_frame<2>(sub, x, stage);
    if (sub.kind == PairKind::PointEdge) return embed_frame<3>(sub, x, stage);
    return embed_frame<4>(sub, x, stage);
}

}  // namespace detail

/// Distance, normal and weights of the sub-case on the four edge vertices.
template <class Stage = Exactly>
NOLI_HD inline PairGeometry<4> mollified_geometry(const MollifiedCase& sub,
                                                  const Stencil<4>& x,
                                                  Stage&& stage = {}) {
    if (sub.kind == PairKind::PointPoint) return detail::embed_geometry<2>(sub, x, stage);
    if (sub.kind == PairKind::PointEdge) return detail::embed_geometry<3>(sub, x, stage);
    return detail::embed_geometry<4>(sub, x, stage);
}

}  // namespace noli
