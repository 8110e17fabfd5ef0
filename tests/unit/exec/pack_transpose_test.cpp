// SPDX-License-Identifier: Apache-2.0
#include "core/pack_transpose.hpp"

#include "exec/lanes.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace noli {
namespace {

/// Packs with 10 k + j in lane j of row k.
struct TransposeKernel {
    double* out;
    int stride;

    template <int W>
    void operator()(Lane<Pack<W>> /*lane*/) const {
        Pack<W> rows[8];
        for (int k = 0; k < 8; ++k)
            for (int j = 0; j < W; ++j)
                rows[k].set(j, 10.0 * k + j);
        store_transposed(rows, out, stride);
    }
};

TEST(PackTranspose, PutsTheValuesOfALaneTogether) {
    constexpr int kStride = 11;
    for (const auto& [dispatch, width] : {std::pair{LaneDispatch::Width2, 2},
                                          std::pair{LaneDispatch::Width4, 4},
                                          std::pair{LaneDispatch::Width8, 8}}) {
        if (dispatch > lane_dispatch()) continue;
        double out[8 * kStride];
        std::fill(std::begin(out), std::end(out), -1.0);
        call_with_packs(dispatch, TransposeKernel{out, kStride});
        for (int j = 0; j < 8; ++j)
            for (int k = 0; k < kStride; ++k)
                EXPECT_EQ(out[kStride * j + k], j < width && k < 8 ? 10.0 * k + j : -1.0)
                    << width << ' ' << j << ' ' << k;
    }
}

}  // namespace
}  // namespace noli
