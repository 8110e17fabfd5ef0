// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the loops over contact pairs do with one pair: its energy, or its gradient and
/// modes as a low-rank term of the operator. Formulas are in energy/.
///
/// Where doubles do not suffice, an energy is NaN and a gradient too: loops in doubles
/// only are for pairs that are known to do with them (PairSet::doubles), and an error
/// there is not to pass unseen.

#include "contact/pairs.hpp"
#include "energy/contact_pair.hpp"
#include "energy/mollified_pair.hpp"
#include "energy/numeric_hessian.hpp"
#include "energy/wall.hpp"
#include "linear/low_rank.hpp"

namespace noli {

/// The Hessian models in use and the barrier's constants.
struct ContactLaw {
    BarrierParams barrier;
    ContactHessian hessian;
    MollifiedHessian mollified;
};

/// Where the terms of one pair type go: from `term` and `mode` on, `rank` modes each.
struct TermRange {
    View<Int4> vertices;   ///< per term, -1 = unused
    View<int> first_mode;  ///< per term
    View<Mode> modes;
    View<Vec3d> gradients;  ///< 4 per term
    int term = 0;
    int mode = 0;
    int rank = 0;

    /// Goes on behind `count` terms, with terms of another rank.
    void next(int count, int next_rank) {
        term += count;
        mode += count * rank;
        rank = next_rank;
    }
};

namespace detail {

template <int S>
struct PairIndex;
template <>
struct PairIndex<2> {
    using Type = Int2;
};
template <>
struct PairIndex<3> {
    using Type = Int3;
};
template <>
struct PairIndex<4> {
    using Type = Int4;
};

template <int S>
NOLI_HD inline Stencil<S> load_stencil(View<const Vec3d> x,
                                       const typename PairIndex<S>::Type& v) {
    Stencil<S> out;
    for (int i = 0; i < S; ++i)
        out.x[i] = x[v[i]];
    return out;
}

NOLI_HD inline MollifiedCase mollified_case(const MollifiedPair& pair) {
    return {pair.kind, {pair.local[0], pair.local[1], pair.local[2], pair.local[3]}};
}

/// Writes the gradient and at most `rank` modes of one term; missing modes are zero.
template <int S, int R>
NOLI_HD inline void store_term(const TermRange& out,
                               int i,
                               const int (&v)[S],
                               const StencilGradient<S>& gradient,
                               const StencilModes<S, R>& modes) {
    const int term = out.term + i;
    const int mode = out.mode + i * out.rank;
    Int4 vertices{{-1, -1, -1, -1}};
    for (int s = 0; s < 4; ++s)
        out.gradients[4 * term + s] = {0.0, 0.0, 0.0};
    for (int s = 0; s < S; ++s) {
        vertices[s] = v[s];
        out.gradients[4 * term + s] = gradient.g[s];
    }
    out.vertices[term] = vertices;
    out.first_mode[term] = mode;
    for (int k = 0; k < out.rank; ++k) {
        Mode& to = out.modes[mode + k];
        for (int s = 0; s < 4; ++s)
            to.q[s] = {0.0, 0.0, 0.0};
        if (k >= modes.rank) continue;
        for (int s = 0; s < S; ++s)
            to.q[s] = modes.q[k][s];
    }
}

/// Writes a term that is NaN.
template <int S>
NOLI_HD inline void store_undecided(const TermRange& out, int i, const int (&v)[S]) {
    StencilGradient<S> gradient;
    for (int s = 0; s < S; ++s)
        gradient.g[s] = {NAN, NAN, NAN};
    store_term(out, i, v, gradient, StencilModes<S, 1>{});
}

/// kappa b of one unmollified pair.
template <int S>
struct PairEnergy {
    PairKind kind;
    typename PairIndex<S>::Type pair;
    View<const Vec3d> x;
    BarrierParams barrier;

    template <class Stage>
    NOLI_HD double operator()(Stage& stage) const {
        const double energy = pair_energy(kind, load_stencil<S>(x, pair), barrier, stage);
        return stage.enough() ? energy : NAN;
    }
};

/// kappa m b of one mollified pair.
struct MollifiedEnergy {
    MollifiedPair pair;
    View<const Vec3d> x;
    BarrierParams barrier;

    template <class Stage>
    NOLI_HD double operator()(Stage& stage) const {
        const Stencil<4> at = load_stencil<4>(x, pair.v);
        const double energy =
            mollified_energy(mollified_case(pair), at, pair.eps_cross, barrier, stage);
        return stage.enough() ? energy : NAN;
    }
};

/// The modes of one pair by a model that is a constant of the loop: each loop leaves out
/// what only another one needs, which on a GPU is a matter of registers.
template <ContactHessian Model>
struct PairModes {
    template <int S, class Stage>
    NOLI_HD static auto of(PairKind kind,
                           const Stencil<S>& at,
                           BarrierParams barrier,
                           Stage& stage) {
        return pair_hessian(Model, kind, at, barrier, stage);
    }
};
template <>
struct PairModes<ContactHessian::Numeric> {
    template <int S, class Stage>
    NOLI_HD static auto of(PairKind kind,
                           const Stencil<S>& at,
                           BarrierParams barrier,
                           Stage& /*not hot*/) {
        return numeric_pair_hessian(kind, at, barrier);
    }
};

/// Gradient and modes of unmollified pair i.
template <ContactHessian Model, int S>
struct PairTerm {
    PairKind kind;
    View<const typename PairIndex<S>::Type> pairs;
    View<const Vec3d> x;
    BarrierParams barrier;
    TermRange out;
    int i;

    template <class Stage>
    NOLI_HD void operator()(Stage& stage) const {
        const auto& v = pairs[i].v;
        const Stencil<S> at = load_stencil<S>(x, pairs[i]);
        const StencilGradient<S> gradient = pair_gradient(kind, at, barrier, stage);
        if (!stage.enough()) return store_undecided(out, i, v);
        store_term(out, i, v, gradient, PairModes<Model>::of(kind, at, barrier, stage));
    }
};

/// Gradient and modes of mollified pair i.
template <MollifiedHessian Model>
struct MollifiedTerm {
    View<const MollifiedPair> pairs;
    View<const Vec3d> x;
    BarrierParams barrier;
    TermRange out;
    int i;

    template <class Stage>
    NOLI_HD void operator()(Stage& stage) const {
        const auto& v = pairs[i].v.v;
        const MollifiedCase sub = mollified_case(pairs[i]);
        const Stencil<4> at = load_stencil<4>(x, pairs[i].v);
        const double eps_cross = pairs[i].eps_cross;
        const StencilGradient<4> gradient =
            mollified_gradient(sub, at, eps_cross, barrier, stage);
        if (!stage.enough()) return store_undecided(out, i, v);
        store_term(out,
                   i,
                   v,
                   gradient,
                   mollified_modes<Model>(sub, at, eps_cross, barrier, stage));
    }
};

}  // namespace detail

}  // namespace noli
