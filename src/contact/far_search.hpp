// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The pairs of a pool's query that the pool cannot know: those with a primitive that
/// goes farther than its margin.
///
/// A few vertices often move far while all others hardly move. The trees of the pool hold
/// boxes around all places that a primitive within the margin can reach. Those of the far
/// primitives grow by their motion, and then only the far primitives search. Boxes that
/// have grown stay so until the next pool: they are larger than needed, never too small.

#include "contact/bvh.hpp"
#include "contact/group_search.hpp"
#include "contact/pool_query.hpp"

namespace noli::detail {

/// Box around all of a primitive's motion, grown by `gap` (m).
template <class Ids>
NOLI_HD inline StaticBox swept_box(const Motion& motion, const Ids& ids, double gap) {
    StaticBox box = empty_static_box();
    for (int k = 0; k < kNumCorners<Ids>; ++k) {
        const int v = corner(ids, k);
        add_point(box, motion.x[v], gap);
        if (motion.p.size > 0) add_point(box, motion.end(v), gap);
    }
    return box;
}

/// Level 0 of a tree: boxes of far primitives grow by their motion.
template <class Exec, class Ids>
void grow_far_boxes(Exec& exec,
                    View<const IdBlock<Ids>> ids,
                    PoolQuery query,
                    double gap,
                    View<StaticBlock> blocks) {
    exec.for_each("contact/grow_far_boxes", ids.size, [=] NOLI_HD(int j) {
        for (int place = 0; place < kBlockSize && ids[j].v[0][place] >= 0; ++place) {
            Ids own;
            load_ids(ids[j], place, own);
            if (!query.is_far(own)) continue;
            StaticBox box = load(blocks[j], place);
            merge_into(box, swept_box(query.motion, own, gap));
            store(blocks[j], place, box);
        }
    });
}

/// Calls take(query, target, their vertex ids) for each far primitive of leaf `leaf` of
/// the queries, its box grown by `gap` (m), and each target whose box it overlaps.
template <bool kOnDevice, class QueryIds, class TargetIds, class Take>
NOLI_HD inline void search_far(const BvhView<StaticBox, QueryIds>& queries,
                               const BvhView<StaticBox, TargetIds>& targets,
                               const PoolQuery& query,
                               double gap,
                               int leaf,
                               const Take& take) {
    const IdBlock<QueryIds>& ids = queries.ids[leaf];
    for (int i = 0; i < kBlockSize && ids.v[0][i] >= 0; ++i) {
        QueryIds own;
        load_ids(ids, i, own);
        if (!query.is_far(own)) continue;
        const int a = queries.order[leaf * kBlockSize + i];
        const StaticBox box = swept_box(query.motion, own, gap);
        visit_blocks<kOnDevice, 0>(targets, box, 0, [&](int other) {
            unsigned bits = overlap_bits<kOnDevice>(box, targets.block(0, other));
            for (; bits != 0; bits &= bits - 1) {
                const int j = lowest_bit(bits);
                TargetIds b_ids;
                load_ids(targets.ids[other], j, b_ids);
                take(a, targets.order[other * kBlockSize + j], own, b_ids);
            }
        });
    }
}

/// All vertex-triangle pairs with a far primitive: far vertices search the triangles, far
/// triangles the other vertices. For TreePairs.
template <bool kOnDevice, class Box>
struct FarVertexTriangle {
    static constexpr int kLevel = 0;
    BvhView<StaticBox, int> vertices;
    BvhView<StaticBox, Int3> targets;
    PooledVertexTriangle<Box> test;
    double gap;  ///< that boxes of vertices in the tree have grown by, m

    [[nodiscard]] int num_groups() const {
        return vertices.levels.num_blocks(0) + targets.levels.num_blocks(0);
    }
    NOLI_HD void operator()(int group, PairSlots& found) const {
        const int num_first = vertices.levels.num_blocks(0);
        const auto take = [&](int v, int t, int v_ids, const Int3& corners) {
            if (test.accepts(v_ids, corners)) found.add(v, t);
        };
        if (group < num_first) {
            search_far<kOnDevice>(vertices, targets, test.query, gap, group, take);
            return;
        }
        const auto take_near = [&](int t, int v, const Int3& corners, int v_ids) {
            if (!test.query.is_far(v_ids)) take(v, t, v_ids, corners);
        };
        search_far<kOnDevice>(
            targets, vertices, test.query, 0.0, group - num_first, take_near);
    }
};

/// All edge pairs with a far edge. For TreePairs.
template <bool kOnDevice, class Box>
struct FarEdgeEdge {
    static constexpr int kLevel = 0;
    BvhView<StaticBox, Int2> targets;
    PooledEdgeEdge<Box> test;
    double gap;  ///< that boxes in the tree have grown by, m

    [[nodiscard]] int num_groups() const { return targets.levels.num_blocks(0); }
    NOLI_HD void operator()(int group, PairSlots& found) const {
        const auto take = [&](int a, int b, const Int2& a_ids, const Int2& b_ids) {
            if (a == b) return;
            if (b < a) {
                // Two far edges find each other twice.
                if (!test.query.is_far(b_ids) && test.accepts(b_ids, a_ids))
                    found.add(b, a);
            } else if (test.accepts(a_ids, b_ids)) {
                found.add(a, b);
            }
        };
        search_far<kOnDevice>(targets, targets, test.query, gap, group, take);
    }
};

/// Number of pairs in a sorted list that come before `pair`.
NOLI_HD inline int place_among(View<const Int2> list, const Int2& pair) {
    int begin = 0;
    int end = list.size;
    while (begin < end) {
        const int middle = begin + (end - begin) / 2;
        const Int2& at = list[middle];
        const bool before = at[0] != pair[0] ? at[0] < pair[0] : at[1] < pair[1];
        if (before)
            begin = middle + 1;
        else
            end = middle;
    }
    return begin;
}

/// out = two sorted lists as one; no pair is in both.
template <class Exec>
void merge_pairs(Exec& exec,
                 const typename Exec::template Buffer<Int2>& a,
                 const typename Exec::template Buffer<Int2>& b,
                 typename Exec::template Buffer<Int2>& out) {
    out.resize(a.size() + b.size());
    const View<const Int2> first(a.view());
    const View<const Int2> second(b.view());
    const View<Int2> all = out.view();
    exec.for_each("contact/merge_pairs", all.size, [=] NOLI_HD(int i) {
        if (i < first.size)
            all[i + place_among(second, first[i])] = first[i];
        else
            all[i - first.size + place_among(first, second[i - first.size])] =
                second[i - first.size];
    });
}

}  // namespace noli::detail
