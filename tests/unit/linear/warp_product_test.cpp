// SPDX-License-Identifier: Apache-2.0
#include "linear/warp_product.hpp"

#include "dense_blocks.hpp"
#include "energy/contact_pair.hpp"
#include "exec/cpu.hpp"
#include "linear/dense_pairs.hpp"
#include "random_system.hpp"

#include <cmath>
#include <set>

namespace noli {
namespace {

using namespace test;

template <class Size>
class WarpProductOfSize : public testing::Test {
  public:
    static constexpr int kSize = Size::value;

    /// Relative error of the simulated product over `range`.
    static double error(const RandomBlocks<kSize>& blocks,
                        EntryRange range,
                        int threads) {
        std::vector<double> y(blocks.c.size(), 0.0);
        simulate_warp_product(blocks.view(), range, threads, blocks.c_view(), view_of(y));
        return relative_error(y, blocks.product(range));
    }
};
template <int m>
using Size = std::integral_constant<int, m>;
using Sizes = testing::Types<Size<6>, Size<9>, Size<12>>;
TYPED_TEST_SUITE(WarpProductOfSize, Sizes);

TYPED_TEST(WarpProductOfSize, MatchesPlainProductForEveryThreadBlockSize) {
    const RandomBlocks<TypeParam::value> blocks(37, 40, 1);
    for (int threads = 32; threads <= 1024; threads += 32)
        EXPECT_LT(this->error(blocks, blocks.all_entries(), threads), 1e-14) << threads;
}

TYPED_TEST(WarpProductOfSize, MatchesPlainProductWhateverLanesTheLastWarpHas) {
    constexpr int m = TypeParam::value;
    std::set<int> lanes_in_last_warp;
    for (int num_blocks = 1; num_blocks <= 40; ++num_blocks) {
        const RandomBlocks<m> blocks(num_blocks, 9, static_cast<unsigned>(num_blocks));
        lanes_in_last_warp.insert(m * m * num_blocks % 32);
        for (const int threads : {32, 64, 256})
            EXPECT_LT(this->error(blocks, blocks.all_entries(), threads), 1e-14)
                << num_blocks << " blocks, " << threads << " threads";
    }
    // Multiples of gcd(m^2, 32) = 4, 1, 16: all that whole blocks can leave over.
    EXPECT_EQ(lanes_in_last_warp.size(), m == 6 ? 8U : m == 9 ? 32U : 2U);
}

TYPED_TEST(WarpProductOfSize, MatchesPlainProductFromAndToAnyEntry) {
    constexpr int m = TypeParam::value;
    const RandomBlocks<m> blocks(5, 12, 7);
    std::set<std::uint32_t> offsets;  // of thread blocks within their first row
    for (std::uint32_t begin = 0; begin < m * m + 3; ++begin)
        for (std::uint32_t length = 1; length < 2 * m * m; length += 3) {
            for (std::uint32_t at = begin; at < begin + length; at += 64)
                offsets.insert(at % m);
            ASSERT_LT(this->error(blocks, {begin, begin + length}, 64), 1e-14)
                << "entries " << begin << " to " << begin + length;
        }
    EXPECT_EQ(offsets.size(), static_cast<std::size_t>(m));
}

TYPED_TEST(WarpProductOfSize, WritesOncePerRowAndOncePerWarpThatBeginsInsideOne) {
    constexpr int m = TypeParam::value;
    constexpr int kNumBlocks = 37;
    const RandomBlocks<m> blocks(kNumBlocks, 40, 3);
    int starts_inside = 0;
    for (int i = 0; i < m * m * kNumBlocks; i += 32)
        starts_inside += i % m == 0 ? 0 : 1;
    std::vector<double> y(blocks.c.size(), 0.0);
    const int writes = simulate_warp_product(
        blocks.view(), blocks.all_entries(), 256, blocks.c_view(), view_of(y));
    EXPECT_EQ(writes, m * kNumBlocks + starts_inside);
    this->RecordProperty("writes_per_row",
                         std::to_string(static_cast<double>(writes) / (m * kNumBlocks)));
}

TYPED_TEST(WarpProductOfSize, AddsNothingForAnEmptyRange) {
    const RandomBlocks<TypeParam::value> blocks(2, 5, 4);
    std::vector<double> y(blocks.c.size(), 2.5);
    const auto before = y;
    EXPECT_EQ(
        simulate_warp_product(blocks.view(), {7, 7}, 32, blocks.c_view(), view_of(y)), 0);
    EXPECT_EQ(y, before);
}

TEST(WarpProduct, AddsToWhatYHolds) {
    const RandomBlocks<9> blocks(6, 20, 5);
    std::vector<double> y(blocks.c.size(), 1.0);
    simulate_warp_product(
        blocks.view(), blocks.all_entries(), 96, blocks.c_view(), view_of(y));
    const Eigen::VectorXd expected = blocks.product() + Eigen::VectorXd::Ones(60);
    EXPECT_LT(relative_error(y, expected), 1e-14);
}

TEST(ReductionInterval, CountsTheLanesUpToTheNextBoundary) {
    std::mt19937 rng(11);
    for (int trial = 0; trial < 2000; ++trial) {
        std::uint32_t bits = 1;
        for (int i = 0; i < trial % 20; ++i)
            bits |= std::uint32_t{1} << (rng() % 32);
        for (int lane = 0; lane < 32; ++lane) {
            int expected = 0;
            while (lane + expected + 1 < 32 && (bits >> (lane + expected + 1) & 1U) == 0)
                ++expected;
            ASSERT_EQ(reduction_interval(bits, lane), expected) << bits << " " << lane;
        }
    }
}

TEST(SimulatedWarp, ShuffleReadsNeighboursOwnAndNaN) {
    const SimulatedWarp warp{.active = 0x0000ffff};
    const auto lane_number = warp.each([](int lane) { return 1.0 * lane; });
    const auto got = warp.shuffle_down(lane_number, 4);
    EXPECT_EQ(got.lane[3], 7.0);
    EXPECT_EQ(got.lane[11], 15.0);
    EXPECT_TRUE(std::isnan(got.lane[12]));
    const SimulatedWarp full;
    EXPECT_EQ(
        full.shuffle_down(full.each([](int lane) { return 1.0 * lane; }), 4).lane[30],
        30.0);
    EXPECT_EQ(warp.ballot([](int) { return true; }), 0x0000ffffU);
}

TEST(WarpProduct, BytesPerPairAreThoseOfTheStoredNumbers) {
    EXPECT_EQ(kDenseBytes<2>, 36 * 8 + 2 * 4U);
    EXPECT_EQ(kDenseBytes<3>, 81 * 8 + 3 * 4U);
    EXPECT_EQ(kDenseBytes<4>, 144 * 8 + 4 * 4U);
    EXPECT_EQ(low_rank_bytes(1), 12 * 8 + 20U);
    EXPECT_EQ(low_rank_bytes(3), 36 * 8 + 20U);
}

/// Random pairs of all four types as dense blocks and as low-rank terms.
struct RandomPairs {
    static constexpr int kPairsPerType = 23;
    static constexpr int kNumVertices = 60;
    static constexpr BarrierParams kBarrier{
        .dhat = 2.0, .kappa = 3.0, .exponent = 2, .curvature_cap = 0.0};

    SerialExec exec;
    WarpProduct<SerialExec> dense;
    LowRankTerms<SerialExec> low_rank;
    std::vector<Int4> term_vertices;
    std::vector<int> first_mode{0};
    std::vector<Mode> modes;
    std::mt19937 rng{17};
    std::vector<Vec3d> x;

    explicit RandomPairs(ContactHessian model) {
        std::uniform_real_distribution<double> unit(0.0, 1.0);
        for (int i = 0; i < kNumVertices; ++i)
            x.push_back({unit(rng), unit(rng), unit(rng)});
        add(model, PairKind::PointPoint, dense.point_point);
        add(model, PairKind::PointEdge, dense.point_edge);
        add(model, PairKind::PointTriangle, dense.point_triangle);
        add(model, PairKind::EdgeEdge, dense.edge_edge);
        exec.upload(term_vertices, low_rank.vertices);
        exec.upload(first_mode, low_rank.first_mode);
        exec.upload(modes, low_rank.modes);
        low_rank.build_incidence(exec, kNumVertices);
        dense.build_incidence(exec, kNumVertices);
    }

    template <int S>
    void add(ContactHessian model, PairKind kind, DenseBlocks<SerialExec, S>& to) {
        to.resize(kPairsPerType);
        for (int i = 0; i < kPairsPerType; ++i) {
            const Int4 v = random_vertices(rng, kNumVertices, kNumVertices - 1);
            Stencil<S> at;
            Int4 term{{-1, -1, -1, -1}};
            for (int s = 0; s < S; ++s) {
                at.x[s] = x[static_cast<std::size_t>(v[s])];
                to.vertices.view()[S * i + s] = v[s];
                term[s] = v[s];
            }
            const auto hessian = pair_hessian(model, kind, at, kBarrier);
            dense_block(hessian, to.values.view().data + 9 * S * S * i);
            term_vertices.push_back(term);
            add_modes(hessian);
        }
    }

    template <int S, int R>
    void add_modes(const StencilModes<S, R>& hessian) {
        for (int k = 0; k < hessian.rank; ++k) {
            Mode mode{};
            for (int s = 0; s < S; ++s)
                mode.q[s] = hessian.q[k][s];
            modes.push_back(mode);
        }
        first_mode.push_back(static_cast<int>(modes.size()));
    }

    template <int m>
    void simulate(const DenseBlockView<m>& blocks,
                  const std::vector<Vec3d>& c,
                  std::vector<Vec3d>& y) {
        simulate_warp_product(blocks,
                              {0, blocks.num_entries()},
                              256,
                              components(view_of(c)),
                              components(view_of(y)));
    }
};

TEST(WarpProduct, EqualsTheLowRankOperatorOnRandomPairs) {
    for (const auto model : {ContactHessian::GaussNewton,
                             ContactHessian::GaussNewtonPlus,
                             ContactHessian::Exact}) {
        RandomPairs pairs(model);
        ASSERT_GT(pairs.modes.size(), 4U * RandomPairs::kPairsPerType / 2);
        const auto c = random_vector(RandomPairs::kNumVertices, 5);
        std::vector<Vec3d> by_modes(c.size(), Vec3d{0, 0, 0});
        std::vector<Vec3d> by_warps = by_modes;
        std::vector<Vec3d> by_loops = by_modes;
        pairs.low_rank.multiply_add(pairs.exec, view_of(c), view_of(by_modes));
        pairs.simulate(pairs.dense.point_point.view(), c, by_warps);
        pairs.simulate(pairs.dense.point_edge.view(), c, by_warps);
        pairs.simulate(pairs.dense.point_triangle.view(), c, by_warps);
        pairs.simulate(pairs.dense.edge_edge.view(), c, by_warps);
        pairs.dense.multiply_add(pairs.exec, view_of(c), view_of(by_loops));
        const Eigen::VectorXd expected = to_eigen(by_modes);
        EXPECT_LT((to_eigen(by_warps) - expected).norm(), 1e-14 * expected.norm());
        EXPECT_LT((to_eigen(by_loops) - expected).norm(), 1e-14 * expected.norm());
    }
}

template <class Exec>
class WarpProductOn : public testing::Test {
  public:
    Exec exec;
};
using Executors = testing::Types<SerialExec, CpuExec, ShuffledExec>;
TYPED_TEST_SUITE(WarpProductOn, Executors);

TYPED_TEST(WarpProductOn, MultiplyAddMatchesPlainProductsOfTheFourBuffers) {
    const RandomBlocks<6> pp(300, 50, 1);
    const RandomBlocks<9> pe(211, 50, 2);
    const RandomBlocks<12> pt(170, 50, 3);
    const RandomBlocks<12> ee(5, 50, 4);
    WarpProduct<TypeParam> product;
    const auto fill = [&](const auto& from, auto& to) {
        this->exec.upload(from.values, to.values);
        this->exec.upload(from.vertices, to.vertices);
    };
    fill(pp, product.point_point);
    fill(pe, product.point_edge);
    fill(pt, product.point_triangle);
    fill(ee, product.edge_edge);
    product.build_incidence(this->exec, 50);
    EXPECT_EQ(product.num_pairs(), 686);
    EXPECT_EQ(product.bytes(), 300 * 296U + 211 * 660U + 175 * 1168U);

    auto same_c = [&](auto blocks) {  // all four buffers times the same vector
        blocks.c = pp.c;
        return blocks.product();
    };
    std::vector<Vec3d> c(50);
    for (int i = 0; i < 150; ++i)
        c[static_cast<std::size_t>(i / 3)][i % 3] = pp.c[static_cast<std::size_t>(i)];
    auto y = random_vector(50, 9);
    const Eigen::VectorXd expected =
        to_eigen(y) + same_c(pp) + same_c(pe) + same_c(pt) + same_c(ee);
    product.multiply_add(this->exec, view_of(c), view_of(y));
    EXPECT_LT((to_eigen(y) - expected).norm(), 1e-14 * expected.norm());
}

TYPED_TEST(WarpProductOn, WithoutPairsNothingIsAdded) {
    WarpProduct<TypeParam> product;
    product.build_incidence(this->exec, 3);
    const auto c = random_vector(3, 1);
    auto y = c;
    product.multiply_add(this->exec, view_of(c), view_of(y));
    EXPECT_TRUE(same_bits(c, y));
}

}  // namespace
}  // namespace noli
