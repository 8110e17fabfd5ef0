// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Which bodies are in contact in a step: those with an active pair at its start or at
/// its end. The integrator is chosen by it (integrator.hpp).

#include "contact/min_gap.hpp"
#include "model/model.hpp"
#include "objective/friction_terms.hpp"

#include <cstdint>
#include <vector>

namespace noli {

namespace detail {

/// mark = 1, where others may write the same at the same time.
NOLI_HD inline void set_mark(std::uint8_t& mark) {
#if defined(__CUDA_ARCH__)
    mark = 1;
#else
    __atomic_store_n(&mark, std::uint8_t{1}, __ATOMIC_RELAXED);
#endif
}

template <class Exec>
void clear_marks(Exec& exec, View<std::uint8_t> marks) {
    exec.for_each("step/clear_marks", marks.size, [=] NOLI_HD(int b) { marks[b] = 0; });
}

/// marks[b] = 1 for the bodies of all pairs.
template <class Exec>
void mark_bodies(Exec& exec,
                 PairSetReader pairs,
                 View<const int> body,
                 View<std::uint8_t> marks) {
    exec.for_each("step/mark_bodies", pairs.size(), [=] NOLI_HD(int i) {
        const MinGap pair = pairs.name(i);
        set_mark(marks[body[pair.vertices[0]]]);
        if (pair.kind == MinGap::Kind::Wall) return;
        for (int k = 1; k < 4; ++k)
            if (pair.vertices[k] >= 0) set_mark(marks[body[pair.vertices[k]]]);
    });
}

/// The same of all terms of frozen friction.
template <class Exec>
void mark_friction(Exec& exec,
                   View<const FrictionTerm> terms,
                   View<const int> body,
                   View<std::uint8_t> marks) {
    exec.for_each("step/mark_friction", terms.size, [=] NOLI_HD(int i) {
        for (int s = 0; s < 4; ++s)
            if (terms[i].v[s] >= 0) set_mark(marks[body[terms[i].v[s]]]);
    });
}

/// touching |= fresh; returns how many elastic bodies were not touching before.
template <class Exec>
double merge_marks(Exec& exec,
                   View<const std::uint8_t> elastic,
                   View<const std::uint8_t> fresh,
                   View<std::uint8_t> touching) {
    return exec.sum("step/merge_marks", touching.size, [=] NOLI_HD(int b) {
        const bool is_new = fresh[b] && !touching[b];
        if (is_new) touching[b] = 1;
        return is_new && elastic[b] ? 1.0 : 0.0;
    });
}

}  // namespace detail

template <class Exec>
class Touching {
  public:
    Touching(Exec& exec, const Model& model) {
        std::vector<std::uint8_t> elastic(static_cast<std::size_t>(model.num_bodies()),
                                          0);
        for (std::size_t v = 0; v < model.body.size(); ++v)
            if (!model.obstacle[v]) elastic[static_cast<std::size_t>(model.body[v])] = 1;
        exec.upload(elastic, elastic_);
        touching_.resize(model.num_bodies());
        fresh_.resize(model.num_bodies());
        detail::clear_marks(exec, touching_.view());
    }

    void begin_step(Exec& exec) { detail::clear_marks(exec, touching_.view()); }

    /// Adds the bodies of these pairs; true if an elastic one is new.
    bool add(Exec& exec, const detail::PairSetReader& pairs, View<const int> body) {
        if (pairs.size() == 0) return false;
        detail::clear_marks(exec, fresh_.view());
        detail::mark_bodies(exec, pairs, body, fresh_.view());
        return detail::merge_marks(exec,
                                   View<const std::uint8_t>(elastic_.view()),
                                   View<const std::uint8_t>(fresh_.view()),
                                   touching_.view())
             > 0.0;
    }

    [[nodiscard]] View<const std::uint8_t> bodies() const { return touching_.view(); }

  private:
    typename Exec::template Buffer<std::uint8_t> elastic_, touching_, fresh_;
};

}  // namespace noli
