// SPDX-License-Identifier: Apache-2.0
#include "linear/device_pcg.hpp"

#include "linear/pcg.hpp"
#include "random_system.hpp"
#include "support/device_like_exec.hpp"

#include <tbb/global_control.h>

#include <limits>

namespace noli {
namespace {

using namespace test;

struct Solution {
    PcgResult result;
    std::vector<Vec3d> x;
};

/// The system in an executor's memory, solved by DevicePcg.
template <class Exec>
Solution solve_on(const RandomSystem& s,
                  const std::vector<Vec3d>& b,
                  const std::vector<std::uint8_t>& fixed,
                  const PcgOptions& options,
                  const RigidAggregates& aggregates = {},
                  int most_dense_nodes = kMostDenseNodes) {
    Exec exec;
    BlockMatrix<Exec> matrix;
    LowRankTerms<Exec> terms;
    typename Exec::template Buffer<double> blocks, diagonal;
    typename Exec::template Buffer<Vec3d> rhs, x, positions;
    typename Exec::template Buffer<std::uint8_t> held;
    exec.upload(s.element_blocks, blocks);
    exec.upload(s.diagonal, diagonal);
    matrix.set_pattern(exec, build_block_pattern(s.num_vertices, std::span(s.elements)));
    matrix.assemble(exec, blocks.view(), diagonal.view());
    exec.upload(s.term_vertices, terms.vertices);
    exec.upload(s.first_mode, terms.first_mode);
    exec.upload(s.modes, terms.modes);
    terms.build_incidence(exec, s.num_vertices);
    exec.upload(b, rhs);
    exec.upload(fixed, held);
    // Junk: the solver must not read what x held.
    exec.upload(std::vector<Vec3d>(b.size(),
                                   {std::numeric_limits<double>::quiet_NaN(), 1e30, -7}),
                x);
    DevicePcg<Exec> pcg;
    pcg.set_aggregates(aggregates, most_dense_nodes);
    PcgOptions here = options;
    if (options.positions.size > 0) {
        exec.upload(
            std::vector<Vec3d>(options.positions.begin(), options.positions.end()),
            positions);
        here.positions = positions.view();
    }
    Solution out;
    out.result = pcg.solve(exec, matrix, terms, rhs.view(), held.view(), here, x.view());
    exec.download(View<const Vec3d>(x.view()), out.x);
    return out;
}

/// pcg.hpp with block Jacobi, on the CPU.
Solution solve_with_host_scalars(const RandomSystem& s,
                                 const std::vector<Vec3d>& b,
                                 const std::vector<std::uint8_t>& fixed,
                                 const PcgOptions& options) {
    SerialExec exec;
    auto loaded = load(exec, s);
    Pcg<SerialExec> pcg;
    Solution out;
    out.x.resize(b.size());
    out.result = pcg.solve(exec,
                           loaded.matrix,
                           loaded.terms,
                           view_of(b),
                           view_of(fixed),
                           options,
                           view_of(out.x));
    return out;
}

std::vector<std::uint8_t> every_seventh(int n) {
    std::vector<std::uint8_t> fixed(static_cast<std::size_t>(n), 0);
    for (std::size_t i = 0; i < fixed.size(); i += 7)
        fixed[i] = 1;
    return fixed;
}

void expect_same(const Solution& got, const Solution& expected) {
    EXPECT_EQ(got.result.iterations, expected.result.iterations);
    EXPECT_EQ(got.result.outcome, expected.result.outcome);
    EXPECT_EQ(got.result.refined, expected.result.refined);
    EXPECT_EQ(got.result.residual_ratio, expected.result.residual_ratio);
    EXPECT_TRUE(same_bits(got.x, expected.x));
}

template <class Exec>
class DevicePcgOn : public testing::Test {};
using Executors = testing::Types<SerialExec, CpuExec, ShuffledExec, DeviceLikeExec>;
TYPED_TEST_SUITE(DevicePcgOn, Executors);

TYPED_TEST(DevicePcgOn, HasTheBitsOfTheLoopWithScalarsOnTheHost) {
    for (const int n : {7, 33, 301, 2500}) {
        const RandomSystem s = random_system(n, 3 * n, n / 2, n);
        const auto b = random_vector(n, 3);
        const auto fixed = every_seventh(n);
        for (const double tolerance : {1.0, 1e-2, 1e-8, 1e-16})
            for (const auto test :
                 {PcgOptions::Test::Residual, PcgOptions::Test::Energy}) {
                PcgOptions options;
                options.tolerance = tolerance;
                options.test = test;
                expect_same(solve_on<TypeParam>(s, b, fixed, options),
                            solve_with_host_scalars(s, b, fixed, options));
            }
    }
}

TYPED_TEST(DevicePcgOn, GoesOnToTheFineToleranceWhenAsked) {
    const RandomSystem s = random_system(301, 900, 50, 2);
    const auto b = random_vector(301, 3);
    const auto fixed = every_seventh(301);
    for (const bool wanted : {false, true}) {
        PcgOptions options;
        options.test = PcgOptions::Test::Energy;
        options.tolerance = 1e-2;
        options.fine_tolerance = 1e-9;
        options.refine = [wanted](View<const Vec3d>) { return wanted; };
        const Solution got = solve_on<TypeParam>(s, b, fixed, options);
        EXPECT_EQ(got.result.refined, wanted);
        expect_same(got, solve_with_host_scalars(s, b, fixed, options));
    }
}

TYPED_TEST(DevicePcgOn, EndsAsTheLoopWithScalarsOnTheHostDoes) {
    RandomSystem s = random_system(101, 300, 20, 2);
    auto b = random_vector(101, 3);
    const auto fixed = every_seventh(101);
    PcgOptions options;
    options.tolerance = 1e-24;
    for (const int most : {0, 1, 2, 17, 18}) {  // in and at the ends of batches
        options.max_iterations = most;
        const Solution got = solve_on<TypeParam>(s, b, fixed, options);
        EXPECT_EQ(got.result.outcome, PcgResult::Outcome::MaxIterations);
        EXPECT_EQ(got.result.iterations, most);
        expect_same(got, solve_with_host_scalars(s, b, fixed, options));
    }
    options.max_iterations = 1000;
    expect_same(
        solve_on<TypeParam>(s, std::vector<Vec3d>(101, {0, 0, 0}), fixed, options),
        solve_with_host_scalars(s, std::vector<Vec3d>(101, {0, 0, 0}), fixed, options));
    for (double& h : s.element_blocks)
        h = -h;
    const Solution indefinite = solve_on<TypeParam>(s, b, fixed, options);
    EXPECT_EQ(indefinite.result.outcome, PcgResult::Outcome::Breakdown);
    expect_same(indefinite, solve_with_host_scalars(s, b, fixed, options));
    b[3].y = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(solve_on<TypeParam>(s, b, fixed, options).result.outcome,
              PcgResult::Outcome::Breakdown);
}

TYPED_TEST(DevicePcgOn, SolvesWithEveryPreconditioner) {
    constexpr int n = 203;
    const RandomSystem s = random_system(n, 3 * n, n / 2, n);
    const auto b = random_vector(n, 3);
    const auto x = random_vector(n, 4);
    const auto fixed = every_seventh(n);
    std::vector<int> order(n);
    std::iota(order.begin(), order.end(), 0);
    const RigidAggregates aggregates = cut_aggregates(s.elements, order, 8);
    ASSERT_GT(aggregates.count, 20);
    const Eigen::VectorXd expected = to_eigen([&] {
        PcgOptions exact;
        exact.tolerance = 1e-26;
        return solve_with_host_scalars(s, b, fixed, exact);
    }()
                                                  .x);
    for (const auto kind : {PreconditionerKind::BlockJacobi, PreconditionerKind::Schwarz})
        for (const bool coarse : {false, true})
            for (const int most_dense_nodes : {128, 4, 1}) {
                PcgOptions options;
                options.tolerance = 1e-24;
                options.preconditioner = kind;
                if (coarse) options.positions = view_of(x);
                const Solution got = solve_on<TypeParam>(
                    s, b, fixed, options, aggregates, most_dense_nodes);
                EXPECT_EQ(got.result.outcome, PcgResult::Outcome::Converged);
                EXPECT_EQ(got.result.preconditioner, kind);
                EXPECT_LT((to_eigen(got.x) - expected).norm(), 1e-8 * expected.norm());
                for (std::size_t i = 0; i < n; i += 7)
                    EXPECT_EQ(norm_sq(got.x[i]), 0.0);
            }
}

TEST(DevicePcg, AsksTheHostOncePerBatchWhateverTheSize) {
    long bytes[2];
    int iterations[2];
    int k = 0;
    for (const int n : {200, 2000}) {
        const RandomSystem s = random_system(n, 3 * n, n / 2, n);
        const auto b = random_vector(n, 3);
        PcgOptions options;
        options.tolerance = 1e-28;
        DeviceLikeExec exec;
        BlockMatrix<DeviceLikeExec> matrix;
        LowRankTerms<DeviceLikeExec> terms;
        ClosedBuffer<double> blocks, diagonal;
        ClosedBuffer<Vec3d> rhs, x;
        ClosedBuffer<std::uint8_t> held;
        exec.upload(s.element_blocks, blocks);
        exec.upload(s.diagonal, diagonal);
        matrix.set_pattern(exec,
                           build_block_pattern(s.num_vertices, std::span(s.elements)));
        matrix.assemble(exec, blocks.view(), diagonal.view());
        terms.resize(0, 0);
        terms.build_incidence(exec, n);
        exec.upload(b, rhs);
        exec.upload(every_seventh(n), held);
        x.resize(n);
        DevicePcg<DeviceLikeExec> pcg;
        DeviceLikeExec::traffic() = {};
        const PcgResult result =
            pcg.solve(exec, matrix, terms, rhs.view(), held.view(), options, x.view());
        EXPECT_EQ(result.outcome, PcgResult::Outcome::Converged);
        const BusTraffic& traffic = DeviceLikeExec::traffic();
        EXPECT_LE(traffic.waits, 1 + (result.iterations + 15) / 32);
        EXPECT_LE(traffic.largest, static_cast<long>(sizeof(PcgState)));
        bytes[k] = traffic.bytes / traffic.waits;
        iterations[k++] = result.iterations;
    }
    EXPECT_GT(iterations[0], 16);
    EXPECT_EQ(bytes[0], bytes[1]);
}

}  // namespace
}  // namespace noli
