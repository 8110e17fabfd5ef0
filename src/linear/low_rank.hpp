// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Contacts in the linear operator: a sum of rank-one matrices q qᵀ ("modes"), each
/// living on the at most four vertices of its term, applied without ever forming a
/// matrix.
///
/// A product takes two passes: per term, the forces of its modes on its four slots; then
/// per touched vertex, the sum over the slots it appears in, in ascending (term, slot)
/// order. No atomics, so the result has the same bits for any number of threads.

#include "core/vec.hpp"
#include "core/view.hpp"
#include "exec/later.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace noli {

inline constexpr int kSlotsPerTerm = 4;

/// One vector of 12 numbers over the vertices of its term; unused slots hold zeros.
struct Mode {
    Vec3d q[kSlotsPerTerm];
};

namespace detail {

/// Sort keys of all slots: their vertex, or num_vertices for unused ones, which so come
/// last.
template <class Exec>
void slot_keys(Exec& exec,
               View<const Int4> vertices,
               int num_vertices,
               View<std::uint32_t> keys,
               View<int> slots) {
    exec.for_each("linear/slot_keys", keys.size, [=] NOLI_HD(int s) {
        const int v = vertices[s / kSlotsPerTerm][s % kSlotsPerTerm];
        keys[s] = static_cast<std::uint32_t>(v < 0 ? num_vertices : v);
        slots[s] = s;
    });
}

/// head[s] = 1 where a used key differs from the one before it.
template <class Exec>
void mark_heads(Exec& exec,
                View<const std::uint32_t> keys,
                int num_vertices,
                View<int> head) {
    exec.for_each("linear/mark_heads", keys.size, [=] NOLI_HD(int s) {
        const bool used = keys[s] < static_cast<std::uint32_t>(num_vertices);
        head[s] = used && (s == 0 || keys[s] != keys[s - 1]) ? 1 : 0;
    });
}

/// The list of touched vertices and where each one's slots begin.
template <class Exec>
void compact_heads(Exec& exec,
                   View<const std::uint32_t> keys,
                   View<const int> head,
                   View<const int> rank,
                   View<int> touched,
                   View<int> begin) {
    exec.for_each("linear/compact_heads", keys.size, [=] NOLI_HD(int s) {
        if (head[s] == 0) return;
        touched[rank[s]] = static_cast<int>(keys[s]);
        begin[rank[s]] = s;
    });
}

template <class Exec>
Later count_used(Exec& exec, View<const std::uint32_t> keys, int num_vertices) {
    return exec.sum_later("linear/count_used", keys.size, [=] NOLI_HD(int s) {
        return keys[s] < static_cast<std::uint32_t>(num_vertices) ? 1.0 : 0.0;
    });
}

template <class Exec>
void store_end(Exec& exec, int end, View<int> begin) {
    exec.for_each(
        "linear/store_end", 1, [=] NOLI_HD(int) { begin[begin.size - 1] = end; });
}

/// forces[4 t + slot] = sum over the modes of term t of q_slot (q . x)
template <class Exec>
void mode_forces(Exec& exec,
                 const bool* skip,
                 View<const Int4> vertices,
                 View<const int> first_mode,
                 View<const Mode> modes,
                 View<const Vec3d> x,
                 View<Vec3d> forces) {
    exec.for_each("linear/mode_forces", vertices.size, [=] NOLI_HD(int t) {
        if (skip != nullptr && *skip) return;
        Vec3d at[kSlotsPerTerm];
        Vec3d force[kSlotsPerTerm];
        for (int s = 0; s < kSlotsPerTerm; ++s) {
            const int v = vertices[t][s];
            at[s] = v < 0 ? Vec3d{0, 0, 0} : x[v];
            force[s] = {0, 0, 0};
        }
        for (int m = first_mode[t]; m < first_mode[t + 1]; ++m) {
            const Mode& mode = modes[m];
            double amount = 0.0;
            for (int s = 0; s < kSlotsPerTerm; ++s)
                amount += dot(mode.q[s], at[s]);
            for (int s = 0; s < kSlotsPerTerm; ++s)
                force[s] += amount * mode.q[s];
        }
        for (int s = 0; s < kSlotsPerTerm; ++s)
            forces[kSlotsPerTerm * t + s] = force[s];
    });
}

/// y[v] += sum of the slots of each touched vertex v
template <class Exec>
void gather_slots(Exec& exec,
                  const bool* skip,
                  View<const int> touched,
                  View<const int> begin,
                  View<const int> slots,
                  View<const Vec3d> per_slot,
                  View<Vec3d> y) {
    exec.for_each("linear/gather_slots", touched.size, [=] NOLI_HD(int i) {
        if (skip != nullptr && *skip) return;
        Vec3d sum = {0, 0, 0};
        for (int e = begin[i]; e < begin[i + 1]; ++e)
            sum += per_slot[slots[e]];
        y[touched[i]] += sum;
    });
}

/// blocks[v] += sum over the slots of v and their modes of q qᵀ
template <class Exec>
void gather_mode_diagonal(Exec& exec,
                          View<const int> touched,
                          View<const int> begin,
                          View<const int> slots,
                          View<const int> first_mode,
                          View<const Mode> modes,
                          View<Mat3d> blocks) {
    exec.for_each("linear/gather_mode_diagonal", touched.size, [=] NOLI_HD(int i) {
        Mat3d sum = zero3();
        for (int e = begin[i]; e < begin[i + 1]; ++e) {
            const int term = slots[e] / kSlotsPerTerm;
            const int slot = slots[e] % kSlotsPerTerm;
            for (int m = first_mode[term]; m < first_mode[term + 1]; ++m)
                sum += outer(modes[m].q[slot], modes[m].q[slot]);
        }
        blocks[touched[i]] += sum;
    });
}

/// sum over the modes of term t of (q . x)^2, over all terms
template <class Exec>
double mode_quadratic_form(Exec& exec,
                           View<const Int4> vertices,
                           View<const int> first_mode,
                           View<const Mode> modes,
                           View<const Vec3d> x) {
    return exec.sum("linear/mode_quadratic_form", vertices.size, [=] NOLI_HD(int t) {
        double total = 0.0;
        for (int m = first_mode[t]; m < first_mode[t + 1]; ++m) {
            double amount = 0.0;
            for (int s = 0; s < kSlotsPerTerm; ++s)
                if (vertices[t][s] >= 0) amount += dot(modes[m].q[s], x[vertices[t][s]]);
            total += amount * amount;
        }
        return total;
    });
}

}  // namespace detail

/// Terms first, ..., first + count - 1 use their first `points` slots.
struct TermRun {
    int first, count, points;
};

/// Sum of rank-one matrices over terms of up to four vertices. Whoever owns the terms
/// fills the three public arrays and calls build_incidence; all else reads them.
template <class Exec>
class LowRankTerms {
  public:
    template <class T>
    using Buffer = typename Exec::template Buffer<T>;

    Buffer<Int4> vertices;   ///< per term; -1 marks an unused slot
    Buffer<int> first_mode;  ///< num_terms + 1, ascending: modes of term t are [t], ...,
                             ///< [t+1] - 1
    Buffer<Mode> modes;      ///< all modes; slots that the term does not use must be zero
    std::vector<TermRun> runs;  ///< all terms by number of points; only DenseTerms asks

    /// Sizes the three arrays; contents are undefined afterwards.
    void resize(int num_terms, int num_modes) {
        vertices.resize(num_terms);
        first_mode.resize(num_terms + 1);
        modes.resize(num_modes);
    }

    /// Finds the touched vertices and the slots of each. Call after `vertices` changed.
    void build_incidence(Exec& exec, int num_vertices) {
        const int num_slots = kSlotsPerTerm * num_terms();
        keys_.resize(num_slots);
        slots_.resize(num_slots);
        head_.resize(num_slots);
        rank_.resize(num_slots + 1);
        forces_.resize(num_slots);
        detail::slot_keys(exec, terms(), num_vertices, keys_.view(), slots_.view());
        exec.sort_by_key("linear/sort_slots", keys_.view(), slots_.view());
        detail::mark_heads(exec, keys(), num_vertices, head_.view());
        const Later touched_count =
            exec.scan_later("linear/scan_heads", head(), rank_.view());
        const Later used_count = detail::count_used(exec, keys(), num_vertices);
        const int num_touched = static_cast<int>(exec.value(touched_count));
        const int num_used = static_cast<int>(exec.value(used_count));
        touched_.resize(num_touched);
        begin_.resize(num_touched + 1);
        detail::compact_heads(
            exec, keys(), head(), rank(), touched_.view(), begin_.view());
        detail::store_end(exec, num_used, begin_.view());
    }

    /// y += sum_m q_m (q_m . x). Nothing where `skip`, in the executor's memory, is set.
    void multiply_add(Exec& exec,
                      View<const Vec3d> x,
                      View<Vec3d> y,
                      const bool* skip = nullptr) {
        if (num_terms() == 0) return;
        detail::mode_forces(
            exec, skip, terms(), mode_begin(), mode_view(), x, forces_.view());
        gather_add(exec, View<const Vec3d>(forces_.view()), y, skip);
    }

    /// y[v] += sum over the slots (term, slot) of vertex v of per_term_slot[4 term +
    /// slot]
    void gather_add(Exec& exec,
                    View<const Vec3d> per_term_slot,
                    View<Vec3d> y,
                    const bool* skip = nullptr) const {
        detail::gather_slots(
            exec, skip, touched(), touched_begin(), slots(), per_term_slot, y);
    }

    /// blocks[v] += the diagonal block of the terms at vertex v
    void add_diagonal(Exec& exec, View<Mat3d> blocks) const {
        detail::gather_mode_diagonal(
            exec, touched(), touched_begin(), slots(), mode_begin(), mode_view(), blocks);
    }

    /// sum_m (q_m . x)^2
    double quadratic_form(Exec& exec, View<const Vec3d> x) const {
        return detail::mode_quadratic_form(exec, terms(), mode_begin(), mode_view(), x);
    }

    [[nodiscard]] int num_terms() const { return vertices.size(); }
    [[nodiscard]] int num_modes() const { return modes.size(); }
    [[nodiscard]] View<const Int4> terms() const { return vertices.view(); }
    [[nodiscard]] View<const int> mode_begin() const { return first_mode.view(); }
    [[nodiscard]] View<const Mode> mode_view() const { return modes.view(); }
    /// Vertices that some term uses, ascending.
    [[nodiscard]] View<const int> touched() const { return touched_.view(); }
    /// num_touched + 1: where each touched vertex's slots begin in slots().
    [[nodiscard]] View<const int> touched_begin() const { return begin_.view(); }
    /// 4 * term + slot, grouped by touched vertex, ascending in each group.
    [[nodiscard]] View<const int> slots() const { return slots_.view(); }

  private:
    [[nodiscard]] View<const std::uint32_t> keys() const { return keys_.view(); }
    [[nodiscard]] View<const int> head() const { return head_.view(); }
    [[nodiscard]] View<const int> rank() const { return rank_.view(); }

    Buffer<std::uint32_t> keys_;
    Buffer<int> slots_, head_, rank_, touched_, begin_;
    Buffer<Vec3d> forces_;
};

}  // namespace noli
