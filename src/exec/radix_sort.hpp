// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Stable radix sort of keys that carry an int each, on the loops of a CPU executor.

#include "core/view.hpp"
#include "exec/buffer.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace noli::detail {

/// `Order` runs loops, see exec/cpu.hpp. The result does not depend on how.
template <class Order>
class RadixSort {
  public:
    template <class Key>
    void sort(View<Key> keys, View<int> values) {
        const int n = keys.size;
        if (n <= kFew) return insert_all(keys, values);
        key_bytes_.resize(n * static_cast<int>(sizeof(Key)));
        other_values_.resize(n);
        parts_ = std::clamp(n / kLeastPart, 1, kMostParts);
        List<Key> from{keys.data, values.data};
        List<Key> to{reinterpret_cast<Key*>(key_bytes_.view().data),
                     other_values_.view().data};
        const Key varying = varying_bits(View<const Key>(keys));
        for (unsigned shift = 0; shift < 8 * sizeof(Key); shift += 8) {
            if (digit(varying, shift) == 0) continue;
            count_digits(from, n, shift);
            scatter(from, to, n, shift);
            std::swap(from, to);
        }
        if (from.keys == keys.data) return;
        std::copy(from.keys, from.keys + n, keys.data);
        std::copy(from.values, from.values + n, values.data);
    }

  private:
    static constexpr int kFew = 96;           ///< up to which insertion is faster
    static constexpr int kLeastPart = 32768;  ///< shorter ones are not worth a task
    static constexpr int kMostParts = 16;
    static constexpr std::size_t kDigits = 256;

    template <class Key>
    struct List {
        Key* keys;
        int* values;
    };

    /// Insertion sort: stable as well.
    template <class Key>
    static void insert_all(View<Key> keys, View<int> values) {
        for (int i = 1; i < keys.size; ++i) {
            const Key key = keys[i];
            const int value = values[i];
            int to = i;
            for (; to > 0 && key < keys[to - 1]; --to) {
                keys[to] = keys[to - 1];
                values[to] = values[to - 1];
            }
            keys[to] = key;
            values[to] = value;
        }
    }

    [[nodiscard]] int bound(int part, int n) const {
        return static_cast<int>(static_cast<std::int64_t>(n) * part / parts_);
    }
    std::array<int, kDigits>& count_of(int part) {
        return counts_[static_cast<std::size_t>(part)];
    }
    template <class Key>
    static std::size_t digit(Key key, unsigned shift) {
        return static_cast<std::size_t>((key >> shift) & (kDigits - 1));
    }

    /// Bits in which not all keys agree.
    template <class Key>
    static Key varying_bits(View<const Key> keys) {
        Key bits = 0;
        for (const Key key : keys)
            bits |= key ^ keys[0];
        return bits;
    }

    /// Counts of each part, then the places that they give.
    template <class Key>
    void count_digits(const List<Key>& from, int n, unsigned shift) {
        Order::run(parts_, 1, [&](int part) {
            auto& count = count_of(part);
            const int end = bound(part + 1, n);
            count.fill(0);
            for (int i = bound(part, n); i < end; ++i)
                ++count[digit(from.keys[i], shift)];
        });
        int place = 0;
        for (std::size_t d = 0; d < kDigits; ++d)
            for (int part = 0; part < parts_; ++part)
                place += std::exchange(count_of(part)[d], place);
    }

    template <class Key>
    void scatter(const List<Key>& from, const List<Key>& to, int n, unsigned shift) {
        Order::run(parts_, 1, [&](int part) {
            auto& place = count_of(part);
            const int end = bound(part + 1, n);
            for (int i = bound(part, n); i < end; ++i) {
                const int at = place[digit(from.keys[i], shift)]++;
                to.keys[at] = from.keys[i];
                to.values[at] = from.values[i];
            }
        });
    }

    HostBuffer<std::byte> key_bytes_;
    HostBuffer<int> other_values_;
    std::array<std::array<int, kDigits>, kMostParts> counts_;
    int parts_ = 1;
};

}  // namespace noli::detail
