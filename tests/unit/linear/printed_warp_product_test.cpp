// SPDX-License-Identifier: Apache-2.0
/// What Algorithm 1 does as printed, and which line each failure comes from.

#include "printed_warp_product.hpp"

#include "dense_blocks.hpp"
#include "random_system.hpp"

#include <cmath>

namespace noli {
namespace {

using namespace test;

/// Every line corrected that print leaves wrong, for whole warps.
constexpr PrintedReading kCorrected{.row_corrected = true, .address_corrected = true};

template <class Size>
class PrintedAlgorithm1 : public testing::Test {
  public:
    static constexpr int kSize = Size::value;
    // 64 blocks: m^2 * 64 is a multiple of 32, so that no warp is partial.
    RandomBlocks<kSize> whole_warps{64, 70, 1};

    PrintedRun run(PrintedReading reading, int threads = 256) const {
        return PrintedWarpProduct<kSize>(
                   whole_warps.view(), whole_warps.c_view(), reading)
            .run(threads);
    }
    double error(PrintedReading reading, int threads = 256) const {
        return relative_error(run(reading, threads).y, whole_warps.product());
    }
};
template <int m>
using Size = std::integral_constant<int, m>;
using Sizes = testing::Types<Size<6>, Size<9>, Size<12>>;
TYPED_TEST_SUITE(PrintedAlgorithm1, Sizes);

TYPED_TEST(PrintedAlgorithm1, IsRightOnWholeWarpsOnceRowAddressAndIndicesAreCorrected) {
    for (int threads = 32; threads <= 1024; threads += 32)
        EXPECT_LT(this->error(kCorrected, threads), 1e-14) << threads;
}

TYPED_TEST(PrintedAlgorithm1, RowIndexLeavesTheBlockForEveryThreadButTheFirst) {
    PrintedReading reading = kCorrected;
    reading.row_corrected = false;
    const PrintedRun run = this->run(reading);
    const int num_entries = this->whole_warps.view().values.size;
    EXPECT_EQ(run.loads_outside_block, num_entries - 1);
    EXPECT_GT(run.loads_outside_buffer, num_entries / 2);
    EXPECT_GT(this->error(reading), 0.1);
}

TYPED_TEST(PrintedAlgorithm1, OffsetIsUnsetInAllThreadBlocksButOneIfThreadIdIsGlobal) {
    PrintedReading reading = kCorrected;
    reading.offset_id = ThreadId::InGrid;
    constexpr int m = TypeParam::value;
    for (int stale = 0; stale < 2 * m; ++stale) {
        reading.stale_offset = stale;
        if (stale % m == 0)
            EXPECT_LT(this->error(reading), 1e-14) << "right by luck: " << stale;
        else
            EXPECT_GT(this->error(reading), 0.1) << stale;
    }
}

TYPED_TEST(PrintedAlgorithm1, MultipliesTheSameBlocksAgainIfThreadIdIsLocal) {
    PrintedReading reading = kCorrected;
    reading.entry_id = ThreadId::InThreadBlock;
    EXPECT_GT(this->error(reading), 0.1);
    const int one_thread_block = this->whole_warps.view().values.size;
    EXPECT_LT(this->error(reading, one_thread_block), 1e-14);
}

TYPED_TEST(PrintedAlgorithm1, AddsAtTheColumnsVertexForWantOfAnother) {
    PrintedReading reading = kCorrected;
    reading.address_corrected = false;
    EXPECT_GT(this->error(reading), 0.1);
}

TYPED_TEST(PrintedAlgorithm1, PartialLastWarpReadsPastTheBuffersWithoutAGuard) {
    constexpr int m = TypeParam::value;
    const RandomBlocks<m> blocks(33, 40, 2);  // 33 m^2 is no multiple of 256
    const PrintedRun run =
        PrintedWarpProduct<m>(blocks.view(), blocks.c_view(), kCorrected).run(256);
    EXPECT_EQ(run.loads_outside_buffer, 256 - 33 * m * m % 256);
}

TYPED_TEST(PrintedAlgorithm1, PartialLastWarpShufflesFromLanesThatHaveReturned) {
    constexpr int m = TypeParam::value;
    PrintedReading reading = kCorrected;
    reading.guarded = true;
    const RandomBlocks<m> blocks(33, 40, 2);
    ASSERT_NE(33 * m * m % 32, 0);
    const PrintedRun run =
        PrintedWarpProduct<m>(blocks.view(), blocks.c_view(), reading).run(256);
    EXPECT_EQ(run.loads_outside_buffer, 0);
    int undefined = 0;
    for (const double y : run.y)
        undefined += std::isnan(y) ? 1 : 0;
    EXPECT_EQ(undefined, 1);  // the last row's sum; all other rows are whole

    std::vector<double> y(blocks.c.size(), 0.0);
    simulate_warp_product(
        blocks.view(), blocks.all_entries(), 256, blocks.c_view(), view_of(y));
    EXPECT_LT(relative_error(y, blocks.product()), 1e-14);
}

TYPED_TEST(PrintedAlgorithm1, AsPrintedIsWrongUnderEveryReadingOfThreadId) {
    for (const ThreadId entry : {ThreadId::InGrid, ThreadId::InThreadBlock})
        for (const ThreadId offset : {ThreadId::InGrid, ThreadId::InThreadBlock})
            for (const int stale : {0, 1})
                EXPECT_GT(
                    this->error(
                        {.entry_id = entry, .offset_id = offset, .stale_offset = stale}),
                    0.1);
}

TYPED_TEST(PrintedAlgorithm1, OffsetMarksTheSameBoundariesAsTheColumnDoes) {
    constexpr int m = TypeParam::value;
    for (int threads = 32; threads <= 1024; threads += 32) {
        const PrintedRun run = this->run(kCorrected, threads);
        for (int i = 0; i < this->whole_warps.view().values.size; ++i) {
            const bool ours =
                warp_entry<m>(static_cast<std::uint32_t>(i), ~0U, i % 32).boundary;
            ASSERT_EQ(run.boundary[static_cast<std::size_t>(i)], ours)
                << "thread " << i << " of " << threads;
        }
    }
}

TYPED_TEST(PrintedAlgorithm1, ClampHidesTheUndefinedShiftBy32) {
    PrintedReading wraps = kCorrected;
    wraps.warp_shift_bits = 32;  // as x86 does: by 32 is by 0
    EXPECT_EQ(this->run(wraps).interval, this->run(kCorrected).interval);
    EXPECT_LT(this->error(wraps), 1e-14);
}

}  // namespace
}  // namespace noli
