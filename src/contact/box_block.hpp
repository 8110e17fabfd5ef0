// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Four boxes, or the vertex ids of four primitives, side by side, and tests of one
/// against four.
///
/// Every test has two texts with equal results: plain loops for the device, GCC vector
/// extensions for the host (any x86-64 and ARM has four lanes). `kOnDevice` is a template
/// argument, not a macro, so that nvcc's host copy of a function never replaces g++'s at
/// link time.

#include "contact/moving_box.hpp"
#include "core/vec.hpp"

namespace noli {

inline constexpr int kBlockSize = 4;

struct alignas(16) StaticBlock {
    float lo[3][kBlockSize];
    float hi[3][kBlockSize];
};
struct MovingBlock {
    StaticBlock start;
    StaticBlock end;
};

namespace detail {

template <class Box>
struct BlockOf;
template <>
struct BlockOf<StaticBox> {
    using Type = StaticBlock;
};
template <>
struct BlockOf<MovingBox> {
    using Type = MovingBlock;
};

}  // namespace detail

/// Boxes of one block; places without a primitive hold empty boxes.
template <class Box>
using BoxBlock = typename detail::BlockOf<Box>::Type;

/// Vertex ids of the primitives of one leaf; places without a primitive hold -1.
template <class Ids>
struct alignas(16) IdBlock {
    int v[kNumCorners<Ids>][kBlockSize];
};

NOLI_HD inline void load_ids(const IdBlock<int>& block, int place, int& out) {
    out = block.v[0][place];
}
NOLI_HD inline void load_ids(const IdBlock<Int2>& block, int place, Int2& out) {
    out = {block.v[0][place], block.v[1][place]};
}
NOLI_HD inline void load_ids(const IdBlock<Int3>& block, int place, Int3& out) {
    out = {block.v[0][place], block.v[1][place], block.v[2][place]};
}

NOLI_HD inline void store(StaticBlock& block, int place, const StaticBox& box) {
    for (int k = 0; k < 3; ++k) {
        block.lo[k][place] = box.lo[k];
        block.hi[k][place] = box.hi[k];
    }
}
NOLI_HD inline void store(MovingBlock& block, int place, const MovingBox& box) {
    store(block.start, place, box.start);
    store(block.end, place, box.end);
}
[[gnu::always_inline]] NOLI_HD inline StaticBox load(const StaticBlock& block,
                                                     int place) {
    return {{block.lo[0][place], block.lo[1][place], block.lo[2][place]},
            {block.hi[0][place], block.hi[1][place], block.hi[2][place]}};
}
[[gnu::always_inline]] NOLI_HD inline MovingBox load(const MovingBlock& block,
                                                     int place) {
    return {load(block.start, place), load(block.end, place)};
}

/// Index of the lowest bit that is set; bits != 0.
NOLI_HD inline int lowest_bit(unsigned bits) {
#if defined(__CUDA_ARCH__)
    return __ffs(static_cast<int>(bits)) - 1;
#else
    return __builtin_ctz(bits);
#endif
}

namespace detail {

#if !defined(__CUDACC__)
using Floats = float __attribute__((vector_size(4 * kBlockSize)));
using Ints = int __attribute__((vector_size(4 * kBlockSize)));

template <class Packed, class Scalar>
[[gnu::always_inline]] inline Packed load_packed(const Scalar* from) {
    Packed v;
    __builtin_memcpy(&v, from, sizeof v);
    return v;
}

[[gnu::always_inline]] inline unsigned bits_of(Ints mask) {
#if defined(__SSE__)
    return static_cast<unsigned>(__builtin_ia32_movmskps(reinterpret_cast<Floats>(mask)));
#else
    unsigned bits = 0;
    for (int j = 0; j < kBlockSize; ++j)
        bits |= static_cast<unsigned>(mask[j] & 1) << j;
    return bits;
#endif
}

[[gnu::always_inline]] inline unsigned packed_overlap(const StaticBox& box,
                                                      const StaticBlock& block) {
    Ints hit = ~Ints{};
    for (int k = 0; k < 3; ++k) {
        hit &= load_packed<Floats>(block.lo[k]) <= box.hi[k];
        hit &= load_packed<Floats>(block.hi[k]) >= box.lo[k];
    }
    return bits_of(hit);
}
[[gnu::always_inline]] inline unsigned packed_overlap(const MovingBox& box,
                                                      const MovingBlock& block) {
    Ints hit = ~Ints{};
    for (int k = 0; k < 3; ++k) {
        hit &= (load_packed<Floats>(block.start.lo[k]) <= box.start.hi[k])
             | (load_packed<Floats>(block.end.lo[k]) <= box.end.hi[k]);
        hit &= (load_packed<Floats>(block.start.hi[k]) >= box.start.lo[k])
             | (load_packed<Floats>(block.end.hi[k]) >= box.end.lo[k]);
    }
    return bits_of(hit);
}

template <class Ids>
[[gnu::always_inline]] inline unsigned packed_same(int id, const IdBlock<Ids>& block) {
    Ints same = load_packed<Ints>(block.v[0]) == id;
    for (int k = 1; k < kNumCorners<Ids>; ++k)
        same |= load_packed<Ints>(block.v[k]) == id;
    return bits_of(same);
}
#endif

}  // namespace detail

/// Bit j is set if `box` overlaps box j of the block.
template <bool kOnDevice, class Box>
[[gnu::always_inline]] NOLI_HD inline unsigned overlap_bits(const Box& box,
                                                            const BoxBlock<Box>& block) {
#if !defined(__CUDACC__)
    if constexpr (!kOnDevice) return detail::packed_overlap(box, block);
#endif
    unsigned bits = 0;
    for (int j = 0; j < kBlockSize; ++j)
        bits |= (overlap(box, load(block, j)) ? 1U : 0U) << j;
    return bits;
}

/// Bit j is set if vertex `id` belongs to primitive j of the block.
template <bool kOnDevice, class Ids>
[[gnu::always_inline]] NOLI_HD inline unsigned same_vertex_bits(
    int id, const IdBlock<Ids>& block) {
#if !defined(__CUDACC__)
    if constexpr (!kOnDevice) return detail::packed_same(id, block);
#endif
    unsigned bits = 0;
    for (int j = 0; j < kBlockSize; ++j)
        for (int k = 0; k < kNumCorners<Ids>; ++k)
            bits |= (block.v[k][j] == id ? 1U : 0U) << j;
    return bits;
}

}  // namespace noli
