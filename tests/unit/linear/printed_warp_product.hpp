// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Algorithm 1 of the supplement as it is printed, run lane by lane, with one switch for
/// each thing that print leaves wrong or open. Only tests use it.

#include "linear/warp_product.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace noli::test {

/// Which of the two indices of a thread a `thread_id` of the listing means.
enum class ThreadId { InGrid, InThreadBlock };

/// Defaults: the reading that comes nearest to working, with no line corrected.
struct PrintedReading {
    ThreadId entry_id = ThreadId::InGrid;          ///< in H_id, R_id, C_id, e_id
    ThreadId offset_id = ThreadId::InThreadBlock;  ///< in `if thread_id == 0`, B_id, l_id
    bool row_corrected = false;                    ///< R_id <- (thread_id mod H_dims) / m
    bool address_corrected = false;  ///< add at the row's vertex, not at v_id, vc_id
    bool guarded = false;            ///< threads past the last entry return at once
    int stale_offset = 1;            ///< what `offset` holds where nobody has set it
    int warp_shift_bits =
        64;  ///< `<<` by n shifts by n mod this: 64 gives 0, as PTX does
};

struct PrintedRun {
    std::vector<double> y;
    int loads_outside_block = 0;   ///< of H, by threads that own an entry
    int loads_outside_buffer = 0;  ///< of H, by any thread; they read 0 here
    std::vector<bool> boundary;    ///< per thread
    std::vector<int> interval;     ///< per thread
};

/// One thread's variables; H of size m x m on vertices of three components.
struct PrintedThread {
    int H_id, R_id, C_id, v_id, vc_id, e_id, w_id;
    bool returned;
    double r;
};

template <int m>
class PrintedWarpProduct {
  public:
    PrintedWarpProduct(const DenseBlockView<m>& blocks,
                       View<const double> c,
                       PrintedReading reading)
        : blocks_(blocks), c_(c), reading_(reading) {}

    /// y = H c by thread blocks of threads_per_block, a multiple of 32.
    PrintedRun run(int threads_per_block) {
        out_ = {};
        out_.y.assign(static_cast<std::size_t>(c_.size), 0.0);
        const int total = blocks_.values.size;
        for (int begin = 0; begin < total; begin += threads_per_block)
            run_thread_block(begin, threads_per_block);
        return out_;
    }

  private:
    void run_thread_block(int begin, int threads_per_block) {
        int offset = reading_.stale_offset;  // `shared offset`
        std::vector<PrintedThread> threads;
        for (int t = 0; t < threads_per_block; ++t) {
            threads.push_back(start(pick(reading_.entry_id, begin, t), t, begin));
            if (pick(reading_.offset_id, begin, t) == 0) offset = m - threads.back().e_id;
        }
        for (int t = 0; t < threads_per_block; t += kWarpLanes)
            run_warp(threads.data() + t, begin, t, offset);
    }

    static int pick(ThreadId id, int begin, int t) {
        return id == ThreadId::InGrid ? begin + t : t;
    }

    PrintedThread start(int thread_id, int in_block, int begin) {
        constexpr int H_dims = m * m;
        PrintedThread p{};
        p.returned = reading_.guarded && begin + in_block >= blocks_.values.size;
        p.H_id = thread_id / H_dims;
        p.R_id = reading_.row_corrected ? thread_id % H_dims / m : thread_id * H_dims / m;
        p.C_id = thread_id % H_dims % m;
        p.v_id = p.C_id / 3;
        p.vc_id = p.C_id % 3;
        p.e_id = thread_id % m;
        p.w_id = in_block % kWarpLanes;
        if (!p.returned) p.r = load(p, begin + in_block < blocks_.values.size);
        return p;
    }

    /// c * h; 0 where h lies outside the buffer.
    double load(const PrintedThread& p, bool owns_entry) {
        if (owns_entry && p.R_id >= m) ++out_.loads_outside_block;
        const std::ptrdiff_t at =
            (static_cast<std::ptrdiff_t>(p.H_id) * m + p.R_id) * m + p.C_id;
        if (at >= blocks_.values.size || p.H_id >= blocks_.num_blocks()) {
            ++out_.loads_outside_buffer;
            return 0.0;
        }
        const int vertex = blocks_.vertices[m / 3 * p.H_id + p.v_id];
        return blocks_.values[static_cast<int>(at)] * c_[3 * vertex + p.vc_id];
    }

    void run_warp(const PrintedThread* lanes, int begin, int first, int offset) {
        SimulatedWarp warp{.active = 0};
        for (int lane = 0; lane < kWarpLanes; ++lane)
            if (!lanes[lane].returned) warp.active |= std::uint32_t{1} << lane;
        const auto is_boundary = warp.each([&](int lane) {
            const int thread_id = pick(reading_.offset_id, begin, first + lane);
            const int B_id = (thread_id - offset + m) / m;
            int l_id = (thread_id - offset) % m;
            if (B_id == 0) l_id = thread_id;
            return l_id == 0 || lanes[lane].w_id == 0;
        });
        const std::uint32_t mark =
            reverse_bits(warp.ballot([&](int l) { return is_boundary.lane[l]; }));
        const auto interval = warp.each([&](int lane) {
            const int w_id = lanes[lane].w_id;
            return std::min(leading_zeros(shift(mark, w_id + 1)), 31 - w_id);
        });
        auto r = warp.each([&](int lane) { return lanes[lane].r; });
        for (int iter = 1; iter < m; iter <<= 1) {
            const auto tmp = warp.shuffle_down(r, iter);
            warp.run([&](int lane) {
                if (interval.lane[lane] >= iter) r.lane[lane] += tmp.lane[lane];
            });
        }
        warp.run([&](int lane) {
            if (is_boundary.lane[lane]) add_to_output(lanes[lane], r.lane[lane]);
        });
        for (int lane = 0; lane < kWarpLanes; ++lane) {
            out_.boundary.push_back(is_boundary.lane[lane]);
            out_.interval.push_back(interval.lane[lane]);
        }
    }

    [[nodiscard]] std::uint32_t shift(std::uint32_t bits, int n) const {
        n %= reading_.warp_shift_bits;
        return n > 31 ? 0 : bits << n;
    }

    void add_to_output(const PrintedThread& p, double r) {
        const int local = reading_.address_corrected ? p.R_id : 3 * p.v_id + p.vc_id;
        if (local >= m || p.H_id >= blocks_.num_blocks()) return;  // no such vertex
        out_.y[static_cast<std::size_t>(blocks_.global_index(p.H_id, local))] += r;
    }

    DenseBlockView<m> blocks_;
    View<const double> c_;
    PrintedReading reading_;
    PrintedRun out_;
};

}  // namespace noli::test
