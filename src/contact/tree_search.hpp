// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Search of one tree with the primitives of another, or with its own: collection of what
/// the groups (group_search.hpp) find.
///
/// Every group writes into a few slots of its own and counts; after a scan the slots are
/// compacted, and only groups that overflowed search again. Pairs are sorted by their ids
/// at the end: the result does not depend on the order of the tree.

#include "contact/group_search.hpp"
#include "exec/later.hpp"

#include <algorithm>
#include <cstdint>

namespace noli::detail {

/// Leaves in a group of a search.
template <class Search>
inline constexpr int kLeavesOfGroup = Search::kLevel == 0 ? 1 : kBlockSize;

/// Groups of a search that are worth a task: 64 leaves.
template <class Search>
inline constexpr int kGroupGrain = 64 / kLeavesOfGroup<Search>;

/// Slots per leaf: groups that find more search a second time. Adapted to what the last
/// search found; the result does not depend on it.
inline constexpr int kFewestSlots = 16;
inline constexpr int kMostSlots = 256;

/// Slots of the groups, `per_group` each.
struct SlotView {
    View<Int2> all;
    int per_group;

    [[nodiscard]] NOLI_HD Int2* of_group(int group) const {
        return all.data + static_cast<std::int64_t>(group) * per_group;
    }
};

/// counts[g] = pairs of group g, as many as fit in its slots.
template <class Exec, class Search>
void search_groups(
    Exec& exec, Search search, int num_groups, SlotView slots, View<int> counts) {
    exec.for_each(
        "contact/search_groups",
        num_groups,
        [=] NOLI_HD(int g) {
            PairSlots found{slots.of_group(g), slots.per_group, 0};
            search(g, found);
            counts[g] = found.count;
        },
        kGroupGrain<Search>);
}

/// out[offsets[g] ...] = pairs of group g; searches again where the slots did not
/// suffice.
template <class Exec, class Search>
void compact_groups(Exec& exec,
                    Search search,
                    int num_groups,
                    SlotView slots,
                    View<const int> offsets,
                    View<Int2> out) {
    exec.for_each(
        "contact/compact_groups",
        num_groups,
        [=] NOLI_HD(int g) {
            const int count = offsets[g + 1] - offsets[g];
            PairSlots found{out.data + offsets[g], count, 0};
            if (count > slots.per_group) {
                search(g, found);
                return;
            }
            const Int2* from = slots.of_group(g);
            for (int k = 0; k < count; ++k)
                found.add(from[k][0], from[k][1]);
        },
        kGroupGrain<Search>);
}

template <class Exec>
void pair_keys(Exec& exec,
               int bits,
               View<const Int2> pairs,
               View<std::uint64_t> keys,
               View<int> places) {
    exec.for_each("contact/pair_keys", pairs.size, [=] NOLI_HD(int i) {
        keys[i] = (static_cast<std::uint64_t>(pairs[i][0]) << bits)
                | static_cast<std::uint64_t>(pairs[i][1]);
        places[i] = i;
    });
}

template <class Exec>
void pairs_of_keys(Exec& exec,
                   int bits,
                   View<const std::uint64_t> keys,
                   View<Int2> pairs) {
    exec.for_each("contact/pairs_of_keys", pairs.size, [=] NOLI_HD(int i) {
        const std::uint64_t second = keys[i] & ((std::uint64_t{1} << bits) - 1);
        pairs[i] = {static_cast<int>(keys[i] >> bits), static_cast<int>(second)};
    });
}

/// The search of a tree, and its buffers, kept between searches: all pairs of primitives
/// (query, target) that `test` accepts; their boxes overlap.
template <class Exec>
class TreePairs {
  public:
    /// Searches once. `expected`: about how many pairs there are.
    template <class Search>
    void start(Exec& exec, const Search& search, int expected) {
        const int num_groups = search.num_groups();
        const int wanted = num_groups > 0 ? 3 * (expected / num_groups) : 0;
        constexpr int kLeaves = kLeavesOfGroup<Search>;
        per_group_ = std::clamp(wanted, kLeaves * kFewestSlots, kLeaves * kMostSlots);
        slots_.resize(num_groups * per_group_);
        counts_.resize(num_groups);
        offsets_.resize(num_groups + 1);
        search_groups(exec, search, num_groups, slots(), counts_.view());
        total_ = exec.scan_later(
            "contact/scan_groups", View<const int>(counts_.view()), offsets_.view());
    }

    /// out = the pairs of the search that was started, sorted by first, then second id.
    /// Waits.
    template <class Search>
    void finish(Exec& exec,
                const Search& search,
                typename Exec::template Buffer<Int2>& out) {
        out.resize(static_cast<int>(exec.value(total_)));
        compact_groups(exec,
                       search,
                       search.num_groups(),
                       slots(),
                       View<const int>(offsets_.view()),
                       out.view());
        sort(exec, search.targets.order.size, out.view());
    }

  private:
    SlotView slots() { return {slots_.view(), per_group_}; }

    void sort(Exec& exec, int num_second, View<Int2> pairs) {
        int bits = 1;
        while ((num_second - 1) >> bits > 0)
            ++bits;
        keys_.resize(pairs.size);
        places_.resize(pairs.size);
        pair_keys(exec, bits, View<const Int2>(pairs), keys_.view(), places_.view());
        exec.sort_by_key("contact/sort_pairs", keys_.view(), places_.view());
        pairs_of_keys(exec, bits, View<const std::uint64_t>(keys_.view()), pairs);
    }

    typename Exec::template Buffer<Int2> slots_;
    typename Exec::template Buffer<int> counts_, offsets_;
    typename Exec::template Buffer<std::uint64_t> keys_;
    typename Exec::template Buffer<int> places_;
    int per_group_ = kFewestSlots;
    Later total_;
};

/// One search, started and finished. The old size of `out` tells how many to expect.
template <class Exec, class Box, class QueryIds, class TargetIds, class Test>
void find_tree_pairs(Exec& exec,
                     const BvhView<Box, QueryIds>& queries,
                     const BvhView<Box, TargetIds>& targets,
                     const Test& test,
                     TreePairs<Exec>& work,
                     typename Exec::template Buffer<Int2>& out) {
    const auto search = tree_search(exec, queries, targets, test);
    work.start(exec, search, out.size());
    work.finish(exec, search, out);
}

}  // namespace noli::detail
