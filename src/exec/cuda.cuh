// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The CUDA executor: the same interface as exec/cpu.hpp on one GPU. All kernels of
/// the simulator are launched here. Reductions use a fixed partition, and no loop but
/// for_warps (exec/cuda_warp.cuh) adds numbers atomically, so results repeat bitwise on
/// one kind of device.

#include "core/view.hpp"
#include "exec/cuda_kernels.cuh"
#include "exec/cuda_memory.cuh"
#include "exec/cuda_warp.cuh"
#include "exec/later.hpp"

#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>

#include <cstddef>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

namespace noli {

namespace detail {

/// Results of blocks between the levels of a reduction.
struct ReduceScratch {
    CudaBuffer<double> one, other;

    /// For reductions of up to n items.
    void reserve(int n) {
        one.resize(reduce_blocks(n));
        other.resize(reduce_blocks(reduce_blocks(n)));
    }
};

}  // namespace detail

/// Loops as a CUDA graph: one launch runs them all.
class CudaRecording {
  public:
    CudaRecording() = default;
    ~CudaRecording() { clear(); }
    CudaRecording(const CudaRecording&) = delete;
    CudaRecording& operator=(const CudaRecording&) = delete;

  private:
    friend class CudaExec;
    void clear() {
        if (graph_ != nullptr) cudaGraphExecDestroy(graph_);
        graph_ = nullptr;
    }

    cudaGraphExec_t graph_ = nullptr;
    int launches_ = 0;
    detail::ReduceScratch scratch_;  // the graph holds its addresses
};

/// What a CudaExec has done so far, for the benchmark.
struct CudaCounts {
    long launches = 0;   ///< of kernels
    long waits = 0;      ///< of the host for the device
    long bus_bytes = 0;  ///< between host and device
};

/// Runs kernels on one CUDA stream.
class CudaExec : public LaterNumbers<CudaExec, CudaBuffer<double>> {
  public:
    template <class T>
    using Buffer = CudaBuffer<T>;
    template <class T>
    using Arrival = CudaArrival<T>;
    using Recording = CudaRecording;
    static constexpr bool kIsDevice = true;

    CudaExec() {
        check_cuda(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking),
                   "create stream");
    }
    ~CudaExec() {
        cudaStreamSynchronize(stream_);
        cudaStreamDestroy(stream_);
    }
    CudaExec(const CudaExec&) = delete;
    CudaExec& operator=(const CudaExec&) = delete;

    template <class F>
    void for_each(const char* name, int n, F f, int /*grain*/ = 0) {
        if (n == 0) return;
        constexpr int kBlock = detail::kLoopThreads;
        detail::run_kernel<<<(n - 1) / kBlock + 1, kBlock, 0, stream_>>>(n, f);
        launched(name);
    }

    template <class F>
    void for_lanes(const char* name, int n, F f) {
        if (n == 0) return;
        constexpr int kBlock = detail::kLaneThreads;
        detail::run_lane_kernel<<<(n - 1) / kBlock + 1, kBlock, 0, stream_>>>(n, f);
        launched(name);
    }

    template <class F>
    void for_warps(const char* name, std::uint32_t n, F f) {
        if (n == 0) return;
        constexpr std::uint32_t kBlock = detail::kWarpThreads;
        detail::run_warp_kernel<<<(n - 1) / kBlock + 1, kBlock, 0, stream_>>>(f);
        launched(name);
    }

    template <class F, class G>
    void sum_then(const char* name, int n, F f, G g, int /*grain*/ = 0) {
        reduce_then(name, n, 0.0, detail::Add{}, f, g);
    }

    template <class F, class G>
    void min_then(const char* name, int n, F f, G g) {
        constexpr double kNone = std::numeric_limits<double>::infinity();
        reduce_then(name, n, kNone, detail::Smaller{}, f, g);
    }

    /// Loops of f as a CUDA graph. f has run before, so that all its kernels are loaded
    /// and all its buffers have their size.
    template <class F>
    void record(CudaRecording& to, int longest, F f) {
        to.clear();
        to.scratch_.reserve(longest);
        const long before = counts_.launches;
        cudaGraph_t graph = nullptr;
        check_cuda(cudaStreamBeginCapture(stream_, cudaStreamCaptureModeRelaxed),
                   "begin to record");
        scratch_ = &to.scratch_;
        try {
            f();
        } catch (...) {
            scratch_ = &own_scratch_;
            cudaStreamEndCapture(stream_, &graph);
            if (graph != nullptr) cudaGraphDestroy(graph);
            throw;
        }
        scratch_ = &own_scratch_;
        check_cuda(cudaStreamEndCapture(stream_, &graph), "end to record");
        const cudaError_t made = cudaGraphInstantiate(&to.graph_, graph, 0);
        cudaGraphDestroy(graph);
        check_cuda(made, "make a graph of what was recorded");
        to.launches_ = static_cast<int>(counts_.launches - before);
        counts_.launches = before;
    }
    void replay(CudaRecording& from) {
        check_cuda(cudaGraphLaunch(from.graph_, stream_), "replay");
        counts_.launches += from.launches_;
    }

    void scan_then(const char* name,
                   View<const int> counts,
                   View<int> offsets,
                   double* total) {
        const int n = counts.size;
        if (n > 0) {
            std::size_t bytes = 0;
            const auto scan_with = [&](void* temp) {
                check_cuda(cub::DeviceScan::InclusiveSum(
                               temp, bytes, counts.data, offsets.data + 1, n, stream_),
                           name);
            };
            scan_with(nullptr);
            temp_.resize(static_cast<int>(bytes));
            scan_with(temp_.view().data);
            launched(name);
        }
        for_each(name, 1, detail::CloseScan{offsets.data, n, total});
    }

    template <class Key>
    void sort_by_key(const char* name, View<Key> keys, View<int> values) {
        const int n = keys.size;
        if (n < 2) return;
        sorted_keys_.resize(n * static_cast<int>(sizeof(Key)));
        sorted_values_.resize(n);
        const View<Key> sorted_keys{reinterpret_cast<Key*>(sorted_keys_.view().data), n};
        const View<int> sorted_values = sorted_values_.view();
        std::size_t bytes = 0;
        const auto sort_with = [&](void* temp) {
            check_cuda(cub::DeviceRadixSort::SortPairs(temp,
                                                       bytes,
                                                       keys.data,
                                                       sorted_keys.data,
                                                       values.data,
                                                       sorted_values.data,
                                                       n,
                                                       0,
                                                       static_cast<int>(8 * sizeof(Key)),
                                                       stream_),
                       name);
        };
        sort_with(nullptr);
        temp_.resize(static_cast<int>(bytes));
        sort_with(temp_.view().data);
        launched(name);
        copy(View<const Key>(sorted_keys), keys);
        copy(View<const int>(sorted_values), values);
    }

    template <class T>
    void upload(const std::vector<T>& from, CudaBuffer<T>& to) {
        to.resize(static_cast<int>(from.size()));
        if (from.empty()) return;
        move_bytes(
            to.view().data, from.data(), sizeof(T) * from.size(), cudaMemcpyHostToDevice);
    }
    template <class T>
    void download(View<const T> from, std::vector<T>& to) {
        to.resize(static_cast<std::size_t>(from.size));
        if (to.empty()) return;
        const std::size_t bytes = sizeof(T) * to.size();
        if (bytes > kPinnedBytes) {
            move_bytes(to.data(), from.data, bytes, cudaMemcpyDeviceToHost);
            return;
        }
        void* pinned = pinned_.resize(kPinnedBytes);
        move_bytes(pinned, from.data, bytes, cudaMemcpyDeviceToHost);
        std::memcpy(static_cast<void*>(to.data()), pinned, bytes);
    }
    /// A download that does not wait: see CudaArrival::take.
    template <class T>
    void start_download(View<const T> from, CudaArrival<T>& to) {
        to.start(from, stream_);
        counts_.bus_bytes += static_cast<long>(sizeof(T)) * static_cast<long>(from.size);
    }
    template <class T>
    void copy(View<const T> from, View<T> to) {
        if (from.size == 0) return;
        check_cuda(cudaMemcpyAsync(to.data,
                                   from.data,
                                   sizeof(T) * static_cast<std::size_t>(from.size),
                                   cudaMemcpyDeviceToDevice,
                                   stream_),
                   "copy");
    }
    template <class T>
    T read(View<const T> from, int i) {
        std::vector<T> host;
        download(View<const T>{from.data + i, 1}, host);
        return host[0];
    }

    /// Waits for all that was started.
    void wait() { synchronize("wait"); }
    [[nodiscard]] const CudaCounts& counts() const { return counts_; }

  private:
    static constexpr std::size_t kPinnedBytes = 8192;

    void launched(const char* name) {
        check_cuda(cudaGetLastError(), name);
        ++counts_.launches;
    }

    template <class Combine, class F, class Finish>
    void launch_reduce(
        const char* name, int n, double start, Combine combine, F f, Finish finish) {
        detail::reduce_kernel<<<detail::reduce_blocks(n),
                                detail::kReduceThreads,
                                0,
                                stream_>>>(n, start, combine, f, finish);
        launched(name);
    }

    /// Leaves at most kReduceChunk results in scratch_->one; returns how many.
    template <class Combine, class F>
    int reduce_to_one_chunk(const char* name, int n, double start, Combine combine, F f) {
        if (scratch_ == &own_scratch_) scratch_->reserve(n);
        int count = detail::reduce_blocks(n);
        launch_reduce(
            name, n, start, combine, f, detail::StoreItem{scratch_->one.view().data});
        while (count > detail::kReduceChunk) {
            launch_reduce(name,
                          count,
                          start,
                          combine,
                          detail::ReadItem{scratch_->one.view().data},
                          detail::StoreItem{scratch_->other.view().data});
            count = detail::reduce_blocks(count);
            copy(View<const double>{scratch_->other.view().data, count},
                 View<double>{scratch_->one.view().data, count});
        }
        return count;
    }

    template <class Combine, class F, class G>
    void reduce_then(const char* name, int n, double start, Combine combine, F f, G g) {
        const detail::CallWith<G> finish{g};
        if (detail::reduce_blocks(n) == 1) {
            launch_reduce(name, n, start, combine, f, finish);
            return;
        }
        const int count = reduce_to_one_chunk(name, n, start, combine, f);
        launch_reduce(name,
                      count,
                      start,
                      combine,
                      detail::ReadItem{scratch_->one.view().data},
                      finish);
    }

    void move_bytes(void* to, const void* from, std::size_t bytes, cudaMemcpyKind how) {
        const char* name = how == cudaMemcpyHostToDevice ? "upload" : "download";
        check_cuda(cudaMemcpyAsync(to, from, bytes, how, stream_), name);
        counts_.bus_bytes += static_cast<long>(bytes);
        synchronize(name);
    }

    void synchronize(const char* name) {
        check_cuda(cudaStreamSynchronize(stream_), name);
        ++counts_.waits;
    }

    cudaStream_t stream_ = nullptr;
    detail::ReduceScratch own_scratch_;
    detail::ReduceScratch* scratch_ = &own_scratch_;
    CudaBuffer<char> temp_, sorted_keys_;
    CudaBuffer<int> sorted_values_;
    CudaPinned pinned_;
    CudaCounts counts_;
};

}  // namespace noli
