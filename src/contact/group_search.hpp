// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Search of a tree with a few neighbouring primitives of another one, or of itself.
///
/// On a device one thread takes the four primitives of a leaf. On the host those of four
/// leaves go together: the tree is gone through once for all of them, down to blocks of
/// four leaves, and then four leaves are tested against four at once, as four primitives
/// against four after that. In a search of a tree with itself only the places from the
/// group's own on are visited, so each pair is met once.

#include "contact/bvh.hpp"
#include "contact/group_boxes.hpp"
#include "exec/avx2.hpp"

namespace noli::detail {

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

/// The primitives of one leaf against those of other leaves: found.add for every pair
/// that `test` accepts.
///
/// A test has kSelf (one tree searched with itself), kSkipShared (primitives that share a
/// vertex form no pair) and bool operator()(query, target) of their vertex ids, in a
/// search with itself in ascending order of the primitives.
template <bool kOnDevice, class Box, class QueryIds, class TargetIds, class Test>
struct LeafVisit {
    const BvhView<Box, QueryIds>& queries;
    const BvhView<Box, TargetIds>& targets;
    const Test& test;
    int own;
    GroupBoxes<kOnDevice, Box> boxes;  ///< of leaf `own` of the queries
    PairSlots& found;

    NOLI_HD void operator()(int leaf) const {
        unsigned bits = boxes.overlaps(targets.block(0, leaf));
        if (bits == 0) return;
        if (Test::kSkipShared)
            bits &= ~shared_bits<kOnDevice>(queries.ids[own], targets.ids[leaf]);
        if (Test::kSelf && leaf == own) bits &= kPairsAbove;
        for (; bits != 0; bits &= bits - 1) {
            const int bit = lowest_bit(bits);
            take(bit / kBlockSize, leaf, bit % kBlockSize);
        }
    }

  private:
    /// The primitive at place i of the own leaf and that at place j of the other.
    NOLI_HD void take(int i, int leaf, int j) const {
        const int a = queries.order[own * kBlockSize + i];
        const int b = targets.order[leaf * kBlockSize + j];
        QueryIds a_ids;
        TargetIds b_ids;
        load_ids(queries.ids[own], i, a_ids);
        load_ids(targets.ids[leaf], j, b_ids);
        if constexpr (Test::kSelf) {
            if (b < a) {
                if (test(b_ids, a_ids)) found.add(b, a);
                return;
            }
        }
        if (test(a_ids, b_ids)) found.add(a, b);
    }
};

#if !defined(__CUDACC__)
/// The leaves of one block of level 1 against those of other such blocks.
template <class Box, class QueryIds, class TargetIds, class Test>
struct FourLeavesVisit {
    const BvhView<Box, TargetIds>& targets;
    int own;
    GroupBoxes<false, Box> boxes;  ///< of the four leaves
    LeafVisit<false, Box, QueryIds, TargetIds, Test> leaves[kBlockSize];

    void operator()(int block) const {
        unsigned bits = boxes.overlaps(targets.block(1, block));
        if (Test::kSelf && block == own) bits &= kPairsFromSame;
        for (; bits != 0; bits &= bits - 1) {
            const int bit = lowest_bit(bits);
            leaves[bit / kBlockSize](block * kBlockSize + bit % kBlockSize);
        }
    }
};
#endif

/// Search of the tree `targets` with groups of `queries`: the blocks of level kLevel.
template <bool kOnDevice, class Box, class QueryIds, class TargetIds, class Test>
struct GroupSearch {
    static constexpr int kLevel = kOnDevice ? 0 : 1;
    BvhView<Box, QueryIds> queries;
    BvhView<Box, TargetIds> targets;
    Test test;

    [[nodiscard]] int num_groups() const { return queries.levels.num_blocks(kLevel); }

    NOLI_HD void operator()(int group, PairSlots& found) const {
#if !defined(__CUDACC__)
        if constexpr (!kOnDevice) {
            with_avx2([&] { visit(group, four_leaves(group, found)); });
            return;
        }
#endif
        if constexpr (kOnDevice) visit(group, leaf(group, found));
    }

  private:
    template <class Visit>
    NOLI_HD void visit(int group, const Visit& visit) const {
        visit_blocks<kOnDevice, kLevel>(targets,
                                        box_of_block(queries, kLevel, group),
                                        Test::kSelf ? group : 0,
                                        visit);
    }
    using Leaf = LeafVisit<kOnDevice, Box, QueryIds, TargetIds, Test>;
    NOLI_HD Leaf leaf(int j, PairSlots& found) const {
        return {queries,
                targets,
                test,
                j,
                GroupBoxes<kOnDevice, Box>(queries.block(0, j)),
                found};
    }
#if !defined(__CUDACC__)
    /// Places without a leaf take the last leaf: nothing overlaps their empty boxes.
    FourLeavesVisit<Box, QueryIds, TargetIds, Test> four_leaves(int block,
                                                                PairSlots& found) const {
        const int first = block * kBlockSize;
        const int last = queries.levels.num_blocks(0) - 1;
        const auto at = [&](int k) {
            return leaf(first + k < last ? first + k : last, found);
        };
        return {targets,
                block,
                GroupBoxes<false, Box>(queries.block(1, block)),
                {at(0), at(1), at(2), at(3)}};
    }
#endif
};

template <class Exec, class Box, class QueryIds, class TargetIds, class Test>
GroupSearch<Exec::kIsDevice, Box, QueryIds, TargetIds, Test> tree_search(
    const Exec& /*exec*/,
    const BvhView<Box, QueryIds>& queries,
    const BvhView<Box, TargetIds>& targets,
    const Test& test) {
    return {queries, targets, test};
}

}  // namespace noli::detail
