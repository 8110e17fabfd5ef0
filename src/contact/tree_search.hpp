// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Search of one tree with the primitives of another, or with its own, and collection of
/// what it finds.
///
/// The four primitives of a leaf search together as a group. In a search of a tree with
/// itself a group visits only the leaves from its own on, so each pair is met once. Every
/// group writes into a few slots of its own and counts; after a scan the slots are
/// compacted, and only groups that overflowed search again. Pairs are sorted by their ids
/// at the end: the result does not depend on the order of the tree.

#include "contact/bvh.hpp"
#include "exec/later.hpp"

#include <cstdint>

namespace noli::detail {

inline constexpr int kGroupGrain = 8;  ///< groups per task

/// Slots per group: groups that find more search a second time. Adapted to what the last
/// search found; the result does not depend on it.
inline constexpr int kFewestSlots = 16;
inline constexpr int kMostSlots = 256;

/// Takes pairs as they are found: counts all, stores the first `capacity`.
struct PairSlots {
    Int2* out;
    int capacity;
    int count;

    NOLI_HD void add(int a, int b) {
        if (count < capacity) out[count] = {a, b};
        ++count;
    }
};

/// Bit 4 i + j is set if box i of block a overlaps box j of block b and, where
/// kSkipShared, the two primitives share no vertex.
template <bool kOnDevice, bool kSkipShared, class Box, class IdsA, class IdsB>
NOLI_HD inline unsigned close_bits(const BoxBlock<Box>& a,
                                   const IdBlock<IdsA>& a_ids,
                                   const BoxBlock<Box>& b,
                                   const IdBlock<IdsB>& b_ids) {
    unsigned bits = 0;
    for (int i = 0; i < kBlockSize; ++i) {
        unsigned shared = 0;
        for (int k = 0; kSkipShared && k < kNumCorners<IdsA>; ++k)
            shared |= same_vertex_bits<kOnDevice>(a_ids.v[k][i], b_ids);
        bits |= (overlap_bits<kOnDevice>(load(a, i), b) & ~shared) << (kBlockSize * i);
    }
    return bits;
}

/// The primitives of one group against those of one leaf: found.add for every pair that
/// `test` accepts.
///
/// A test has kSelf (one tree searched with itself), kSkipShared (primitives that share a
/// vertex form no pair) and bool operator()(int query, int target), in a search with
/// itself query < target.
template <bool kOnDevice, class Box, class QueryIds, class TargetIds, class Test>
struct GroupVisit {
    const BvhView<Box, QueryIds>& queries;
    const BvhView<Box, TargetIds>& targets;
    const Test& test;
    int group;
    PairSlots& found;

    NOLI_HD void operator()(int leaf) {
        constexpr unsigned kAbove = 0x08CEU;  // bits 4 i + j with i < j
        unsigned bits =
            close_bits<kOnDevice, Test::kSkipShared, Box>(queries.block(0, group),
                                                          queries.ids[group],
                                                          targets.block(0, leaf),
                                                          targets.ids[leaf]);
        if (Test::kSelf && leaf == group) bits &= kAbove;
        for (; bits != 0; bits &= bits - 1) {
            const int bit = lowest_bit(bits);
            const int i = queries.order[group * kBlockSize + bit / kBlockSize];
            const int j = targets.order[leaf * kBlockSize + bit % kBlockSize];
            const bool swap = Test::kSelf && j < i;
            const int query = swap ? j : i;
            const int target = swap ? i : j;
            if (test(query, target)) found.add(query, target);
        }
    }
};

/// Box of a whole leaf. With a single leaf nobody asks for the tree above it.
template <class Box, class Ids>
NOLI_HD inline Box leaf_box(const BvhView<Box, Ids>& tree, int leaf) {
    if (tree.levels.count > 1)
        return load(tree.block(1, leaf / kBlockSize), leaf % kBlockSize);
    Box box;
    make_empty(box);
    for (int j = 0; j < kBlockSize; ++j)
        merge_into(box, load(tree.block(0, leaf), j));
    return box;
}

/// Search of the tree `targets` with one group of `queries`.
template <bool kOnDevice, class Box, class QueryIds, class TargetIds, class Test>
struct GroupSearch {
    BvhView<Box, QueryIds> queries;
    BvhView<Box, TargetIds> targets;
    Test test;

    NOLI_HD void operator()(int group, PairSlots& found) const {
        GroupVisit<kOnDevice, Box, QueryIds, TargetIds, Test> visit{
            queries, targets, test, group, found};
        visit_leaves<kOnDevice>(
            targets, leaf_box(queries, group), Test::kSelf ? group : 0, visit);
    }
};

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
        kGroupGrain);
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
        kGroupGrain);
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
        const int num_groups = search.queries.levels.num_leaves();
        const int wanted = num_groups > 0 ? 3 * (expected / num_groups) : 0;
        per_group_ = wanted < kFewestSlots ? kFewestSlots
                                           : (wanted > kMostSlots ? kMostSlots : wanted);
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
                       search.queries.levels.num_leaves(),
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

template <class Exec, class Box, class QueryIds, class TargetIds, class Test>
GroupSearch<Exec::kIsDevice, Box, QueryIds, TargetIds, Test> tree_search(
    const Exec& /*exec*/,
    const BvhView<Box, QueryIds>& queries,
    const BvhView<Box, TargetIds>& targets,
    const Test& test) {
    return {queries, targets, test};
}

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
