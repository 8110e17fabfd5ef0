// SPDX-License-Identifier: Apache-2.0
#include "contact/pairs.hpp"

#include "contact/min_gap.hpp"
#include "contact_shapes.hpp"

#include <tuple>

namespace noli {
namespace {

using namespace contact_test;

using MollifiedTuple = std::tuple<std::vector<int>, int, std::vector<int>, double>;

/// A PairSet on the host, comparable, and what min_gap says of it.
struct PairLists {
    std::vector<std::vector<int>> pp, pe, pt, ee, walls;
    std::vector<MollifiedTuple> mollified;
    double gap = INFINITY;
    int gap_kind = 0;
    std::vector<int> gap_vertices;
    friend bool operator==(const PairLists&, const PairLists&) = default;

    [[nodiscard]] std::size_t size() const {
        return pp.size() + pe.size() + pt.size() + ee.size() + walls.size()
             + mollified.size();
    }
};

template <class IntN>
std::vector<std::vector<int>> to_lists(View<const IntN> list) {
    std::vector<std::vector<int>> out;
    for (const IntN& item : list)
        out.emplace_back(std::begin(item.v), std::end(item.v));
    return out;
}

MollifiedTuple to_tuple(const MollifiedPair& m) {
    return {{std::begin(m.v.v), std::end(m.v.v)},
            int(m.kind),
            {std::begin(m.local), std::end(m.local)},
            m.eps_cross};
}

template <class Exec>
PairLists pairs_of(Exec& exec, const Shape& s, double dhat) {
    DeviceCollisionMesh<Exec> mesh;
    mesh.upload(exec, s.mesh);
    BroadPhase<Exec> broad_phase;
    Candidates<Exec> candidates;
    find_candidates(exec, mesh, broad_phase, {s.view(), {}, 0.0}, dhat, candidates);
    PairSet<Exec> pairs;
    FindPairsWork<Exec> work;
    find_pairs(exec, mesh, candidates, s.view(), dhat, work, pairs);
    PairLists out;
    out.pp = to_lists(View<const Int2>(pairs.pp.view()));
    out.pe = to_lists(View<const Int3>(pairs.pe.view()));
    out.pt = to_lists(View<const Int4>(pairs.pt.view()));
    out.ee = to_lists(View<const Int4>(pairs.ee.view()));
    out.walls = to_lists(View<const Int2>(pairs.walls.view()));
    for (const MollifiedPair& m : pairs.mollified.view())
        out.mollified.push_back(to_tuple(m));
    EXPECT_EQ(int(out.size()), pairs.size());
    MinGapWork<Exec> gap_work;
    const MinGap gap = min_gap(exec, mesh, pairs, s.view(), gap_work);
    out.gap = gap.gap;
    out.gap_kind = int(gap.kind);
    out.gap_vertices.assign(std::begin(gap.vertices.v), std::end(gap.vertices.v));
    return out;
}

void add_brute_pair(const ClosestFeature& f, const Int4& v, PairLists& out) {
    std::vector<int> ids;
    for (const int k : f.local)
        if (k >= 0) ids.push_back(v[k]);
    if (f.kind == PairKind::PointPoint) out.pp.push_back(ids);
    if (f.kind == PairKind::PointEdge) out.pe.push_back(ids);
    if (f.kind == PairKind::PointTriangle) out.pt.push_back(ids);
    if (f.kind == PairKind::EdgeEdge) out.ee.push_back(ids);
}

/// Every pair of the mesh, classified one by one.
PairLists brute_pairs(const Shape& s, double dhat) {
    PairLists out;
    const auto all = [](int, int) { return true; };
    for (const auto& [v, t] : brute_vertex_triangle(s, all)) {
        const ClosestFeature f =
            classify_point_triangle(vertex_triangle_stencil(s, v, t, s.x));
        const Int3& c = s.mesh.triangles[std::size_t(t)];
        if (std::sqrt(f.d_sq) < dhat) add_brute_pair(f, {{v, c[0], c[1], c[2]}}, out);
        out.gap = std::min(out.gap, std::sqrt(f.d_sq));
    }
    for (const auto& [a, b] : brute_edge_edge(s, all)) {
        const Stencil<4> stencil = edge_edge_stencil(s, a, b, s.x);
        const ClosestFeature f = classify_edge_edge(stencil);
        out.gap = std::min(out.gap, std::sqrt(f.d_sq));
        if (!(std::sqrt(f.d_sq) < dhat)) continue;
        const Int2& ea = s.mesh.edges[std::size_t(a)];
        const Int2& eb = s.mesh.edges[std::size_t(b)];
        const Int4 v{{ea[0], ea[1], eb[0], eb[1]}};
        const double eps = 1e-3 * s.mesh.edge_rest_sq[std::size_t(a)]
                         * s.mesh.edge_rest_sq[std::size_t(b)];
        if (edge_cross_sq(stencil) < eps) {
            MollifiedPair m{v, f.kind, {-1, -1, -1, -1}, eps};
            for (int k = 0; k < 4; ++k)
                m.local[k] = std::int8_t(f.local[k]);
            out.mollified.push_back(to_tuple(m));
        } else {
            add_brute_pair(f, v, out);
        }
    }
    return out;
}

void expect_equal_lists(const PairLists& found, const PairLists& expected) {
    EXPECT_EQ(found.pp, expected.pp);
    EXPECT_EQ(found.pe, expected.pe);
    EXPECT_EQ(found.pt, expected.pt);
    EXPECT_EQ(found.ee, expected.ee);
    EXPECT_EQ(found.mollified, expected.mollified);
    if (found.size() > 0) {
        // A gap is computed from the closest features, not from the candidate.
        EXPECT_NEAR(found.gap, expected.gap, 1e-9 * expected.gap);
    }
}

TEST(Pairs, OnSoupsMatchBruteForce) {
    SerialExec exec;
    unsigned seed = 40;
    for (const int n : {1, 2, 9, 33, 101}) {
        const Shape s = soup(n, 0.25, ++seed);
        for (const double dhat : {0.005, 0.1})
            expect_equal_lists(pairs_of(exec, s, dhat), brute_pairs(s, dhat));
    }
}

TEST(Pairs, OnShapesMatchBruteForceAndCoverAllKinds) {
    SerialExec exec;
    const Shape spheres = two_spheres(0.01, 8);
    expect_equal_lists(pairs_of(exec, spheres, 0.05), brute_pairs(spheres, 0.05));
    const Shape sheet = folded_sheet(9, 0.02);
    const PairLists found = pairs_of(exec, sheet, 0.04);
    expect_equal_lists(found, brute_pairs(sheet, 0.04));
    EXPECT_GT(found.pp.size(), 0U);
    EXPECT_GT(found.pe.size(), 0U);
    EXPECT_GT(found.pt.size(), 0U);
    EXPECT_GT(found.ee.size(), 0U);
    EXPECT_GT(found.mollified.size(), 0U);
}

TEST(Pairs, SharedClosestFeaturesCountOncePerCandidate) {
    Shape s;  // a point above the common edge of two triangles
    s.x = {{-1, 0, 0}, {1, 0, 0}, {0, 1, -1}, {0, -1, -1}, {0, 0, 0.1}};
    s.mesh.triangles = {{{0, 1, 2}}, {{1, 0, 3}}};
    complete(s, {}, {4});
    SerialExec exec;
    const PairLists found = pairs_of(exec, s, 0.2);
    ASSERT_EQ(found.pe.size(), 2U);
    EXPECT_EQ(found.size(), 2U);
    for (const auto& pair : found.pe)
        EXPECT_EQ(pair[0], 4);
    EXPECT_DOUBLE_EQ(found.gap, 0.1);
    EXPECT_EQ(found.gap_kind, int(MinGap::Kind::PointEdge));
    EXPECT_EQ(found.gap_vertices.back(), -1);
}

TEST(Pairs, ParallelEdgesAreMollifiedByRestLength) {
    Shape s;
    s.x = {{0, 0, 0},
           {1, 0, 0},
           {0.3, 0, 0.1},
           {0.7, 0, 0.1},
           {0, 0, 5},
           {1, 0, 5},
           {0.5, -1, 5.1},
           {0.5, 1, 5.1}};
    complete(s, {{{0, 1}}, {{2, 3}}, {{4, 5}}, {{6, 7}}});
    SerialExec exec;
    const PairLists found = pairs_of(exec, s, 0.2);
    EXPECT_EQ(found.size(), 2U);
    ASSERT_EQ(found.mollified.size(), 1U);
    const auto& [v, kind, local, eps] = found.mollified[0];
    EXPECT_EQ(v, (std::vector<int>{0, 1, 2, 3}));
    EXPECT_EQ(kind, int(PairKind::PointEdge));
    EXPECT_EQ(local[3], -1);
    EXPECT_DOUBLE_EQ(eps, 1e-3 * 1.0 * 0.16);
    EXPECT_EQ(found.ee, (std::vector<std::vector<int>>{{4, 5, 6, 7}}));
}

TEST(Pairs, HalfSpacesAreActiveBelowDhatAndBehind) {
    Shape s;
    s.x = {{0, 0.05, 0}, {1, -0.2, 0}, {0, 3, 0}};
    s.mesh.walls = {{{0, 1, 0}, 0.0}};
    complete(s, {}, {0, 1, 2});
    SerialExec exec;
    const PairLists found = pairs_of(exec, s, 0.1);
    EXPECT_EQ(found.walls, (std::vector<std::vector<int>>{{0, 0}, {1, 0}}));
    EXPECT_DOUBLE_EQ(found.gap, -0.2);
    EXPECT_EQ(found.gap_kind, int(MinGap::Kind::Wall));
    EXPECT_EQ(found.gap_vertices, (std::vector<int>{1, 0, -1, -1}));
}

TEST(Pairs, NoneGivesAnInfiniteGap) {
    Shape s;
    complete(s);
    SerialExec exec;
    const PairLists found = pairs_of(exec, s, 0.1);
    EXPECT_EQ(found.size(), 0U);
    EXPECT_EQ(found.gap, INFINITY);
    EXPECT_EQ(found.gap_kind, int(MinGap::Kind::None));
}

TEST(Pairs, ANanPositionIsNotHiddenByTheGap) {
    Shape s;
    s.x = {{0, 0.05, 0}, {1, 0.02, 0}};
    s.mesh.walls = {{{0, 1, 0}, 0.0}};
    complete(s, {}, {0, 1});
    SerialExec exec;
    DeviceCollisionMesh<SerialExec> mesh;
    mesh.upload(exec, s.mesh);
    BroadPhase<SerialExec> broad_phase;
    Candidates<SerialExec> candidates;
    find_candidates(exec, mesh, broad_phase, {s.view(), {}, 0.0}, 0.1, candidates);
    PairSet<SerialExec> pairs;
    FindPairsWork<SerialExec> work;
    find_pairs(exec, mesh, candidates, s.view(), 0.1, work, pairs);
    ASSERT_EQ(pairs.size(), 2);
    s.x[0].y = std::nan("");
    MinGapWork<SerialExec> gap_work;
    EXPECT_TRUE(std::isnan(min_gap(exec, mesh, pairs, s.view(), gap_work).gap));
}

TEST(Pairs, AreEqualForEveryExecutorAndThreadCount) {
    Shape s = folded_sheet(13, 0.02);
    s.mesh.walls.push_back({{0.0, 1.0, 0.0}, -0.01});
    s.mesh.wall_enabled = {1};
    SerialExec serial;
    const PairLists expected = pairs_of(serial, s, 0.03);
    EXPECT_GT(expected.size(), 1000U);
    on_all_executors([&](auto& exec) { return pairs_of(exec, s, 0.03); },
                     [&](const PairLists& found, const char* name) {
                         EXPECT_TRUE(found == expected) << name;
                     });
}

}  // namespace
}  // namespace noli
