// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The boxes of one block against those of another, all sixteen pairs at once.
///
/// Two texts with equal results, as in box_block.hpp. The host's keeps the boxes of the
/// first block spread over the lanes, because a block is tested against many: with AVX2
/// that takes a third of the instructions of four tests of one box against four.

#include "contact/box_block.hpp"

#include <type_traits>

namespace noli::detail {

inline constexpr int kBoxPairs = kBlockSize * kBlockSize;

/// Bits 4 i + j with i < j, and with i <= j.
inline constexpr unsigned kPairsAbove = 0x08CEU;
inline constexpr unsigned kPairsFromSame = 0x8CEFU;

/// Bit 4 i + j is set if primitives i of block a and j of block b share a vertex.
template <bool kOnDevice, class IdsA, class IdsB>
NOLI_HD inline unsigned shared_bits(const IdBlock<IdsA>& a, const IdBlock<IdsB>& b) {
    unsigned bits = 0;
    for (int i = 0; i < kBlockSize; ++i)
        for (int k = 0; k < kNumCorners<IdsA>; ++k)
            bits |= same_vertex_bits<kOnDevice>(a.v[k][i], b) << (kBlockSize * i);
    return bits;
}

/// The boxes of one block. overlaps(other): bit 4 i + j is set if its box i overlaps box
/// j of the other.
template <bool kOnDevice, class Box>
class GroupBoxes {
  public:
    NOLI_HD explicit GroupBoxes(const BoxBlock<Box>& block) : block_(block) {}

    [[nodiscard]] NOLI_HD unsigned overlaps(const BoxBlock<Box>& other) const {
        unsigned bits = 0;
        for (int i = 0; i < kBlockSize; ++i)
            bits |= overlap_bits<kOnDevice>(load(block_, i), other) << (kBlockSize * i);
        return bits;
    }

  private:
    const BoxBlock<Box>& block_;
};

#if !defined(__CUDACC__)
/// Bounds of four boxes, each four times: lane 4 i + j is for box i and box j of another
/// block.
struct alignas(32) StaticSpread {
    float lo[3][kBoxPairs];
    float hi[3][kBoxPairs];
};
struct MovingSpread {
    StaticSpread start;
    StaticSpread end;
};

using WideFloats = float __attribute__((vector_size(8 * kBlockSize)));
using WideInts = int __attribute__((vector_size(8 * kBlockSize)));

/// Four floats, twice.
[[gnu::always_inline]] inline WideFloats twice(const float* four) {
    const Floats v = load_packed<Floats>(four);
    return __builtin_shufflevector(v, v, 0, 1, 2, 3, 0, 1, 2, 3);
}
[[gnu::always_inline]] inline unsigned bits_of(WideInts mask) {
    const Ints low = __builtin_shufflevector(mask, mask, 0, 1, 2, 3);
    const Ints high = __builtin_shufflevector(mask, mask, 4, 5, 6, 7);
    return bits_of(low) | bits_of(high) << kBlockSize;
}

inline void spread(const StaticBlock& block, StaticSpread& to) {
    for (int k = 0; k < 3; ++k)
        for (int i = 0; i < kBoxPairs; ++i) {
            to.lo[k][i] = block.lo[k][i / kBlockSize];
            to.hi[k][i] = block.hi[k][i / kBlockSize];
        }
}
inline void spread(const MovingBlock& block, MovingSpread& to) {
    spread(block.start, to.start);
    spread(block.end, to.end);
}

/// Lanes [first, first + 8) where b.lo <= a.hi, and where a.lo <= b.hi, on axis k.
[[gnu::always_inline]] inline WideInts not_above(const StaticSpread& a,
                                                 const StaticBlock& b,
                                                 int k,
                                                 int first) {
    return twice(b.lo[k]) <= load_packed<WideFloats>(a.hi[k] + first);
}
[[gnu::always_inline]] inline WideInts not_below(const StaticSpread& a,
                                                 const StaticBlock& b,
                                                 int k,
                                                 int first) {
    return twice(b.hi[k]) >= load_packed<WideFloats>(a.lo[k] + first);
}
/// The same at the start or at the end of the motion.
[[gnu::always_inline]] inline WideInts not_above(const MovingSpread& a,
                                                 const MovingBlock& b,
                                                 int k,
                                                 int first) {
    return not_above(a.start, b.start, k, first) | not_above(a.end, b.end, k, first);
}
[[gnu::always_inline]] inline WideInts not_below(const MovingSpread& a,
                                                 const MovingBlock& b,
                                                 int k,
                                                 int first) {
    return not_below(a.start, b.start, k, first) | not_below(a.end, b.end, k, first);
}

template <class Box>
class GroupBoxes<false, Box> {
  public:
    explicit GroupBoxes(const BoxBlock<Box>& block) { spread(block, boxes_); }

    [[nodiscard, gnu::always_inline]] unsigned overlaps(
        const BoxBlock<Box>& other) const {
        unsigned bits = 0;
        for (int first = 0; first < kBoxPairs; first += 2 * kBlockSize) {
            WideInts hit = ~WideInts{};
            for (int k = 0; k < 3; ++k)
                hit &= not_above(boxes_, other, k, first)
                     & not_below(boxes_, other, k, first);
            bits |= bits_of(hit) << first;
        }
        return bits;
    }

  private:
    std::conditional_t<std::is_same_v<Box, MovingBox>, MovingSpread, StaticSpread> boxes_;
};
#endif

}  // namespace noli::detail
