// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Eight packs, one value of W elements each, as W rows of eight values, one element
/// each: from the order in which packs compute to the order in which memory holds a
/// block. Host only.

#include "core/pack.hpp"

#include <cstddef>
#include <cstring>

namespace noli {

template <int W>
inline Pack<W> load_pack(const double* from) {
    typename Pack<W>::Raw raw;
    std::memcpy(&raw, from, sizeof(raw));
    return Pack<W>::from(raw);
}

template <int W>
inline void store_pack(double* to, const Pack<W>& values) {
    std::memcpy(to, &values.v, sizeof(values.v));
}

namespace detail {

/// Pairs of 16 bytes of a and b that have the same place, even or odd numbers of each.
inline RawPack<8>::Values low_pairs(const RawPack<8>::Values& a,
                                    const RawPack<8>::Values& b) {
    return __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
}
inline RawPack<8>::Values high_pairs(const RawPack<8>::Values& a,
                                     const RawPack<8>::Values& b) {
    return __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
}
/// 16-byte parts 0 and 2, or 1 and 3, of a and then of b.
inline RawPack<8>::Values even_parts(const RawPack<8>::Values& a,
                                     const RawPack<8>::Values& b) {
    return __builtin_shufflevector(a, b, 0, 1, 4, 5, 8, 9, 12, 13);
}
inline RawPack<8>::Values odd_parts(const RawPack<8>::Values& a,
                                    const RawPack<8>::Values& b) {
    return __builtin_shufflevector(a, b, 2, 3, 6, 7, 10, 11, 14, 15);
}

}  // namespace detail

/// out[stride j + k] = rows[k][j], j in [0, W), k in [0, 8).
inline void store_transposed(const Pack<8> (&rows)[8], double* out, int stride) {
    using namespace detail;
    const auto store_columns = [&](int first, const auto(&pairs)[4]) {
        const auto front0 = even_parts(pairs[0], pairs[1]);  // columns first, first + 4
        const auto front2 = odd_parts(pairs[0], pairs[1]);   // first + 2, first + 6
        const auto back0 = even_parts(pairs[2], pairs[3]);
        const auto back2 = odd_parts(pairs[2], pairs[3]);
        const auto store = [&](int j, const RawPack<8>::Values& column) {
            store_pack<8>(out + std::ptrdiff_t{stride} * j, Pack<8>::from(column));
        };
        store(first, even_parts(front0, back0));
        store(first + 2, even_parts(front2, back2));
        store(first + 4, odd_parts(front0, back0));
        store(first + 6, odd_parts(front2, back2));
    };
    const RawPack<8>::Values even[4] = {low_pairs(rows[0].v, rows[1].v),
                                        low_pairs(rows[2].v, rows[3].v),
                                        low_pairs(rows[4].v, rows[5].v),
                                        low_pairs(rows[6].v, rows[7].v)};
    const RawPack<8>::Values odd[4] = {high_pairs(rows[0].v, rows[1].v),
                                       high_pairs(rows[2].v, rows[3].v),
                                       high_pairs(rows[4].v, rows[5].v),
                                       high_pairs(rows[6].v, rows[7].v)};
    store_columns(0, even);
    store_columns(1, odd);
}

inline void store_transposed(const Pack<4> (&rows)[8], double* out, int stride) {
    for (int k = 0; k < 8; k += 4) {
        const auto a = rows[k].v;
        const auto b = rows[k + 1].v;
        const auto c = rows[k + 2].v;
        const auto d = rows[k + 3].v;
        const auto ab02 = __builtin_shufflevector(a, b, 0, 4, 2, 6);
        const auto ab13 = __builtin_shufflevector(a, b, 1, 5, 3, 7);
        const auto cd02 = __builtin_shufflevector(c, d, 0, 4, 2, 6);
        const auto cd13 = __builtin_shufflevector(c, d, 1, 5, 3, 7);
        const auto store = [&](int j, const detail::RawPack<4>::Values& column) {
            store_pack<4>(out + std::ptrdiff_t{stride} * j + k, Pack<4>::from(column));
        };
        store(0, __builtin_shufflevector(ab02, cd02, 0, 1, 4, 5));
        store(1, __builtin_shufflevector(ab13, cd13, 0, 1, 4, 5));
        store(2, __builtin_shufflevector(ab02, cd02, 2, 3, 6, 7));
        store(3, __builtin_shufflevector(ab13, cd13, 2, 3, 6, 7));
    }
}

inline void store_transposed(const Pack<2> (&rows)[8], double* out, int stride) {
    for (int k = 0; k < 8; k += 2) {
        const auto a = rows[k].v;
        const auto b = rows[k + 1].v;
        store_pack<2>(out + k, Pack<2>::from(__builtin_shufflevector(a, b, 0, 2)));
        store_pack<2>(out + stride + k,
                      Pack<2>::from(__builtin_shufflevector(a, b, 1, 3)));
    }
}

}  // namespace noli
