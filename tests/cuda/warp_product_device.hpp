// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The kernel of linear/warp_product.cuh behind a face that needs no CUDA compiler.

#include "linear/warp_product.hpp"

#include <vector>

namespace noli::test {

/// False without a driver or without a GPU.
bool has_cuda_device();

/// y + H c over the entries of `range`, computed on the GPU from data in host memory.
template <int m>
std::vector<double> warp_product_on_device(const DenseBlockView<m>& blocks,
                                           EntryRange range,
                                           int threads_per_block,
                                           View<const double> c,
                                           const std::vector<double>& y);

}  // namespace noli::test
