// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Active pairs, sorted into one list per kind of stencil.
///
/// A candidate is classified once; its closest features are kept as a 16-bit code. Codes
/// are counted per kind in chunks of 64, one scan over all (kind, chunk) counts gives
/// every chunk its places, and a last loop writes the pairs: in the order of the
/// candidates within each kind, for every executor.
///
/// A point-point or point-edge pair that several candidates share occurs once for each:
/// that is how the barrier counts them. Source: MATH 9, 3.1.

#include "contact/candidates.hpp"
#include "exec/later.hpp"
#include "geometry/closest_feature.hpp"

#include <array>
#include <cmath>
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
    Buffer<Int2> planes;  ///< vertex, plane index

    [[nodiscard]] int size() const {
        return pp.size() + pe.size() + pt.size() + ee.size() + mollified.size()
             + planes.size();
    }
};

namespace detail {

/// The lists of a PairSet, in order.
enum class PairList : int { PP, PE, PT, EE, Mollified, Plane, None };
inline constexpr int kNumPairLists = 6;

/// Bits 0-2 list, 3-4 kind, 5-12 the four local positions (0 where unused).
NOLI_HD inline std::uint16_t encode(PairList list, const ClosestFeature& f) {
    unsigned code = static_cast<unsigned>(list) | static_cast<unsigned>(f.kind) << 3;
    for (int k = 0; k < 4; ++k) {
        const int position = f.local[k];
        if (position > 0) code |= static_cast<unsigned>(position) << (5 + 2 * k);
    }
    return static_cast<std::uint16_t>(code);
}
NOLI_HD inline PairList list_of(std::uint16_t code) {
    return static_cast<PairList>(code & 7U);
}
NOLI_HD inline PairKind kind_of(std::uint16_t code) {
    return static_cast<PairKind>((code >> 3) & 3U);
}
NOLI_HD inline int local_of(std::uint16_t code, int k) {
    return (code >> (5 + 2 * k)) & 3;
}

/// Number of points in a kind's stencil.
NOLI_HD inline int stencil_size(PairKind kind) {
    if (kind == PairKind::PointPoint) return 2;
    return kind == PairKind::PointEdge ? 3 : 4;
}

/// Candidates, numbered through as vertex-triangle, edge-edge, vertex-plane.
struct CandidateView {
    CollisionMeshView mesh;
    View<const Int2> vertex_triangle;
    View<const Int2> edge_edge;
    View<const Int2> vertex_plane;

    [[nodiscard]] NOLI_HD int size() const {
        return vertex_triangle.size + edge_edge.size + vertex_plane.size;
    }
    [[nodiscard]] NOLI_HD bool is_vertex_triangle(int i) const {
        return i < vertex_triangle.size;
    }
    [[nodiscard]] NOLI_HD bool is_plane(int i) const {
        return i >= vertex_triangle.size + edge_edge.size;
    }
    [[nodiscard]] NOLI_HD Int2 ids(int i) const {
        if (i < vertex_triangle.size) return vertex_triangle[i];
        i -= vertex_triangle.size;
        return i < edge_edge.size ? edge_edge[i] : vertex_plane[i - edge_edge.size];
    }
    /// Vertex and triangle; both edges; vertex, plane index, -1, -1.
    [[nodiscard]] NOLI_HD Int4 vertices(int i) const {
        const Int2 pair = ids(i);
        if (is_plane(i)) return {{pair[0], pair[1], -1, -1}};
        if (is_vertex_triangle(i)) {
            const Int3& t = mesh.triangles[pair[1]];
            return {{pair[0], t[0], t[1], t[2]}};
        }
        const Int2& a = mesh.edges[pair[0]];
        const Int2& b = mesh.edges[pair[1]];
        return {{a[0], a[1], b[0], b[1]}};
    }
    [[nodiscard]] NOLI_HD double eps_cross(int i) const {
        const Int2 pair = ids(i);
        return 1e-3 * mesh.edge_rest_sq[pair[0]] * mesh.edge_rest_sq[pair[1]];
    }
};

template <class Exec>
CandidateView view_of(const DeviceCollisionMesh<Exec>& mesh,
                      const Candidates<Exec>& candidates) {
    return {mesh.view(),
            candidates.vertex_triangle.view(),
            candidates.edge_edge.view(),
            candidates.vertex_plane.view()};
}

NOLI_HD inline Stencil<4> stencil_at(View<const Vec3d> x, const Int4& v) {
    return {{x[v[0]], x[v[1]], x[v[2]], x[v[3]]}};
}

/// List and closest features of candidate i at positions x; list None if it is not closer
/// than dhat.
NOLI_HD inline std::uint16_t classify_candidate(const CandidateView& candidates,
                                                View<const Vec3d> x,
                                                double dhat,
                                                int i) {
    const Int4 v = candidates.vertices(i);
    constexpr ClosestFeature kNothing{PairKind::PointPoint, {-1, -1, -1, -1}, 0.0};
    if (candidates.is_plane(i)) {
        const bool active = plane_distance(candidates.mesh.planes[v[1]], x[v[0]]) < dhat;
        return encode(active ? PairList::Plane : PairList::None, kNothing);
    }
    const Stencil<4> s = stencil_at(x, v);
    const bool vertex_triangle = candidates.is_vertex_triangle(i);
    const ClosestFeature f =
        vertex_triangle ? classify_point_triangle(s) : classify_edge_edge(s);
    if (!(std::sqrt(f.d_sq) < dhat)) return encode(PairList::None, kNothing);
    if (!vertex_triangle && edge_cross_sq(s) < candidates.eps_cross(i))
        return encode(PairList::Mollified, f);
    return encode(static_cast<PairList>(f.kind), f);
}

/// Writable lists of a PairSet.
struct PairSetView {
    View<Int2> pp;
    View<Int3> pe;
    View<Int4> pt;
    View<Int4> ee;
    View<MollifiedPair> mollified;
    View<Int2> planes;
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
        case PairList::Plane:
            out.planes[at] = {{v[0], v[1]}};
            break;
        case PairList::Mollified: {
            MollifiedPair pair{
                v, kind_of(code), {-1, -1, -1, -1}, candidates.eps_cross(i)};
            for (int k = 0; k < stencil_size(pair.kind); ++k)
                pair.local[k] = static_cast<std::int8_t>(local_of(code, k));
            out.mollified[at] = pair;
            break;
        }
        case PairList::None:
            break;
    }
}

inline constexpr int kPairChunk = 64;

template <class Exec>
void classify_candidates(Exec& exec,
                         CandidateView candidates,
                         View<const Vec3d> x,
                         double dhat,
                         View<std::uint16_t> codes) {
    exec.for_each(
        "contact/classify_candidates",
        codes.size,
        [=] NOLI_HD(int i) { codes[i] = classify_candidate(candidates, x, dhat, i); },
        32);
}

/// counts[list * num_chunks + c] = pairs of that list in chunk c.
template <class Exec>
void count_lists(Exec& exec,
                 View<const std::uint16_t> codes,
                 int num_chunks,
                 View<int> counts) {
    exec.for_each("contact/count_lists", num_chunks, [=] NOLI_HD(int c) {
        int count[kNumPairLists + 2] = {};
        for (int i = c * kPairChunk; i < (c + 1) * kPairChunk && i < codes.size; ++i)
            ++count[static_cast<int>(list_of(codes[i]))];
        for (int list = 0; list < kNumPairLists; ++list)
            counts[list * num_chunks + c] = count[list];
    });
}

/// First place of each list in the scan over all lists; one more for the end.
template <class Exec>
std::array<Later, kNumPairLists + 1> list_starts(Exec& exec,
                                                 View<const int> offsets,
                                                 int num_chunks) {
    return exec.template numbers_later<kNumPairLists + 1>(
        "contact/list_starts", [=] NOLI_HD(double* to) {
            for (int list = 0; list <= kNumPairLists; ++list)
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
    const int num_chunks = (view.size() + detail::kPairChunk - 1) / detail::kPairChunk;
    work.codes.resize(view.size());
    work.counts.resize(detail::kNumPairLists * num_chunks);
    work.offsets.resize(detail::kNumPairLists * num_chunks + 1);
    const View<const std::uint16_t> codes = work.codes.view();
    const View<const int> offsets = work.offsets.view();
    detail::classify_candidates(exec, view, x, dhat, work.codes.view());
    detail::count_lists(exec, codes, num_chunks, work.counts.view());
    exec.scan_then("contact/scan_lists",
                   View<const int>(work.counts.view()),
                   work.offsets.view(),
                   nullptr);
    const auto starts = detail::list_starts(exec, offsets, num_chunks);
    const auto size_of = [&](detail::PairList list) {
        const std::size_t k = static_cast<std::size_t>(list);
        return static_cast<int>(exec.value(starts[k + 1]) - exec.value(starts[k]));
    };
    out.pp.resize(size_of(detail::PairList::PP));
    out.pe.resize(size_of(detail::PairList::PE));
    out.pt.resize(size_of(detail::PairList::PT));
    out.ee.resize(size_of(detail::PairList::EE));
    out.mollified.resize(size_of(detail::PairList::Mollified));
    out.planes.resize(size_of(detail::PairList::Plane));
    detail::write_pairs(exec,
                        view,
                        codes,
                        offsets,
                        num_chunks,
                        {out.pp.view(),
                         out.pe.view(),
                         out.pt.view(),
                         out.ee.view(),
                         out.mollified.view(),
                         out.planes.view()});
}

}  // namespace noli
