// SPDX-License-Identifier: Apache-2.0
#pragma once
/// How much friction each body can feel: sums of mu lambda_N over the frozen terms, and
/// how far two such sums differ. The lag of friction is repeated while they do.
///
/// A body's terms are brought together by sorting; a sum takes whole chunks of the sorted
/// terms at once and what is left at both ends one by one, always in the same order.

#include "exec/later.hpp"
#include "objective/friction_terms.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace noli {

namespace detail {

inline constexpr int kFrictionChunk = 64;  ///< sorted terms

/// Two entries per term, one for each of its bodies; of half-spaces, and of terms within
/// a body, the second one counts for no body or for the same again.
template <class Exec>
void friction_entries(Exec& exec,
                      View<const FrictionTerm> terms,
                      View<const int> body,
                      std::uint32_t no_body,
                      View<std::uint32_t> bodies,
                      View<int> entries) {
    exec.for_each("objective/friction_entries", terms.size, [=] NOLI_HD(int i) {
        const FrictionTerm& term = terms[i];
        int last = 0;
        for (int s = 1; s < 4; ++s)
            if (term.v[s] >= 0) last = s;
        bodies[2 * i] = static_cast<std::uint32_t>(body[term.v[0]]);
        bodies[2 * i + 1] =
            last == 0 ? no_body : static_cast<std::uint32_t>(body[term.v[last]]);
        entries[2 * i] = 2 * i;
        entries[2 * i + 1] = 2 * i + 1;
    });
}

/// mu lambda_N of the entries in their sorted order.
template <class Exec>
void friction_of_entries(Exec& exec,
                         View<const FrictionTerm> terms,
                         View<const int> entries,
                         View<double> out) {
    exec.for_each("objective/friction_of_entries", entries.size, [=] NOLI_HD(int k) {
        const FrictionTerm& term = terms[entries[k] / 2];
        out[k] = term.mu * term.basis.normal_force;
    });
}

template <class Exec>
void sum_friction_chunks(Exec& exec, View<const double> forces, View<double> out) {
    exec.for_each("objective/sum_friction_chunks", out.size, [=] NOLI_HD(int c) {
        double sum = 0.0;
        for (int k = c * kFrictionChunk; k < (c + 1) * kFrictionChunk; ++k)
            if (k < forces.size) sum += forces[k];
        out[c] = sum;
    });
}

/// Where `body` or a later one begins among sorted bodies.
NOLI_HD inline int first_of_body(View<const std::uint32_t> bodies, std::uint32_t body) {
    int low = 0;
    int high = bodies.size;
    while (low < high) {
        const int middle = low + (high - low) / 2;
        if (bodies[middle] < body)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

template <class Exec>
void sum_friction_bodies(Exec& exec,
                         View<const std::uint32_t> bodies,
                         View<const double> forces,
                         View<const double> chunks,
                         View<double> out) {
    exec.for_each("objective/sum_friction_bodies", out.size, [=] NOLI_HD(int b) {
        int k = first_of_body(bodies, static_cast<std::uint32_t>(b));
        const int end = first_of_body(bodies, static_cast<std::uint32_t>(b) + 1);
        double sum = 0.0;
        while (k < end) {
            const bool whole = k % kFrictionChunk == 0 && k + kFrictionChunk <= end;
            sum += whole ? chunks[k / kFrictionChunk] : forces[k];
            k += whole ? kFrictionChunk : 1;
        }
        out[b] = sum;
    });
}

}  // namespace detail

template <class Exec>
class FrictionOfBodies {
  public:
    /// out[b]: sum of mu lambda_N over the terms of body b (a pair within a body counts
    /// twice), in the scale of the incremental potential: N h^2.
    void sum(Exec& exec,
             View<const FrictionTerm> terms,
             View<const int> body,
             View<double> out) {
        const int n = 2 * terms.size;
        bodies_.resize(n);
        entries_.resize(n);
        forces_.resize(n);
        chunks_.resize((n + detail::kFrictionChunk - 1) / detail::kFrictionChunk);
        detail::friction_entries(exec,
                                 terms,
                                 body,
                                 static_cast<std::uint32_t>(out.size),
                                 bodies_.view(),
                                 entries_.view());
        if (n > 0)
            exec.sort_by_key("objective/sort_friction", bodies_.view(), entries_.view());
        detail::friction_of_entries(
            exec, terms, View<const int>(entries_.view()), forces_.view());
        detail::sum_friction_chunks(
            exec, View<const double>(forces_.view()), chunks_.view());
        detail::sum_friction_bodies(exec,
                                    View<const std::uint32_t>(bodies_.view()),
                                    View<const double>(forces_.view()),
                                    View<const double>(chunks_.view()),
                                    out);
    }

  private:
    template <class T>
    using Buffer = typename Exec::template Buffer<T>;

    Buffer<std::uint32_t> bodies_;
    Buffer<int> entries_;
    Buffer<double> forces_, chunks_;
};

/// Bodies with less friction than this share of the largest have no say in a lag.
inline constexpr double kLeastFriction = 1e-3;

/// Largest relative change of a body's friction.
template <class Exec>
double friction_change(Exec& exec, View<const double> before, View<const double> after) {
    const Later most =
        exec.max_later("objective/most_friction", before.size, [=] NOLI_HD(int b) {
            return before[b] > after[b] ? before[b] : after[b];
        });
    const double least = kLeastFriction * exec.value(most);
    return exec.value(
        exec.max_later("objective/friction_change", before.size, [=] NOLI_HD(int b) {
            const double larger = before[b] > after[b] ? before[b] : after[b];
            return larger > least ? std::fabs(after[b] - before[b]) / larger : 0.0;
        }));
}

}  // namespace noli
