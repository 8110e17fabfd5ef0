// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The sums of one block of elements while they are in the first-level cache: adding
/// elements to them, moving them to the matrix. See linear/element_sums.hpp.
///
/// Everything is added number by number in a fixed order, so pack widths agree bitwise.
/// CPU only.

#include "core/pack_transpose.hpp"
#include "core/vec.hpp"
#include "core/view.hpp"
#include "linear/element_sums.hpp"

#include <algorithm>
#include <cstddef>

namespace noli::detail {

/// Upper blocks of kElementGroup elements, the numbers of an element together.
struct GroupBlocks {
    alignas(64) double head[kElementGroup][kBlocksPerElement][8];
    alignas(64) double tail[kBlocksPerElement][kElementGroup];
};

template <int W>
inline void store_numbers(const Pack<W> (&head)[8],
                          const Pack<W>& tail,
                          int slot,
                          int first,
                          GroupBlocks& out) {
    store_transposed(head, &out.head[first][slot][0], kBlocksPerElement * 8);
    store_pack<W>(&out.tail[slot][first], tail);
}

/// Block of vertices a and b of elements first, first + 1 ...; where `turned`, b has the
/// smaller number and the matrix wants the transposed block.
template <int W>
inline void store_off_diagonal(const Mat3<Pack<W>>& m,
                               typename Pack<W>::Mask turned,
                               int slot,
                               int first,
                               GroupBlocks& out) {
    const Pack<W> head[8] = {m.a[0],
                             select(turned, m.a[3], m.a[1]),
                             select(turned, m.a[6], m.a[2]),
                             select(turned, m.a[1], m.a[3]),
                             m.a[4],
                             select(turned, m.a[7], m.a[5]),
                             select(turned, m.a[2], m.a[6]),
                             select(turned, m.a[5], m.a[7])};
    store_numbers<W>(head, m.a[8], slot, first, out);
}

/// Symmetric block of one vertex, with its gradient.
template <int W>
inline void store_diagonal(const Mat3<Pack<W>>& m,
                           const Vec3<Pack<W>>& gradient,
                           int slot,
                           int first,
                           GroupBlocks& out) {
    const Pack<W> head[8] = {
        m.a[0], m.a[1], m.a[2], m.a[4], m.a[5], m.a[8], gradient.x, gradient.y};
    store_numbers<W>(head, gradient.z, slot, first, out);
}

/// Sums of one block of elements.
struct LocalSums {
    double (*head)[8];  ///< 64-byte aligned
    double* tail;
};

template <int W>
inline void set_zero(const LocalSums& sums, int count) {
    for (int s = 0; s < count; ++s) {
        for (int k = 0; k < 8; k += W)
            store_pack<W>(&sums.head[s][k], Pack<W>(0.0));
        sums.tail[s] = 0.0;
    }
}

/// Adds the first `count` elements of a group, one after the other.
template <int W>
inline void add_elements(const GroupBlocks& group,
                         const std::uint16_t* slot,
                         int count,
                         const LocalSums& sums) {
    for (int j = 0; j < count; ++j, slot += kBlocksPerElement)
        for (int b = 0; b < kBlocksPerElement; ++b) {
            double* head = sums.head[slot[b]];
            for (int k = 0; k < 8; k += W)
                store_pack<W>(
                    head + k,
                    load_pack<W>(head + k) + load_pack<W>(&group.head[j][b][k]));
            sums.tail[slot[b]] += group.tail[b][j];
        }
}

/// What sums are moved to.
struct SumOutput {
    Mat3d* values;           ///< of the matrix
    const double* diagonal;  ///< per row: multiple of the identity to add
    Vec3d* gradient;         ///< per row, added to; or null
};

inline constexpr int kToRead = 0;
inline constexpr int kToWrite = 1;

/// Asks for all cache lines of an object.
template <std::size_t kBytes, int kUse>
inline void prefetch_bytes(const void* object) {
    constexpr std::size_t kLine = 64;
    const char* at = static_cast<const char*>(object);
    for (std::size_t k = 0; k < kBytes; k += kLine)
        __builtin_prefetch(at + k, kUse);
    __builtin_prefetch(at + kBytes - 1, kUse);
}

/// Asks for what sums [begin, end) of a block will be moved to.
inline void prefetch_targets(const int* kind_begin,
                             const SumTarget* target,
                             int begin,
                             int end,
                             const SumOutput& out) {
    constexpr auto kBytes = sizeof(Mat3d);
    for (int s = begin; s < end; ++s)
        prefetch_bytes<kBytes, kToWrite>(&out.values[target[s].upper]);
    const int mirrored_begin = kind_begin[sum_kind::kOffDiagonal] - kind_begin[0];
    const int mirrored_end =
        kind_begin[sum_kind::kOffDiagonal + sum_kind::kStays] - kind_begin[0];
    for (int s = std::max(begin, mirrored_begin); s < std::min(end, mirrored_end); ++s)
        prefetch_bytes<kBytes, kToWrite>(&out.values[target[s].other]);
}

template <int W>
inline void store_transposed_head(const double* head, double* to) {
    if constexpr (W == 8) {
        const auto v = load_pack<8>(head).v;
        store_pack<8>(
            to, Pack<8>::from(__builtin_shufflevector(v, v, 0, 3, 6, 1, 4, 7, 2, 5)));
    } else if constexpr (W == 4) {
        const auto a = load_pack<4>(head).v;
        const auto b = load_pack<4>(head + 4).v;
        store_pack<4>(to, Pack<4>::from(__builtin_shufflevector(a, b, 0, 3, 6, 1)));
        store_pack<4>(to + 4, Pack<4>::from(__builtin_shufflevector(a, b, 4, 7, 2, 5)));
    } else {
        for (int k = 0; k < 8; ++k)
            to[k] = head[k % 3 * 3 + k / 3];
    }
}

template <int W, int kKind>
inline void move_off_diagonal(double* head,
                              double tail,
                              SumTarget target,
                              const SumOutput& out) {
    double* upper = out.values[target.upper].a;
    for (int k = 0; k < 8; k += W) {
        Pack<W> part = load_pack<W>(head + k);
        if constexpr ((kKind & sum_kind::kAdds) != 0) part += load_pack<W>(upper + k);
        store_pack<W>(upper + k, part);
        store_pack<W>(head + k, part);
    }
    if constexpr ((kKind & sum_kind::kAdds) != 0) tail += upper[8];
    upper[8] = tail;
    if constexpr ((kKind & sum_kind::kStays) == 0) {
        double* lower = out.values[target.other].a;
        store_transposed_head<W>(head, lower);
        lower[8] = tail;
    }
}

template <int kKind>
inline void move_diagonal(const double* head,
                          double tail,
                          SumTarget target,
                          const SumOutput& out) {
    double* to = out.values[target.upper].a;
    double m[6] = {head[0], head[1], head[2], head[3], head[4], head[5]};
    if constexpr ((kKind & sum_kind::kAdds) != 0) {
        constexpr int kPlace[6] = {0, 1, 2, 4, 5, 8};
        for (int k = 0; k < 6; ++k)
            m[k] += to[kPlace[k]];
    }
    if constexpr ((kKind & sum_kind::kStays) == 0) {
        const double d = out.diagonal[target.other];
        m[0] += d;
        m[3] += d;
        m[5] += d;
    }
    out.values[target.upper] = {m[0], m[1], m[2], m[1], m[3], m[4], m[2], m[4], m[5]};
    if (out.gradient != nullptr)
        out.gradient[target.other] += Vec3d{head[6], head[7], tail};
}

/// Moves the sums of one kind; `begin` and `end` count in `target`, sums from `first` on.
template <int W, int kKind>
inline void move_kind(const LocalSums& sums,
                      const SumTarget* target,
                      int begin,
                      int end,
                      const SumOutput& out) {
    for (int s = begin; s < end; ++s) {
        if constexpr ((kKind & sum_kind::kOffDiagonal) != 0)
            move_off_diagonal<W, kKind>(sums.head[s], sums.tail[s], target[s], out);
        else
            move_diagonal<kKind>(sums.head[s], sums.tail[s], target[s], out);
    }
}

/// Moves all sums of a block. `kind_begin` (9) and `target` are those of the block.
template <int W>
inline void move_sums(const LocalSums& sums,
                      const int* kind_begin,
                      const SumTarget* target,
                      const SumOutput& out) {
    const int* k = kind_begin;
    const auto end = [k](int kind) { return k[kind] - k[0]; };
    move_kind<W, 0>(sums, target, end(0), end(1), out);
    move_kind<W, 1>(sums, target, end(1), end(2), out);
    move_kind<W, 2>(sums, target, end(2), end(3), out);
    move_kind<W, 3>(sums, target, end(3), end(4), out);
    move_kind<W, 4>(sums, target, end(4), end(5), out);
    move_kind<W, 5>(sums, target, end(5), end(6), out);
    move_kind<W, 6>(sums, target, end(6), end(7), out);
    move_kind<W, 7>(sums, target, end(7), end(8), out);
}

}  // namespace noli::detail
