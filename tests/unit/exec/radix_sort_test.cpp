// SPDX-License-Identifier: Apache-2.0
#include "exec/radix_sort.hpp"

#include "exec/cpu.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

namespace noli {
namespace {

template <class Key>
struct Sequence {
    std::vector<Key> keys;
    std::vector<int> values;

    View<Key> key_view() { return {keys.data(), static_cast<int>(keys.size())}; }
    View<int> value_view() { return {values.data(), static_cast<int>(values.size())}; }
};

/// Keys below `bound`; values are the places.
template <class Key>
Sequence<Key> random_sequence(int n, std::uint64_t bound) {
    std::mt19937_64 random(static_cast<std::uint64_t>(n) + bound);
    Sequence<Key> out;
    for (int i = 0; i < n; ++i)
        out.keys.push_back(static_cast<Key>(random() % bound));
    out.values.resize(static_cast<std::size_t>(n));
    std::iota(out.values.begin(), out.values.end(), 0);
    return out;
}

/// By the standard library.
template <class Key>
Sequence<Key> sorted(const Sequence<Key>& from) {
    Sequence<Key> out;
    out.values = from.values;
    std::stable_sort(out.values.begin(), out.values.end(), [&](int a, int b) {
        return from.keys[static_cast<std::size_t>(a)]
             < from.keys[static_cast<std::size_t>(b)];
    });
    for (const int v : out.values)
        out.keys.push_back(from.keys[static_cast<std::size_t>(v)]);
    return out;
}

template <class Order, class Key>
void expect_sorted(detail::RadixSort<Order>& sort, int n, std::uint64_t bound) {
    Sequence<Key> sequence = random_sequence<Key>(n, bound);
    const Sequence<Key> expected = sorted(sequence);
    sort.sort(sequence.key_view(), sequence.value_view());
    EXPECT_EQ(sequence.keys, expected.keys) << n << " " << bound;
    EXPECT_EQ(sequence.values, expected.values) << n << " " << bound;
}

template <class Order>
class RadixSortOn : public testing::Test {};
using Orders =
    testing::Types<detail::TbbOrder, detail::SerialOrder, detail::ShuffledOrder>;
TYPED_TEST_SUITE(RadixSortOn, Orders);

TYPED_TEST(RadixSortOn, SortsAsTheStandardLibraryDoes) {
    detail::RadixSort<TypeParam> sort;
    for (const int n : {0, 1, 2, 40, 96, 97, 255, 4096, 65535, 200000, 100})
        for (const std::uint64_t bound : {1U, 2U, 200U, 70000U}) {
            expect_sorted<TypeParam, std::uint32_t>(sort, n, bound);
            expect_sorted<TypeParam, std::uint64_t>(sort, n, bound << 30);
        }
}

}  // namespace
}  // namespace noli
