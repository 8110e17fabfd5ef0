// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The tests that make a pair a candidate, for searches and for pools, and the pairs of a
/// pool that pass them.

#include "contact/candidate_pool.hpp"
#include "contact/collision_mesh.hpp"
#include "contact/moving_box.hpp"
#include "contact/reach.hpp"

#include <cstdint>

namespace noli::detail {

/// True if the motion may bring the two closer than gap; their boxes overlap.
template <class IdsA, class IdsB>
NOLI_HD inline bool may_get_close(const Motion& motion,
                                  const IdsA& a,
                                  const IdsB& b,
                                  double gap) {
    return !stay_apart(motion, a, b, gap) && within_reach(motion, a, b, gap);
}

/// Accepts vertex-triangle pairs that may get closer than gap.
struct VertexTriangleTest {
    static constexpr bool kSelf = false;
    static constexpr bool kSkipShared = true;
    CollisionMeshView mesh;
    Motion motion;
    double gap;

    NOLI_HD bool operator()(int vertex, const Int3& corners) const {
        return may_get_close(motion, vertex, corners, gap)
            && mesh.may_collide(vertex, corners);
    }
};

/// Accepts edge pairs that may get closer than gap.
struct EdgeEdgeTest {
    static constexpr bool kSelf = true;
    static constexpr bool kSkipShared = true;
    CollisionMeshView mesh;
    Motion motion;
    double gap;

    NOLI_HD bool operator()(const Int2& a, const Int2& b) const {
        return may_get_close(motion, a, b, gap) && mesh.may_collide(a, b);
    }
};

/// The box that a tree holds for a primitive.
template <class Box, class Ids>
NOLI_HD inline Box box_of(const Motion& motion, const Ids& ids, double gap) {
    Box box;
    make_empty(box);
    for (int k = 0; k < kNumCorners<Ids>; ++k)
        add_vertex(box, motion, corner(ids, k), gap);
    return box;
}

/// How far a primitive is displaced and travels at most.
template <class Ids>
NOLI_HD inline float reach_of(View<const VertexReach> reaches, const Ids& ids) {
    VertexReach most = reaches[corner(ids, 0)];
    for (int k = 1; k < kNumCorners<Ids>; ++k) {
        const VertexReach& r = reaches[corner(ids, k)];
        most.displaced = r.displaced > most.displaced ? r.displaced : most.displaced;
        most.travels = r.travels > most.travels ? r.travels : most.travels;
    }
    return most.displaced + most.travels;
}

/// A query of a pool that covers it.
struct PoolQuery {
    CollisionMeshView mesh;
    Motion motion;
    double gap;
    View<const VertexReach> reaches;
    float margin;  ///< of the pool, m; infinite where nothing goes farther

    /// True if the pool does not know all pairs of this primitive.
    template <class Ids>
    [[nodiscard]] NOLI_HD bool is_far(const Ids& ids) const {
        return !(reach_of(reaches, ids) <= margin);
    }

    /// False for pairs that no search would accept, and for those with a far primitive.
    template <class IdsA, class IdsB>
    [[nodiscard]] NOLI_HD bool worth_a_test(const IdsA& a,
                                            const IdsB& b,
                                            float distance) const {
        const float reach_a = reach_of(reaches, a);
        const float reach_b = reach_of(reaches, b);
        if (!(reach_a <= margin) || !(reach_b <= margin)) return false;
        const float reach = reach_a + reach_b;
        return !(distance >= static_cast<float>(gap) * 1.000001F + reach * 1.000001F);
    }
};

/// Keeps vertex-triangle pairs: vertices grow by the gap.
template <class Box>
struct PooledVertexTriangle {
    PoolQuery query;

    NOLI_HD bool operator()(const Int2& pair, float distance) const {
        const Int3& corners = query.mesh.triangles[pair[1]];
        return query.worth_a_test(pair[0], corners, distance)
            && would_be_found(pair[0], corners);
    }
    /// For a pair that the pool has not seen.
    [[nodiscard]] NOLI_HD bool accepts(int vertex, const Int3& corners) const {
        return query.mesh.may_collide(vertex, corners) && would_be_found(vertex, corners);
    }

  private:
    [[nodiscard]] NOLI_HD bool would_be_found(int vertex, const Int3& corners) const {
        const Motion& motion = query.motion;
        return overlap(box_of<Box>(motion, vertex, query.gap),
                       box_of<Box>(motion, corners, 0.0))
            && may_get_close(motion, vertex, corners, query.gap);
    }
};

/// Keeps edge pairs: each edge grows by half of the gap.
template <class Box>
struct PooledEdgeEdge {
    PoolQuery query;

    NOLI_HD bool operator()(const Int2& pair, float distance) const {
        const Int2& a = query.mesh.edges[pair[0]];
        const Int2& b = query.mesh.edges[pair[1]];
        return query.worth_a_test(a, b, distance) && would_be_found(a, b);
    }
    /// For a pair that the pool has not seen.
    [[nodiscard]] NOLI_HD bool accepts(const Int2& a, const Int2& b) const {
        return query.mesh.may_collide(a, b) && would_be_found(a, b);
    }

  private:
    [[nodiscard]] NOLI_HD bool would_be_found(const Int2& a, const Int2& b) const {
        const Motion& motion = query.motion;
        return overlap(box_of<Box>(motion, a, 0.5 * query.gap),
                       box_of<Box>(motion, b, 0.5 * query.gap))
            && may_get_close(motion, a, b, query.gap);
    }
};

inline constexpr int kPoolChunk = 32;

/// keep[i] = 1 where the test accepts pair i; counts per chunk of pairs.
template <class Exec, class Test>
void mark_kept(Exec& exec,
               View<const Int2> pairs,
               View<const float> distances,
               Test test,
               View<std::uint8_t> keep,
               View<int> counts) {
    exec.for_each(
        "contact/mark_kept",
        counts.size,
        [=] NOLI_HD(int c) {
            const int begin = c * kPoolChunk;
            const int end =
                begin + kPoolChunk < pairs.size ? begin + kPoolChunk : pairs.size;
            int count = 0;
            for (int i = begin; i < end; ++i) {
                keep[i] = test(pairs[i], distances[i]) ? 1 : 0;
                count += keep[i];
            }
            counts[c] = count;
        },
        8);
}

/// The kept pairs in their order.
template <class Exec>
void write_kept(Exec& exec,
                View<const Int2> pairs,
                View<const std::uint8_t> keep,
                View<const int> offsets,
                View<Int2> out) {
    exec.for_each("contact/write_kept", offsets.size - 1, [=] NOLI_HD(int c) {
        const int begin = c * kPoolChunk;
        const int end = begin + kPoolChunk < pairs.size ? begin + kPoolChunk : pairs.size;
        int at = offsets[c];
        for (int i = begin; i < end; ++i)
            if (keep[i]) out[at++] = pairs[i];
    });
}

/// The choice of some pairs of a list, and its buffers, kept between choices.
template <class Exec>
class PairFilter {
  public:
    /// Looks which pairs the test accepts.
    template <class Test>
    void start(Exec& exec,
               View<const Int2> pairs,
               View<const float> distances,
               const Test& test) {
        const int num_chunks = (pairs.size + kPoolChunk - 1) / kPoolChunk;
        pairs_ = pairs;
        keep_.resize(pairs.size);
        counts_.resize(num_chunks);
        offsets_.resize(num_chunks + 1);
        mark_kept(exec, pairs, distances, test, keep_.view(), counts_.view());
        total_ = exec.scan_later(
            "contact/scan_kept", View<const int>(counts_.view()), offsets_.view());
    }

    /// out = those pairs, in their order. Waits.
    void finish(Exec& exec, typename Exec::template Buffer<Int2>& out) {
        out.resize(static_cast<int>(exec.value(total_)));
        write_kept(exec,
                   pairs_,
                   View<const std::uint8_t>(keep_.view()),
                   View<const int>(offsets_.view()),
                   out.view());
    }

  private:
    View<const Int2> pairs_;
    typename Exec::template Buffer<std::uint8_t> keep_;
    typename Exec::template Buffer<int> counts_, offsets_;
    Later total_;
};

}  // namespace noli::detail
