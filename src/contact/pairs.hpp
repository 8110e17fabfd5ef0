// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Active pairs, sorted into one list per kind of stencil.
///
/// A candidate is classified once; its closest features are kept as a 16-bit code
/// (contact/candidate_code.hpp). Codes are counted per kind in chunks of 64, one scan
/// over all (kind, chunk) counts gives every chunk its places, and a last loop writes the
/// pairs: in the order of the candidates within each kind, for every executor.
///
/// A point-point or point-edge pair that several candidates share occurs once for each:
/// that is how the barrier counts them. Source: docs/theory/point_triangle.md,
/// edge_edge.md (regions), near_parallel_edges.md.

#include "contact/candidate_code.hpp"
#include "exec/later.hpp"

#include <array>
#include <cstdint>

namespace noli {

/// A nearly parallel edge-edge candidate, whatever its closest features.
struct MollifiedPair {
    Int4 v;         ///< vertices a0 a1 b0 b1
    PairKind kind;  ///< closest features: which distance counts
    std::int8_t
        local[4];  ///< their positions in v, in the order of kind's stencil; unused: -1
    double eps_cross;  ///< threshold of |u x v|^2, m^4
};

/// Pairs closer than dhat. Vertices in the stencil order of geometry/pair_geometry.hpp.
template <class Exec>
struct PairSet {
    template <class T>
    using Buffer = typename Exec::template Buffer<T>;

    Buffer<Int2> pp;  ///< p q
    Buffer<Int3> pe;  ///< p a b
    Buffer<Int4> pt;  ///< p a b c
    Buffer<Int4> ee;  ///< a0 a1 b0 b1
    Buffer<MollifiedPair> mollified;
    Buffer<Int2> walls;  ///< vertex, wall index
    /// Only: doubles suffice for the geometry of all these pairs, where they were found.
    Doubles doubles = Doubles::First;

    [[nodiscard]] int size() const {
        return pp.size() + pe.size() + pt.size() + ee.size() + mollified.size()
             + walls.size();
    }
};

namespace detail {

/// Writable lists of a PairSet.
struct PairSetView {
    View<Int2> pp;
    View<Int3> pe;
    View<Int4> pt;
    View<Int4> ee;
    View<MollifiedPair> mollified;
    View<Int2> walls;
};

/// Writes candidate i, classified as `code`, to place `at` of its list.
NOLI_HD inline void write_pair(const CandidateView& candidates,
                               int i,
                               std::uint16_t code,
                               const PairSetView& out,
                               int at) {
    const Int4 v = candidates.vertices(i);
    const int u[4] = {v[local_of(code, 0)],
                      v[local_of(code, 1)],
                      v[local_of(code, 2)],
                      v[local_of(code, 3)]};
    switch (list_of(code)) {
        case PairList::PP:
            out.pp[at] = {{u[0], u[1]}};
            break;
        case PairList::PE:
            out.pe[at] = {{u[0], u[1], u[2]}};
            break;
        case PairList::PT:
            out.pt[at] = {{u[0], u[1], u[2], u[3]}};
            break;
        case PairList::EE:
            out.ee[at] = {{u[0], u[1], u[2], u[3]}};
            break;
        case PairList::Wall:
            out.walls[at] = {{v[0], v[1]}};
            break;
        case PairList::Mollified: {
            MollifiedPair pair{
                v, kind_of(code), {-1, -1, -1, -1}, candidates.eps_cross(i)};
            for (int k = 0; k < stencil_size(pair.kind); ++k)
                pair.local[k] = static_cast<std::int8_t>(local_of(code, k));
            out.mollified[at] = pair;
            break;
        }
        case PairList::Undecided:
        case PairList::None:
            break;
    }
}

inline constexpr int kPairChunk = 64;

template <Doubles How, class Exec>
void classify_candidates(Exec& exec,
                         CandidateView candidates,
                         View<const Vec3d> x,
                         double dhat,
                         View<std::uint16_t> codes) {
    exec.for_each(
        "contact/classify_candidates",
        codes.size,
        [=] NOLI_HD(int i) {
            codes[i] = evaluate<How>(CandidateCode<How>{candidates, x, dhat, i});
        },
        32);
}

/// counts[list * num_chunks + c] = pairs of that list in chunk c.
template <class Exec>
void count_lists(Exec& exec,
                 View<const std::uint16_t> codes,
                 int num_chunks,
                 View<int> counts) {
    exec.for_each("contact/count_lists", num_chunks, [=] NOLI_HD(int c) {
        int count[kNumCounts + 1] = {};
        for (int i = c * kPairChunk; i < (c + 1) * kPairChunk && i < codes.size; ++i)
            ++count[static_cast<int>(list_of(codes[i]))];
        for (int list = 0; list < kNumCounts; ++list)
            counts[list * num_chunks + c] = count[list];
    });
}

/// First place of each list in the scan over all counts; one more for the end.
template <class Exec>
std::array<Later, kNumCounts + 1> list_starts(Exec& exec,
                                              View<const int> offsets,
                                              int num_chunks) {
    return exec.template numbers_later<kNumCounts + 1>(
        "contact/list_starts", [=] NOLI_HD(double* to) {
            for (int list = 0; list <= kNumCounts; ++list)
                to[list] = offsets[list * num_chunks];
        });
}

template <class Exec>
void write_pairs(Exec& exec,
                 CandidateView candidates,
                 View<const std::uint16_t> codes,
                 View<const int> offsets,
                 int num_chunks,
                 PairSetView out) {
    exec.for_each("contact/write_pairs", num_chunks, [=] NOLI_HD(int c) {
        int at[kNumPairLists];
        for (int list = 0; list < kNumPairLists; ++list)
            at[list] = offsets[list * num_chunks + c] - offsets[list * num_chunks];
        for (int i = c * kPairChunk; i < (c + 1) * kPairChunk && i < codes.size; ++i) {
            const int list = static_cast<int>(list_of(codes[i]));
            if (list < kNumPairLists)
                write_pair(candidates, i, codes[i], out, at[list]++);
        }
    });
}

}  // namespace detail

/// Buffers of find_pairs, kept between calls.
template <class Exec>
struct FindPairsWork {
    typename Exec::template Buffer<std::uint16_t> codes;
    typename Exec::template Buffer<int> counts;
    typename Exec::template Buffer<int> offsets;
};

namespace detail {

inline int num_pair_chunks(const CandidateView& candidates) {
    return (candidates.size() + kPairChunk - 1) / kPairChunk;
}

/// How many candidates are in which list, and whether doubles sufficed to tell.
struct ListSizes {
    std::array<int, kNumCounts> sizes;
    Doubles doubles;

    int operator[](PairList list) const { return sizes[static_cast<std::size_t>(list)]; }
};

/// Classifies all candidates and places them in their lists.
template <Doubles How, class Exec>
ListSizes sort_candidates(Exec& exec,
                          const CandidateView& candidates,
                          View<const Vec3d> x,
                          double dhat,
                          FindPairsWork<Exec>& work) {
    const int num_chunks = num_pair_chunks(candidates);
    work.codes.resize(candidates.size());
    work.counts.resize(kNumCounts * num_chunks);
    work.offsets.resize(kNumCounts * num_chunks + 1);
    classify_candidates<How>(exec, candidates, x, dhat, work.codes.view());
    count_lists(exec,
                View<const std::uint16_t>(work.codes.view()),
                num_chunks,
                work.counts.view());
    exec.scan_then("contact/scan_lists",
                   View<const int>(work.counts.view()),
                   work.offsets.view(),
                   nullptr);
    const auto starts =
        list_starts(exec, View<const int>(work.offsets.view()), num_chunks);
    ListSizes out{{}, How};
    for (std::size_t k = 0; k < out.sizes.size(); ++k)
        out.sizes[k] =
            static_cast<int>(exec.value(starts[k + 1]) - exec.value(starts[k]));
    return out;
}

/// The same, with none undecided.
template <class Exec>
ListSizes sort_all_candidates(Exec& exec,
                              const CandidateView& candidates,
                              View<const Vec3d> x,
                              double dhat,
                              FindPairsWork<Exec>& work) {
    if constexpr (Exec::kIsDevice) {
        const ListSizes out =
            sort_candidates<Doubles::Only>(exec, candidates, x, dhat, work);
        if (out[PairList::Undecided] == 0) return out;
    }
    return sort_candidates<Doubles::First>(exec, candidates, x, dhat, work);
}

}  // namespace detail

/// The candidates that are closer than dhat (m) at positions x, by kind. An edge-edge
/// candidate with |u x v|^2 < eps_cross is mollified whatever its closest features.
template <class Exec>
void find_pairs(Exec& exec,
                const DeviceCollisionMesh<Exec>& mesh,
                const Candidates<Exec>& candidates,
                View<const Vec3d> x,
                double dhat,
                FindPairsWork<Exec>& work,
                PairSet<Exec>& out) {
    const detail::CandidateView view = detail::view_of(mesh, candidates);
    const auto sizes = detail::sort_all_candidates(exec, view, x, dhat, work);
    using List = detail::PairList;
    out.pp.resize(sizes[List::PP]);
    out.pe.resize(sizes[List::PE]);
    out.pt.resize(sizes[List::PT]);
    out.ee.resize(sizes[List::EE]);
    out.mollified.resize(sizes[List::Mollified]);
    out.walls.resize(sizes[List::Wall]);
    out.doubles = sizes.doubles;
    detail::write_pairs(exec,
                        view,
                        View<const std::uint16_t>(work.codes.view()),
                        View<const int>(work.offsets.view()),
                        detail::num_pair_chunks(view),
                        {out.pp.view(),
                         out.pe.view(),
                         out.pt.view(),
                         out.ee.view(),
                         out.mollified.view(),
                         out.walls.view()});
}

}  // namespace noli
