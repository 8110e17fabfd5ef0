// SPDX-License-Identifier: Apache-2.0
#include "contact/candidate_pool.hpp"

#include "contact/broad_phase.hpp"
#include "contact_shapes.hpp"

#include <map>
#include <string>

namespace noli {
namespace {

using namespace contact_test;

template <class Exec>
CandidateLists lists_of(const Candidates<Exec>& from) {
    return {to_vector(from.vertex_triangle.view()),
            to_vector(from.edge_edge.view()),
            to_vector(from.vertex_wall.view())};
}

/// A walk as Newton's: far, then ever less, then the next step from where it ended.
struct Walk {
    std::vector<double> sizes;
    double stop = 1.0;  ///< share of each motion that is taken
    int far = 0;        ///< vertices that move a hundred times as far
};

/// Queries one broad phase along the walk; each must find what a fresh one finds.
template <class Exec>
std::vector<CandidateLists> follow(
    Exec& exec, Shape s, const Walk& walk, double gap, unsigned seed) {
    std::mt19937 rng(seed);
    DeviceCollisionMesh<Exec> mesh;
    mesh.upload(exec, s.mesh);
    BroadPhase<Exec> broad_phase;
    Candidates<Exec> found;
    std::vector<CandidateLists> all;
    for (const double size : walk.sizes) {
        std::vector<Vec3d> p;
        for (std::size_t i = 0; size > 0.0 && i < s.x.size(); ++i)
            p.push_back(random_vector(rng, size));
        for (int k = 0; size > 0.0 && k < walk.far; ++k)
            p[rng() % p.size()] *= 100.0;
        if (size == 0.0) broad_phase.sort_at_next_search();
        find_candidates(exec, mesh, broad_phase, {s.view(), view_of(p), 0.9}, gap, found);
        all.push_back(lists_of(found));
        EXPECT_EQ(all.back(), candidates_of(exec, s, p, 0.9, gap));
        for (std::size_t i = 0; i < p.size(); ++i)
            s.x[i] += 0.9 * walk.stop * p[i];
    }
    return all;
}

const std::vector<double> kSteps = {
    0.0, 0.03, 1e-3, 5e-4, 1e-4, 1e-5,  0.0,  0.02, 2e-3, 4e-3, 1e-3, 1e-3, 1e-3, 1e-3,
    0.0, 0.0,  1e-3, 1e-4, 0.05, 0.001, 1e-5, 1e-6, 0.0,  0.01, 0.01, 0.01, 1e-3};

TEST(CandidatePool, QueriesFindWhatAFreshSearchFinds) {
    SerialExec exec;
    unsigned seed = 50;
    for (const double stop : {1.0, 0.3})
        for (const double gap : {0.002, 0.02}) {
            ++seed;
            follow(exec, two_spheres(0.01, 7), {kSteps, stop}, gap, seed);
            follow(exec, folded_sheet(6, 0.02), {kSteps, stop}, gap, seed);
            follow(exec, soup(40, 0.3, seed), {kSteps, stop}, gap, seed);
        }
}

/// Counts the loops that it runs, by name.
struct NamingExec : SerialExec {
    std::map<std::string, int> loops;

    template <class F>
    void for_each(const char* name, int n, F f, int grain = 1) {
        ++loops[name];
        SerialExec::for_each(name, n, f, grain);
    }
};

TEST(CandidatePool, KnowsAllPairsButThoseOfAFewFarVertices) {
    NamingExec exec;
    unsigned seed = 150;
    for (const double stop : {1.0, 0.3})
        for (const int far : {1, 3}) {
            ++seed;
            const Walk walk{kSteps, stop, far};
            follow(exec, two_spheres(0.01, 7), walk, 0.002, seed);
            follow(exec, folded_sheet(6, 0.02), walk, 0.002, seed);
            follow(exec, soup(40, 0.3, seed), walk, 0.02, seed);
        }
    EXPECT_GT(exec.loops["contact/grow_far_boxes"], 3 * 50);
    EXPECT_GT(exec.loops["contact/merge_pairs"], 2 * 50);
}

TEST(CandidatePool, FarVerticesMayStandStillAgain) {
    NamingExec exec;
    std::vector<double> sizes;
    for (int k = 0; k < 12; ++k) {
        sizes.push_back(1e-4);
        sizes.push_back(0.0);
    }
    const auto found = follow(exec, folded_sheet(6, 0.02), {sizes, 1.0, 2}, 0.03, 9);
    EXPECT_GT(exec.loops["contact/grow_far_boxes"], 0);
    for (const CandidateLists& lists : found)
        EXPECT_FALSE(lists.edge_edge.empty());
}

TEST(CandidatePool, MergesSortedPairs) {
    using Pairs = std::vector<std::pair<int, int>>;
    SerialExec exec;
    const auto merged = [&](const Pairs& a, const Pairs& b) {
        const auto buffer_of = [&](const Pairs& pairs) {
            std::vector<Int2> list;
            for (const auto& [first, second] : pairs)
                list.push_back({{first, second}});
            SerialExec::Buffer<Int2> out;
            exec.upload(list, out);
            return out;
        };
        SerialExec::Buffer<Int2> out;
        detail::merge_pairs(exec, buffer_of(a), buffer_of(b), out);
        return to_vector(View<const Int2>(out.view()));
    };
    const Pairs few = {{1, 5}, {2, 0}, {9, 9}};
    const Pairs many = {{0, 7}, {1, 4}, {1, 6}, {2, 1}, {3, 3}, {9, 10}};
    Pairs all = few;
    all.insert(all.end(), many.begin(), many.end());
    std::sort(all.begin(), all.end());
    EXPECT_EQ(merged(few, many), all);
    EXPECT_EQ(merged(many, few), all);
    EXPECT_EQ(merged(few, {}), few);
    EXPECT_EQ(merged({}, few), few);
}

TEST(CandidatePool, ExecutorsAgree) {
    const Shape s = folded_sheet(6, 0.02);
    SerialExec serial;
    const auto expected = follow(serial, s, {kSteps}, 0.01, 7);
    on_all_executors(
        [&](auto& exec) { return follow(exec, s, {kSteps}, 0.01, 7); },
        [&](const auto& found, const char* name) { EXPECT_EQ(found, expected) << name; });
    const auto far = follow(serial, s, {kSteps, 1.0, 2}, 0.01, 8);
    on_all_executors(
        [&](auto& exec) {
            return follow(exec, s, {kSteps, 1.0, 2}, 0.01, 8);
        },
        [&](const auto& found, const char* name) { EXPECT_EQ(found, far) << name; });
}

TEST(CandidatePool, ForgetsAnotherMesh) {
    SerialExec exec;
    Shape s = two_spheres(0.01, 7);
    DeviceCollisionMesh<SerialExec> mesh;
    mesh.upload(exec, s.mesh);
    BroadPhase<SerialExec> broad_phase;
    Candidates<SerialExec> found;
    find_candidates(exec, mesh, broad_phase, {s.view(), {}, 0.0}, 0.2, found);
    ASSERT_GT(found.size(), 0);
    s.mesh.pair_enabled.assign(s.mesh.pair_enabled.size(), 0);
    mesh.upload(exec, s.mesh);
    broad_phase.forget();
    find_candidates(exec, mesh, broad_phase, {s.view(), {}, 0.0}, 0.2, found);
    EXPECT_EQ(found.size(), 0);
}

TEST(PoolPolicy, DoesWithoutAfterUselessPools) {
    PoolPolicy policy;
    int built = 0;
    for (int k = 0; k < 100; ++k) {
        if (!(policy.margin_for(0.001, 0.01, 0.1) > 0.001)) continue;
        policy.built(10, 1000);
        policy.missed();
        ++built;
    }
    EXPECT_LT(built, 20);
    EXPECT_GT(built, 5);
}

TEST(PoolPolicy, ToleratesAFewFarVertices) {
    EXPECT_TRUE(PoolPolicy::few(1.0, 10));
    EXPECT_TRUE(PoolPolicy::few(20.0, 1000));
    EXPECT_FALSE(PoolPolicy::few(40.0, 1000));
    EXPECT_FALSE(PoolPolicy::few(10.0, 10));
}

TEST(PoolPolicy, DoesWithoutForLongMotions) {
    PoolPolicy policy;
    EXPECT_EQ(policy.margin_for(1.0, 0.01, 0.1), 0.0);
    EXPECT_EQ(policy.margin_for(NAN, 0.01, 0.1), 0.0);
    EXPECT_GT(policy.margin_for(0.0, 0.01, 0.1), 0.0);
}

TEST(PoolPolicy, MakesTheNextPoolsSmallerAfterLargeOnes) {
    PoolPolicy policy;
    const double before = policy.margin_for(0.0, 0.01, 0.1);
    for (int k = 0; k < 5; ++k)
        policy.built(1001, 1000);
    EXPECT_LT(policy.margin_for(0.0, 0.01, 0.1), 0.5 * before);
}

}  // namespace
}  // namespace noli
