// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How much friction each body can feel: sums of mu lambda_N over the frozen terms, and
/// how far two such sums differ. The lag of friction is repeated while they do.

#include "objective/friction_terms.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace noli {

namespace detail {

/// The two bodies of a term and its mu lambda_N. Of half-spaces, body_b is -1.
struct TermForce {
    int body_a, body_b;
    double force;
};

template <class Exec>
void term_forces(Exec& exec,
                 View<const FrictionTerm> terms,
                 View<const int> body,
                 View<TermForce> out) {
    exec.for_each("objective/term_forces", terms.size, [=] NOLI_HD(int i) {
        const FrictionTerm& term = terms[i];
        int last = 0;
        for (int s = 1; s < 4; ++s)
            if (term.v[s] >= 0) last = s;
        const int other = last == 0 ? -1 : body[term.v[last]];
        out[i] = {body[term.v[0]], other, term.mu * term.basis.normal_force};
    });
}

}  // namespace detail

/// Per body: sum of mu lambda_N over its friction terms (a pair within a body counts
/// twice), in the scale of the incremental potential: N h^2. Sums on the host, in the
/// order of the terms.
template <class Exec>
void sum_friction_per_body(Exec& exec,
                           View<const FrictionTerm> terms,
                           View<const int> body,
                           typename Exec::template Buffer<detail::TermForce>& work,
                           std::vector<double>& out) {
    work.resize(terms.size);
    detail::term_forces(exec, terms, body, work.view());
    std::vector<detail::TermForce> host;
    exec.download(View<const detail::TermForce>(work.view()), host);
    std::fill(out.begin(), out.end(), 0.0);
    for (const detail::TermForce& term : host) {
        out[static_cast<std::size_t>(term.body_a)] += term.force;
        if (term.body_b >= 0) out[static_cast<std::size_t>(term.body_b)] += term.force;
    }
}

/// Bodies with less friction than this share of the largest have no say in a lag.
inline constexpr double kLeastFriction = 1e-3;

/// Largest relative change of a body's friction.
inline double friction_change(const std::vector<double>& before,
                              const std::vector<double>& after) {
    double most = 0.0;
    for (std::size_t b = 0; b < before.size(); ++b)
        most = std::max({most, before[b], after[b]});
    double change = 0.0;
    for (std::size_t b = 0; b < before.size(); ++b) {
        const double larger = std::max(before[b], after[b]);
        if (larger > kLeastFriction * most)
            change = std::max(change, std::fabs(after[b] - before[b]) / larger);
    }
    return change;
}

}  // namespace noli
