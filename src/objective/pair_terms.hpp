// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Loops over contact pairs: barrier energy, gradients and modes of each pair type,
/// written as low-rank terms of the operator. One loop text for all types; formulas are
/// in energy/.

#include "contact/pairs.hpp"
#include "energy/contact_pair.hpp"
#include "energy/half_space.hpp"
#include "energy/mollified_pair.hpp"
#include "energy/numeric_hessian.hpp"
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

/// A pair takes about a microsecond, to start a task on a distant core some ten.
inline constexpr int kPairGrain = 64;

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

NOLI_HD inline BarrierPlane barrier_plane(const CollisionMesh::Plane& plane) {
    return {plane.normal, plane.offset};
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

}  // namespace detail

/// Sum of kappa b over one type of unmollified pairs, J.
template <int S, class Exec>
Later pair_energy_sum(Exec& exec,
                      PairKind kind,
                      View<const typename detail::PairIndex<S>::Type> pairs,
                      View<const Vec3d> x,
                      BarrierParams params) {
    return exec.sum_later(
        "objective/pair_energy",
        pairs.size,
        [=] NOLI_HD(int i) {
            return pair_energy(kind, detail::load_stencil<S>(x, pairs[i]), params);
        },
        detail::kPairGrain);
}

namespace detail {

/// The modes of one pair by a model that is a constant of the loop: each loop leaves out
/// what only another one needs, which on a GPU is a matter of registers.
template <ContactHessian Model>
struct PairModes {
    template <int S>
    NOLI_HD static auto of(PairKind kind, const Stencil<S>& at, BarrierParams barrier) {
        return pair_hessian(Model, kind, at, barrier);
    }
};
template <>
struct PairModes<ContactHessian::Numeric> {
    template <int S>
    NOLI_HD static auto of(PairKind kind, const Stencil<S>& at, BarrierParams barrier) {
        return numeric_pair_hessian(kind, at, barrier);
    }
};

template <ContactHessian Model, int S, class Exec>
void fill_pair_terms(Exec& exec,
                     PairKind kind,
                     View<const typename PairIndex<S>::Type> pairs,
                     View<const Vec3d> x,
                     BarrierParams barrier,
                     TermRange out) {
    exec.for_each(
        "objective/pair_terms",
        pairs.size,
        [=] NOLI_HD(int i) {
            const Stencil<S> at = load_stencil<S>(x, pairs[i]);
            store_term(out,
                       i,
                       pairs[i].v,
                       pair_gradient(kind, at, barrier),
                       PairModes<Model>::of(kind, at, barrier));
        },
        kPairGrain);
}

}  // namespace detail

/// Gradients and modes of one type of unmollified pairs.
template <int S, class Exec>
void fill_pair_terms(Exec& exec,
                     PairKind kind,
                     View<const typename detail::PairIndex<S>::Type> pairs,
                     View<const Vec3d> x,
                     ContactLaw law,
                     TermRange out) {
    using Kind = ContactHessian;
    const BarrierParams barrier = law.barrier;
    switch (law.hessian) {
        case Kind::GaussNewton:
            return detail::fill_pair_terms<Kind::GaussNewton, S>(
                exec, kind, pairs, x, barrier, out);
        case Kind::GaussNewtonPlus:
            return detail::fill_pair_terms<Kind::GaussNewtonPlus, S>(
                exec, kind, pairs, x, barrier, out);
        case Kind::Exact:
            return detail::fill_pair_terms<Kind::Exact, S>(
                exec, kind, pairs, x, barrier, out);
        case Kind::Numeric:
            return detail::fill_pair_terms<Kind::Numeric, S>(
                exec, kind, pairs, x, barrier, out);
    }
}

template <class Exec>
Later mollified_energy_sum(Exec& exec,
                           View<const MollifiedPair> pairs,
                           View<const Vec3d> x,
                           BarrierParams params) {
    return exec.sum_later(
        "objective/mollified_energy",
        pairs.size,
        [=] NOLI_HD(int i) {
            return mollified_energy(detail::mollified_case(pairs[i]),
                                    detail::load_stencil<4>(x, pairs[i].v),
                                    pairs[i].eps_cross,
                                    params);
        },
        detail::kPairGrain);
}

namespace detail {

template <MollifiedHessian Model, class Exec>
void fill_mollified_terms(Exec& exec,
                          View<const MollifiedPair> pairs,
                          View<const Vec3d> x,
                          BarrierParams barrier,
                          TermRange out) {
    exec.for_each(
        "objective/mollified_terms",
        pairs.size,
        [=] NOLI_HD(int i) {
            const MollifiedCase sub = mollified_case(pairs[i]);
            const Stencil<4> at = load_stencil<4>(x, pairs[i].v);
            const double eps_cross = pairs[i].eps_cross;
            store_term(out,
                       i,
                       pairs[i].v.v,
                       mollified_gradient(sub, at, eps_cross, barrier),
                       mollified_modes<Model>(sub, at, eps_cross, barrier));
        },
        kPairGrain);
}

}  // namespace detail

template <class Exec>
void fill_mollified_terms(Exec& exec,
                          View<const MollifiedPair> pairs,
                          View<const Vec3d> x,
                          ContactLaw law,
                          TermRange out) {
    using Kind = MollifiedHessian;
    switch (law.mollified) {
        case Kind::TwoMode:
            return detail::fill_mollified_terms<Kind::TwoMode>(
                exec, pairs, x, law.barrier, out);
        case Kind::FourMode:
            return detail::fill_mollified_terms<Kind::FourMode>(
                exec, pairs, x, law.barrier, out);
        case Kind::Exact:
            return detail::fill_mollified_terms<Kind::Exact>(
                exec, pairs, x, law.barrier, out);
    }
}

template <class Exec>
Later plane_energy_sum(Exec& exec,
                       View<const Int2> pairs,
                       View<const CollisionMesh::Plane> planes,
                       View<const Vec3d> x,
                       BarrierParams params) {
    return exec.sum_later("objective/plane_energy", pairs.size, [=] NOLI_HD(int i) {
        return half_space_energy(
            x[pairs[i][0]], detail::barrier_plane(planes[pairs[i][1]]), params);
    });
}

template <class Exec>
void fill_plane_terms(Exec& exec,
                      View<const Int2> pairs,
                      View<const CollisionMesh::Plane> planes,
                      View<const Vec3d> x,
                      ContactLaw law,
                      TermRange out) {
    exec.for_each("objective/plane_terms", pairs.size, [=] NOLI_HD(int i) {
        const BarrierPlane plane = detail::barrier_plane(planes[pairs[i][1]]);
        const Vec3d at = x[pairs[i][0]];
        const int v[1] = {pairs[i][0]};
        detail::store_term(out,
                           i,
                           v,
                           half_space_gradient(at, plane, law.barrier),
                           half_space_hessian(at, plane, law.barrier));
    });
}

}  // namespace noli
