// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The two loops that say what the memory gives: a pure read and the STREAM triad. They
/// run through the library's executor, with the same threads and pack width as its
/// products, so that one can be given in percent of the other.

#include "core/view.hpp"
#include "exec/cpu.hpp"

#include <cstddef>
#include <cstring>
#include <type_traits>
#include <vector>

namespace noli::bench {

/// Doubles that one element of a loop stands for: 1 KB.
inline constexpr int kPiece = 128;

/// `to` <- sizeof(T) / 8 doubles; unaligned.
template <class T>
T load(const double* from) {
    if constexpr (std::is_same_v<T, double>) {
        return *from;
    } else {
        typename T::Raw raw;
        std::memcpy(&raw, from, sizeof(raw));
        return T::from(raw);
    }
}

/// Adds up each piece; the sums are written so that nothing is optimised away.
struct ReadKernel {
    const double* data;
    double* sums;  ///< one per piece

    template <class T>
    void operator()(Lane<T> lane) const {
        constexpr int kWidth = sizeof(T) / sizeof(double);
        const double* from = data + static_cast<std::ptrdiff_t>(lane.first) * kPiece;
        T acc[4] = {0.0, 0.0, 0.0, 0.0};
        for (int k = 0; k < kWidth * kPiece; k += 4 * kWidth)
            for (int j = 0; j < 4; ++j)
                acc[j] += load<T>(from + k + j * kWidth);
        const T sum = (acc[0] + acc[1]) + (acc[2] + acc[3]);
        if constexpr (kWidth == 1)
            sums[lane.first] = sum;
        else
            sums[lane.first] = sum[0];
    }
};

/// a = b + s c
struct TriadKernel {
    double* a;
    const double* b;
    const double* c;
    double s;

    template <class T>
    void operator()(Lane<T> lane) const {
        constexpr int kWidth = sizeof(T) / sizeof(double);
        const std::ptrdiff_t begin = static_cast<std::ptrdiff_t>(lane.first) * kPiece;
        for (std::ptrdiff_t k = begin; k < begin + kWidth * kPiece; k += kWidth) {
            const T sum = load<T>(b + k) + s * load<T>(c + k);
            std::memcpy(a + k, &sum, sizeof(T));
        }
    }
};

/// Reads an array again and again.
class Reader {
  public:
    /// Whole pieces of the `bytes` at `data`.
    Reader(const void* data, std::size_t bytes)
        : data_(static_cast<const double*>(data)),
          sums_(bytes / (kPiece * sizeof(double))) {}

    void read(CpuExec& exec) {
        exec.for_lanes("bench/read", num_pieces(), ReadKernel{data_, sums_.data()});
    }
    /// Bytes that read() reads.
    [[nodiscard]] double bytes() const { return 8.0 * kPiece * num_pieces(); }

  private:
    [[nodiscard]] int num_pieces() const { return static_cast<int>(sums_.size()); }

    const double* data_;
    std::vector<double> sums_;
};

}  // namespace noli::bench
