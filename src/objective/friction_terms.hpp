// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Lagged friction: bases and normal forces frozen from one state, energy and low-rank
/// terms at another. All pair types share one stencil of four points; points that a pair
/// does not have carry zero weight. Formulas: energy/friction.hpp.

#include "energy/friction_hessian.hpp"
#include "objective/device_model.hpp"
#include "objective/pair_terms.hpp"

namespace noli {

/// One contact with its friction data, frozen at the last lag update; slip and dual are
/// those of the last iterate.
struct FrictionTerm {
    Int4 v;                  ///< -1 = unused
    FrictionBasis<4> basis;  ///< of unused points, weight 0
    double mu;
    Vec2d slip{0.0, 0.0};  ///< tangential displacement since the step's start, m
    Vec2d dual{0.0, 0.0};  ///< direction and size of its force, see friction_hessian.hpp
};

namespace detail {

template <int S>
NOLI_HD inline FrictionTerm widen(const int (&v)[S],
                                  const FrictionBasis<S>& from,
                                  double mu) {
    FrictionTerm to{
        {{-1, -1, -1, -1}}, {from.t0, from.t1, {0, 0, 0, 0}, from.normal_force}, mu};
    for (int s = 0; s < S; ++s) {
        to.v[s] = v[s];
        to.basis.w[s] = from.w[s];
    }
    return to;
}

/// Displacements since the step's start on the four points of a term.
NOLI_HD inline Stencil<4> moved(const FrictionTerm& term,
                                View<const Vec3d> x,
                                View<const Vec3d> x_start) {
    Stencil<4> out;
    for (int s = 0; s < 4; ++s) {
        const int v = term.v[s];
        out.x[s] = v < 0 ? Vec3d{0.0, 0.0, 0.0} : x[v] - x_start[v];
    }
    return out;
}

/// friction_unrest of a term with mu lambda_N of at least `weak`; 0 of weaker ones.
NOLI_HD inline double unrest_of(const FrictionTerm& term,
                                View<const Vec3d> x,
                                View<const Vec3d> x_start,
                                View<const Vec3d> p,
                                double eps,
                                double weak) {
    if (!(term.mu * term.basis.normal_force > weak)) return 0.0;
    Stencil<4> direction;
    for (int s = 0; s < 4; ++s)
        direction.x[s] = term.v[s] < 0 ? Vec3d{0.0, 0.0, 0.0} : p[term.v[s]];
    return friction_unrest(term.basis, moved(term, x, x_start), direction, eps);
}

/// Looks up friction coefficients by the bodies of two vertices, or of a vertex and a
/// wall.
struct FrictionTable {
    View<const int> body;
    View<const double> pair;
    View<const double> wall;
    int num_bodies;

    [[nodiscard]] NOLI_HD double between(int a, int b) const {
        return pair[body[a] * num_bodies + body[b]];
    }
    [[nodiscard]] NOLI_HD double on_wall(int w, int v) const {
        return wall[w * num_bodies + body[v]];
    }
};

template <int S, class Exec>
void lag_pairs(Exec& exec,
               PairKind kind,
               View<const typename PairIndex<S>::Type> pairs,
               View<const Vec3d> x,
               BarrierParams params,
               FrictionTable table,
               View<FrictionTerm> out,
               int first) {
    exec.for_each(
        "objective/lag_pairs",
        pairs.size,
        [=] NOLI_HD(int i) {
            const auto& v = pairs[i].v;
            const FrictionBasis<S> basis =
                friction_basis(kind, load_stencil<S>(x, pairs[i]), params);
            out[first + i] = widen(v, basis, table.between(v[0], v[S - 1]));
        },
        kPairGrain);
}

template <class Exec>
void lag_mollified(Exec& exec,
                   View<const MollifiedPair> pairs,
                   View<const Vec3d> x,
                   BarrierParams params,
                   FrictionTable table,
                   View<FrictionTerm> out,
                   int first) {
    exec.for_each(
        "objective/lag_mollified",
        pairs.size,
        [=] NOLI_HD(int i) {
            const Int4 v = pairs[i].v;
            const FrictionBasis<4> basis =
                mollified_friction_basis(mollified_case(pairs[i]),
                                         load_stencil<4>(x, v),
                                         pairs[i].eps_cross,
                                         params);
            out[first + i] = widen(v.v, basis, table.between(v[0], v[2]));
        },
        kPairGrain);
}

template <class Exec>
void lag_walls(Exec& exec,
               View<const Int2> pairs,
               View<const Wall> walls,
               View<const Vec3d> x,
               BarrierParams params,
               FrictionTable table,
               View<FrictionTerm> out,
               int first) {
    exec.for_each("objective/lag_walls", pairs.size, [=] NOLI_HD(int i) {
        const int v[1] = {pairs[i][0]};
        const FrictionBasis<1> basis =
            wall_friction_basis(x[v[0]], walls[pairs[i][1]], params);
        out[first + i] = widen(v, basis, table.on_wall(pairs[i][1], v[0]));
    });
}

}  // namespace detail

/// Freezes the bases and normal forces of all active pairs at x.
template <class Exec>
void lag_friction(Exec& exec,
                  const DeviceModel<Exec>& model,
                  const PairSet<Exec>& pairs,
                  View<const Wall> walls,
                  View<const Vec3d> x,
                  BarrierParams params,
                  typename Exec::template Buffer<FrictionTerm>& out) {
    const detail::FrictionTable table{model.body.view(),
                                      model.pair_friction.view(),
                                      model.wall_friction.view(),
                                      model.num_bodies};
    out.resize(pairs.size());
    const View<FrictionTerm> to = out.view();
    int first = 0;
    detail::lag_pairs<2>(
        exec, PairKind::PointPoint, pairs.pp.view(), x, params, table, to, first);
    first += pairs.pp.size();
    detail::lag_pairs<3>(
        exec, PairKind::PointEdge, pairs.pe.view(), x, params, table, to, first);
    first += pairs.pe.size();
    detail::lag_pairs<4>(
        exec, PairKind::PointTriangle, pairs.pt.view(), x, params, table, to, first);
    first += pairs.pt.size();
    detail::lag_pairs<4>(
        exec, PairKind::EdgeEdge, pairs.ee.view(), x, params, table, to, first);
    first += pairs.ee.size();
    detail::lag_mollified(exec, pairs.mollified.view(), x, params, table, to, first);
    first += pairs.mollified.size();
    detail::lag_walls(exec, pairs.walls.view(), walls, x, params, table, to, first);
}

/// Sum of mu lambda_N f0, J. `eps` = epsv dt, m.
template <class Exec>
Later friction_energy_sum(Exec& exec,
                          View<const FrictionTerm> terms,
                          View<const Vec3d> x,
                          View<const Vec3d> x_start,
                          double eps) {
    return exec.sum_later(
        "objective/friction_energy",
        terms.size,
        [=] NOLI_HD(int i) {
            const FrictionTerm& term = terms[i];
            return friction_energy(
                term.basis, detail::moved(term, x, x_start), term.mu, eps);
        },
        detail::kPairGrain);
}

/// Largest friction_unrest of the direction p among the terms with mu lambda_N of at
/// least `weak`; 0 without such, -infinity without terms.
template <class Exec>
Later largest_friction_unrest(Exec& exec,
                              View<const FrictionTerm> terms,
                              View<const Vec3d> x,
                              View<const Vec3d> x_start,
                              View<const Vec3d> p,
                              double eps,
                              double weak) {
    return exec.max_later("objective/friction_unrest", terms.size, [=] NOLI_HD(int i) {
        return detail::unrest_of(terms[i], x, x_start, p, eps, weak);
    });
}

/// The first of these terms whose friction_unrest is `most`; -1 if there is none.
template <class Exec>
int first_with_unrest(Exec& exec,
                      View<const FrictionTerm> terms,
                      View<const Vec3d> x,
                      View<const Vec3d> x_start,
                      View<const Vec3d> p,
                      double eps,
                      double weak,
                      double most) {
    const double first =
        exec.min("objective/first_with_unrest", terms.size, [=] NOLI_HD(int i) {
            return detail::unrest_of(terms[i], x, x_start, p, eps, weak) >= most
                     ? double(i)
                     : INFINITY;
        });
    return first < INFINITY ? static_cast<int>(first) : -1;
}

/// Slips at x and the force directions that belong to them, after a lag.
template <class Exec>
void settle_duals(Exec& exec,
                  View<FrictionTerm> terms,
                  View<const Vec3d> x,
                  View<const Vec3d> x_start,
                  double eps) {
    exec.for_each("objective/settle_duals", terms.size, [=] NOLI_HD(int i) {
        FrictionTerm& term = terms[i];
        term.slip =
            detail::tangential_displacement(term.basis, detail::moved(term, x, x_start));
        term.dual = settled_dual(term.slip, eps);
    });
}

/// The same after a Newton step to x: next_dual.
template <class Exec>
void advance_duals(Exec& exec,
                   View<FrictionTerm> terms,
                   View<const Vec3d> x,
                   View<const Vec3d> x_start,
                   double eps) {
    exec.for_each("objective/advance_duals", terms.size, [=] NOLI_HD(int i) {
        FrictionTerm& term = terms[i];
        const Vec2d slip =
            detail::tangential_displacement(term.basis, detail::moved(term, x, x_start));
        term.dual = next_dual(term.dual, term.slip, slip, eps);
        term.slip = slip;
    });
}

/// Gradients and the two modes of every friction term.
template <class Exec>
void fill_friction_terms(Exec& exec,
                         View<const FrictionTerm> terms,
                         View<const Vec3d> x,
                         View<const Vec3d> x_start,
                         double eps,
                         TermRange out) {
    exec.for_each(
        "objective/friction_terms",
        terms.size,
        [=] NOLI_HD(int i) {
            const FrictionTerm& term = terms[i];
            const Stencil<4> u = detail::moved(term, x, x_start);
            detail::store_term(out,
                               i,
                               term.v.v,
                               friction_gradient(term.basis, u, term.mu, eps),
                               friction_hessian(term.basis, u, term.dual, term.mu, eps));
        },
        detail::kPairGrain);
}

}  // namespace noli
