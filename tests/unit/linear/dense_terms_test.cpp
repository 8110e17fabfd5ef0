// SPDX-License-Identifier: Apache-2.0
/// The supplement's storage and product of contacts against the low-rank terms that they
/// are made from.
#include "linear/dense_terms.hpp"

#include "linear/pcg.hpp"
#include "random_system.hpp"
#include "support/device_like_exec.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace noli {
namespace {

using namespace test;

constexpr int kVertices = 70;
constexpr int kPerKind = 13;

/// Terms on two, three, four points and one, twice, as the objective lays them out.
RandomSystem terms_by_points() {
    RandomSystem s = random_system(kVertices, 60, 0, 5);
    std::mt19937 rng(11);
    std::normal_distribution<double> normal;
    for (const int points : {2, 3, 4, 1, 2, 3, 4, 1})
        for (int i = 0; i < kPerKind; ++i) {
            Int4 v = random_vertices(rng, kVertices, kVertices - 1);
            for (int k = points; k < 4; ++k)
                v[k] = -1;
            s.term_vertices.push_back(v);
            for (int m = 0; m < 1 + i % 3; ++m) {
                Mode mode{};
                for (int k = 0; k < points; ++k)
                    mode.q[k] = {normal(rng), normal(rng), normal(rng)};
                s.modes.push_back(mode);
            }
            s.first_mode.push_back(static_cast<int>(s.modes.size()));
        }
    return s;
}

template <class Exec>
LoadedSystem<Exec> load_with_runs(Exec& exec) {
    LoadedSystem<Exec> out = load(exec, terms_by_points());
    int first = 0;
    for (const int points : {2, 3, 4, 1, 2, 3, 4, 1}) {
        out.terms.runs.push_back({first, kPerKind, points});
        first += kPerKind;
    }
    return out;
}

double largest_difference(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
    double largest = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
        largest = std::max(largest, max_abs(a[i] - b[i]));
    return largest;
}

template <class Exec>
std::vector<Vec3d> product(bool by_warps, bool skip = false) {
    Exec exec;
    LoadedSystem<Exec> loaded = load_with_runs(exec);
    typename Exec::template Buffer<Vec3d> x, y;
    typename Exec::template Buffer<std::uint8_t> skips;
    exec.upload(random_vector(kVertices, 1), x);
    exec.upload(random_vector(kVertices, 2), y);
    exec.upload(std::vector<std::uint8_t>{skip ? std::uint8_t{1} : std::uint8_t{0}},
                skips);
    const bool* flag = reinterpret_cast<const bool*>(skips.view().data);
    if (by_warps) {
        DenseTerms<Exec> dense;
        dense.build(exec, loaded.terms);
        dense.multiply_add(exec, View<const Vec3d>(x.view()), y.view(), flag);
    } else {
        loaded.terms.multiply_add(exec, View<const Vec3d>(x.view()), y.view(), flag);
    }
    std::vector<Vec3d> out;
    exec.download(View<const Vec3d>(y.view()), out);
    return out;
}

TEST(DenseTerms, MultiplyAsTheModesDo) {
    const std::vector<Vec3d> expected = product<SerialExec>(false);
    EXPECT_GT(largest_difference(expected, random_vector(kVertices, 2)), 1.0);
    EXPECT_LT(largest_difference(product<SerialExec>(true), expected), 1e-12);
}

TEST(DenseTerms, HaveTheSameBitsOnEveryExecutorOfTheHost) {
    const std::vector<Vec3d> serial = product<SerialExec>(true);
    EXPECT_TRUE(same_bits(product<CpuExec>(true), serial));
    EXPECT_TRUE(same_bits(product<ShuffledExec>(true), serial));
    EXPECT_TRUE(same_bits(product<DeviceLikeExec>(true), serial));
}

TEST(DenseTerms, DoNothingOnceTheSolverHasEnded) {
    EXPECT_TRUE(same_bits(product<SerialExec>(true, true), random_vector(kVertices, 2)));
}

template <class Exec>
std::vector<Vec3d> solution(bool by_warps) {
    Exec exec;
    LoadedSystem<Exec> loaded = load_with_runs(exec);
    typename Exec::template Buffer<Vec3d> b, x;
    typename Exec::template Buffer<std::uint8_t> fixed;
    exec.upload(random_vector(kVertices, 3), b);
    exec.upload(std::vector<std::uint8_t>(kVertices, 0), fixed);
    x.resize(kVertices);
    Pcg<Exec> pcg;
    PcgOptions options;
    options.tolerance = 1e-24;
    options.preconditioner = PreconditionerKind::GaussSeidel;  // gives way to the product
    options.contacts_by_warps = by_warps;
    const PcgResult result = pcg.solve(exec,
                                       loaded.matrix,
                                       loaded.terms,
                                       View<const Vec3d>(b.view()),
                                       fixed.view(),
                                       options,
                                       x.view());
    EXPECT_EQ(result.outcome, PcgResult::Outcome::Converged);
    if (by_warps) {
        EXPECT_EQ(result.preconditioner, PreconditionerKind::BlockJacobi);
    }
    std::vector<Vec3d> out;
    exec.download(View<const Vec3d>(x.view()), out);
    return out;
}

TEST(DenseTerms, GiveTheSameSolution) {
    const std::vector<Vec3d> expected = solution<SerialExec>(false);
    double largest = 0.0;
    for (const Vec3d& v : expected)
        largest = std::max(largest, max_abs(v));
    EXPECT_LT(largest_difference(solution<SerialExec>(true), expected), 1e-9 * largest);
    EXPECT_LT(largest_difference(solution<CpuExec>(true), expected), 1e-9 * largest);
    EXPECT_LT(largest_difference(solution<DeviceLikeExec>(true), expected),
              1e-9 * largest);
}

}  // namespace
}  // namespace noli
