// SPDX-License-Identifier: Apache-2.0
#include "mesh/checker.hpp"

#include <numeric>
#include <tuple>

namespace noli::detail {

namespace {

/// Groups of edges that hang together through their ends.
int count_fans(const Int2* begin, const Int2* end) {
    std::vector<int> ends;
    for (const Int2* e = begin; e != end; ++e)
        ends.insert(ends.end(), e->v, e->v + 2);
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    std::vector<int> parent(ends.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](int vertex) {
        auto i = static_cast<int>(std::lower_bound(ends.begin(), ends.end(), vertex)
                                  - ends.begin());
        while (parent[static_cast<std::size_t>(i)] != i)
            i = parent[static_cast<std::size_t>(i)] =
                parent[static_cast<std::size_t>(parent[static_cast<std::size_t>(i)])];
        return i;
    };
    auto groups = static_cast<int>(ends.size());
    for (const Int2* e = begin; e != end; ++e) {
        const int a = root((*e)[0]), b = root((*e)[1]);
        if (a == b) continue;
        parent[static_cast<std::size_t>(a)] = b;
        --groups;
    }
    return groups;
}

}  // namespace

void Checker::check_surface() {
    Tally degenerate, poor;
    for (std::size_t e = 0; e < mesh_.triangles.size(); ++e) {
        const Int3& t = mesh_.triangles[e];
        const double ratio = radius_ratio(x(t[0]), x(t[1]), x(t[2]));
        if (ratio <= options_.degenerate_below)
            degenerate.add(e);
        else if (ratio < options_.poor_below)
            poor.add(e);
    }
    if (degenerate.count > 0)
        error(Kind::Degenerate,
              degenerate,
              fmt::format("has {} degenerate triangles (first: {}); remove triangles "
                          "without area or merge close "
                          "vertices",
                          degenerate.count,
                          degenerate.first));
    if (poor.count > 0)
        warn(Kind::PoorShape,
             poor,
             fmt::format("has {} triangles of poor shape (first: {}); mesh again if "
                         "contact there is noisy",
                         poor.count,
                         poor.first));
    check_duplicate_elements(mesh_.triangles, Severity::Warning);
    check_edges_of(mesh_.triangles, "has ");
    check_vertices_of(mesh_.triangles, "has ");
}

void Checker::check_segments() {
    Tally degenerate;
    for (std::size_t e = 0; e < mesh_.segments.size(); ++e)
        if (norm_sq(x(mesh_.segments[e][1]) - x(mesh_.segments[e][0])) == 0.0)
            degenerate.add(e);
    if (degenerate.count > 0)
        error(Kind::Degenerate,
              degenerate,
              fmt::format("has {} segments of length 0 (first: {}); remove them",
                          degenerate.count,
                          degenerate.first));
    check_duplicate_elements(mesh_.segments, Severity::Warning);
}

/// Edges with more than two triangles; edges that two triangles run through in one
/// direction.
void Checker::check_edges_of(const std::vector<Int3>& surface, const char* whose) {
    struct HalfEdge {
        int lo, hi, triangle;
        bool forward;
    };
    std::vector<HalfEdge> edges;
    edges.reserve(3 * surface.size());
    for (std::size_t t = 0; t < surface.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            const int a = surface[t][k], b = surface[t][(k + 1) % 3];
            edges.push_back({std::min(a, b), std::max(a, b), static_cast<int>(t), a < b});
        }
    std::sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
        return std::tie(a.lo, a.hi, a.triangle) < std::tie(b.lo, b.hi, b.triangle);
    });
    Tally crowded, against;
    std::size_t crowded_at = 0;
    for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
        for (end = i + 1; end < edges.size() && edges[end].lo == edges[i].lo
                          && edges[end].hi == edges[i].hi;)
            ++end;
        if (end - i > 2) {
            if (crowded.count == 0) crowded_at = i;
            crowded.add(static_cast<std::size_t>(edges[i].triangle));
        } else if (end - i == 2 && edges[i].forward == edges[i + 1].forward) {
            against.add(static_cast<std::size_t>(edges[i].triangle));
        }
    }
    if (crowded.count > 0)
        report(
            options_.allow_non_manifold ? Severity::Warning : Severity::Error,
            Kind::NonManifoldEdge,
            crowded,
            fmt::format(
                "{}{} non-manifold edges, with more than two triangles (first: vertices "
                "{} and {}, "
                "triangle {}); repair the surface, or set \"allow_non_manifold\": true",
                whose,
                crowded.count,
                edges[crowded_at].lo,
                edges[crowded_at].hi,
                crowded.first));
    if (against.count > 0 && role_ == MeshRole::Surface)
        warn(Kind::InconsistentOrientation,
             against,
             fmt::format("{}{} edges whose two triangles turn against each other (first "
                         "at triangle {}); orient "
                         "the surface if its outside matters",
                         whose,
                         against.count,
                         against.first));
}

/// Vertices whose triangles form more than one fan.
void Checker::check_vertices_of(const std::vector<Int3>& surface, const char* whose) {
    std::vector<int> start(mesh_.x.size() + 1, 0);
    for (const Int3& t : surface)
        for (const int v : t.v)
            ++start[static_cast<std::size_t>(v) + 1];
    for (std::size_t v = 0; v < mesh_.x.size(); ++v)
        start[v + 1] += start[v];
    std::vector<Int2> rim(
        3 * surface.size());  // the edge opposite to the vertex, per incident triangle
    std::vector<int> fill(start.begin(), start.end() - 1);
    for (const Int3& t : surface)
        for (int k = 0; k < 3; ++k)
            rim[static_cast<std::size_t>(fill[static_cast<std::size_t>(t[k])]++)] = {
                t[(k + 1) % 3], t[(k + 2) % 3]};
    Tally bad;
    for (std::size_t v = 0; v < mesh_.x.size(); ++v)
        if (count_fans(rim.data() + start[v], rim.data() + start[v + 1]) > 1) bad.add(v);
    if (bad.count > 0)
        warn(Kind::NonManifoldVertex,
             bad,
             fmt::format("{}{} non-manifold vertices, where parts of it meet in one "
                         "point (first: {}); split them "
                         "if the parts should move apart",
                         whose,
                         bad.count,
                         bad.first));
}

}  // namespace noli::detail
