// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A warp on the host: 32 lanes in lockstep, with CUDA's rules for what lanes exchange.
///
/// A text for a warp is written for all lanes at once. What differs by lane is a
/// Warp::Register, made by each() and read by at(): one value per thread on a GPU
/// (exec/cuda_warp.cuh), 32 values here.

#include "core/device.hpp"

#include <cstdint>
#include <limits>

namespace noli {

inline constexpr int kWarpLanes = 32;

struct SimulatedWarp {
    template <class T>
    struct Register {
        T lane[kWarpLanes];
    };
    std::uint32_t active = ~std::uint32_t{0};  ///< lanes that have not returned
    int* num_writes = nullptr;                 ///< counts the additions, if given

    template <class F>
    NOLI_HD auto each(F f) const {
        Register<decltype(f(0))> out{};
        for (int lane = 0; lane < kWarpLanes; ++lane)
            if (is_active(lane)) out.lane[lane] = f(lane);
        return out;
    }
    template <class F>
    NOLI_HD void run(F f) const {
        for (int lane = 0; lane < kWarpLanes; ++lane)
            if (is_active(lane)) f(lane);
    }
    template <class T>
    NOLI_HD static const T& at(const Register<T>& r, int lane) {
        return r.lane[lane];
    }
    /// Bit l says what f(l) is; 0 for lanes that have returned.
    template <class F>
    NOLI_HD std::uint32_t ballot(F f) const {
        std::uint32_t bits = 0;
        for (int lane = 0; lane < kWarpLanes; ++lane)
            if (is_active(lane) && f(lane)) bits |= std::uint32_t{1} << lane;
        return bits;
    }
    /// Lane l gets the value of lane l + delta, its own where there is no such lane, and
    /// NaN from a lane that has returned (undefined on a GPU).
    [[nodiscard]] NOLI_HD Register<double> shuffle_down(const Register<double>& r,
                                                        int delta) const {
        Register<double> out{};
        for (int lane = 0; lane < kWarpLanes; ++lane) {
            const int from = lane + delta < kWarpLanes ? lane + delta : lane;
            out.lane[lane] =
                is_active(from) ? r.lane[from] : std::numeric_limits<double>::quiet_NaN();
        }
        return out;
    }
    NOLI_HD void add(double& to, double amount) const {
        to += amount;
        if (num_writes != nullptr) ++*num_writes;
    }
    [[nodiscard]] NOLI_HD bool is_active(int lane) const {
        return ((active >> lane) & 1U) != 0;
    }
};

}  // namespace noli
