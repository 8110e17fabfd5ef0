// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Loops over contact pairs: barrier energy, gradients and modes of each pair type,
/// written as low-rank terms of the operator. One loop text for all types; what is done
/// with a pair is in pair_bodies.hpp. `doubles` is that of the PairSet.

#include "objective/pair_bodies.hpp"

namespace noli {

namespace detail {

/// A pair takes about a microsecond, to start a task on a distant core some ten.
inline constexpr int kPairGrain = 64;

template <Doubles How, int S, class Exec>
Later pair_energy_sum(Exec& exec,
                      PairKind kind,
                      View<const typename PairIndex<S>::Type> pairs,
                      View<const Vec3d> x,
                      BarrierParams params) {
    return exec.sum_later(
        "objective/pair_energy",
        pairs.size,
        [=] NOLI_HD(int i) {
            return evaluate<How>(PairEnergy<S>{kind, pairs[i], x, params});
        },
        kPairGrain);
}

template <Doubles How, class Exec>
Later mollified_energy_sum(Exec& exec,
                           View<const MollifiedPair> pairs,
                           View<const Vec3d> x,
                           BarrierParams params) {
    return exec.sum_later(
        "objective/mollified_energy",
        pairs.size,
        [=] NOLI_HD(int i) {
            return evaluate<How>(MollifiedEnergy{pairs[i], x, params});
        },
        kPairGrain);
}

template <ContactHessian Model, Doubles How, int S, class Exec>
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
            evaluate<How>(PairTerm<Model, S>{kind, pairs, x, barrier, out, i});
        },
        kPairGrain);
}

template <MollifiedHessian Model, Doubles How, class Exec>
void fill_mollified_terms(Exec& exec,
                          View<const MollifiedPair> pairs,
                          View<const Vec3d> x,
                          BarrierParams barrier,
                          TermRange out) {
    exec.for_each(
        "objective/mollified_terms",
        pairs.size,
        [=] NOLI_HD(int i) {
            evaluate<How>(MollifiedTerm<Model>{pairs, x, barrier, out, i});
        },
        kPairGrain);
}

}  // namespace detail

/// Sum of kappa b over one type of unmollified pairs, J.
template <int S, class Exec>
Later pair_energy_sum(Exec& exec,
                      PairKind kind,
                      View<const typename detail::PairIndex<S>::Type> pairs,
                      View<const Vec3d> x,
                      BarrierParams params,
                      Doubles doubles) {
    return with_constant<Exec>(doubles, [&](auto how) {
        return detail::pair_energy_sum<decltype(how)::value, S>(
            exec, kind, pairs, x, params);
    });
}

/// Sum of kappa m b over the mollified pairs, J.
template <class Exec>
Later mollified_energy_sum(Exec& exec,
                           View<const MollifiedPair> pairs,
                           View<const Vec3d> x,
                           BarrierParams params,
                           Doubles doubles) {
    return with_constant<Exec>(doubles, [&](auto how) {
        return detail::mollified_energy_sum<decltype(how)::value>(exec, pairs, x, params);
    });
}

/// Gradients and modes of one type of unmollified pairs.
template <int S, class Exec>
void fill_pair_terms(Exec& exec,
                     PairKind kind,
                     View<const typename detail::PairIndex<S>::Type> pairs,
                     View<const Vec3d> x,
                     ContactLaw law,
                     TermRange out,
                     Doubles doubles) {
    using Kind = ContactHessian;
    const BarrierParams barrier = law.barrier;
    with_constant<Exec>(doubles, [&](auto how) {
        constexpr Doubles kHow = decltype(how)::value;
        switch (law.hessian) {
            case Kind::GaussNewton:
                return detail::fill_pair_terms<Kind::GaussNewton, kHow, S>(
                    exec, kind, pairs, x, barrier, out);
            case Kind::GaussNewtonPlus:
                return detail::fill_pair_terms<Kind::GaussNewtonPlus, kHow, S>(
                    exec, kind, pairs, x, barrier, out);
            case Kind::Exact:
                return detail::fill_pair_terms<Kind::Exact, kHow, S>(
                    exec, kind, pairs, x, barrier, out);
            case Kind::Numeric:  // for comparison: not worth a second kernel
                return detail::fill_pair_terms<Kind::Numeric, Doubles::First, S>(
                    exec, kind, pairs, x, barrier, out);
        }
    });
}

/// Gradients and modes of the mollified pairs.
template <class Exec>
void fill_mollified_terms(Exec& exec,
                          View<const MollifiedPair> pairs,
                          View<const Vec3d> x,
                          ContactLaw law,
                          TermRange out,
                          Doubles doubles) {
    using Kind = MollifiedHessian;
    with_constant<Exec>(doubles, [&](auto how) {
        constexpr Doubles kHow = decltype(how)::value;
        switch (law.mollified) {
            case Kind::TwoMode:
                return detail::fill_mollified_terms<Kind::TwoMode, kHow>(
                    exec, pairs, x, law.barrier, out);
            case Kind::FourMode:
                return detail::fill_mollified_terms<Kind::FourMode, kHow>(
                    exec, pairs, x, law.barrier, out);
            case Kind::Exact:
                return detail::fill_mollified_terms<Kind::Exact, kHow>(
                    exec, pairs, x, law.barrier, out);
        }
    });
}

template <class Exec>
Later wall_energy_sum(Exec& exec,
                      View<const Int2> pairs,
                      View<const Wall> walls,
                      View<const Vec3d> x,
                      BarrierParams params) {
    return exec.sum_later("objective/wall_energy", pairs.size, [=] NOLI_HD(int i) {
        return wall_energy(x[pairs[i][0]], walls[pairs[i][1]], params);
    });
}

template <class Exec>
void fill_wall_terms(Exec& exec,
                     View<const Int2> pairs,
                     View<const Wall> walls,
                     View<const Vec3d> x,
                     ContactLaw law,
                     TermRange out) {
    exec.for_each("objective/wall_terms", pairs.size, [=] NOLI_HD(int i) {
        const Wall wall = walls[pairs[i][1]];
        const Vec3d at = x[pairs[i][0]];
        const int v[1] = {pairs[i][0]};
        detail::store_term(out,
                           i,
                           v,
                           wall_gradient(at, wall, law.barrier),
                           wall_hessian(at, wall, law.barrier));
    });
}

}  // namespace noli
