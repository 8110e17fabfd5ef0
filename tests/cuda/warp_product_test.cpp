// SPDX-License-Identifier: Apache-2.0
#include "unit/linear/dense_blocks.hpp"
#include "warp_product_device.hpp"

namespace noli {
namespace {

using namespace test;

template <class Size>
class WarpProductOnDevice : public testing::Test {
  protected:
    void SetUp() override {
        if (!has_cuda_device()) GTEST_SKIP() << "no CUDA device";
    }
};
template <int m>
using Size = std::integral_constant<int, m>;
using Sizes = testing::Types<Size<6>, Size<9>, Size<12>>;
TYPED_TEST_SUITE(WarpProductOnDevice, Sizes);

TYPED_TEST(WarpProductOnDevice, MatchesPlainProductForEveryThreadBlockSize) {
    for (const int num_blocks : {1, 33, 64, 1000}) {
        const RandomBlocks<TypeParam::value> blocks(num_blocks, 90, 1);
        const std::vector<double> ones(blocks.c.size(), 1.0);
        const Eigen::VectorXd expected =
            blocks.product() + Eigen::VectorXd::Ones(blocks.product().size());
        for (int threads = 32; threads <= 1024; threads += 32)
            EXPECT_LT(relative_error(warp_product_on_device(blocks.view(),
                                                            blocks.all_entries(),
                                                            threads,
                                                            blocks.c_view(),
                                                            ones),
                                     expected),
                      1e-14)
                << num_blocks << " blocks, " << threads << " threads";
    }
}

TYPED_TEST(WarpProductOnDevice, MatchesPlainProductFromAndToAnyEntry) {
    constexpr std::uint32_t m = TypeParam::value;
    const RandomBlocks<TypeParam::value> blocks(5, 12, 7);
    const std::vector<double> zeros(blocks.c.size(), 0.0);
    for (std::uint32_t begin = 0; begin <= m; ++begin)
        for (std::uint32_t length = 1; length < 2 * m * m; length += 7) {
            const EntryRange range{begin, begin + length};
            ASSERT_LT(
                relative_error(warp_product_on_device(
                                   blocks.view(), range, 64, blocks.c_view(), zeros),
                               blocks.product(range)),
                1e-14)
                << "entries " << begin << " to " << begin + length;
        }
}

}  // namespace
}  // namespace noli
