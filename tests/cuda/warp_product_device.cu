// SPDX-License-Identifier: Apache-2.0
#include "linear/warp_product.cuh"
#include "warp_product_device.hpp"

namespace noli::test {

bool has_cuda_device() {
    int count = 0;
    const bool found = cudaGetDeviceCount(&count) == cudaSuccess && count > 0;
    cudaGetLastError();  // forget that there is none
    return found;
}

template <int m>
std::vector<double> warp_product_on_device(const DenseBlockView<m>& blocks,
                                           EntryRange range,
                                           int threads_per_block,
                                           View<const double> c,
                                           const std::vector<double>& y) {
    CudaExec exec;
    CudaBuffer<double> values, c_device, y_device;
    CudaBuffer<int> vertices;
    const auto upload = [&](const auto& from, auto& to) {
        exec.upload(std::vector(from.begin(), from.end()), to);
    };
    upload(blocks.values, values);
    upload(blocks.vertices, vertices);
    upload(c, c_device);
    upload(y, y_device);
    launch_warp_product<m, 3>({values.view(), vertices.view()},
                              range,
                              threads_per_block,
                              c_device.view(),
                              y_device.view());
    std::vector<double> out;
    exec.download(View<const double>(y_device.view()), out);
    return out;
}

template std::vector<double> warp_product_on_device(const DenseBlockView<6>&,
                                                    EntryRange,
                                                    int,
                                                    View<const double>,
                                                    const std::vector<double>&);
template std::vector<double> warp_product_on_device(const DenseBlockView<9>&,
                                                    EntryRange,
                                                    int,
                                                    View<const double>,
                                                    const std::vector<double>&);
template std::vector<double> warp_product_on_device(const DenseBlockView<12>&,
                                                    EntryRange,
                                                    int,
                                                    View<const double>,
                                                    const std::vector<double>&);

}  // namespace noli::test
