// SPDX-License-Identifier: Apache-2.0
#define XXH_INLINE_ALL  // NOLINT(readability-identifier-naming): the library's switch
#include "output/hash.hpp"

#include <fmt/format.h>
#include <xxhash.h>

namespace noli {

std::uint64_t hash_bytes(std::string_view bytes, std::uint64_t seed) {
    return XXH3_64bits_withSeed(bytes.data(), bytes.size(), seed);
}

std::uint64_t hash_bytes(std::span<const std::byte> bytes, std::uint64_t seed) {
    return XXH3_64bits_withSeed(bytes.data(), bytes.size(), seed);
}

std::string hash_text(std::uint64_t hash) {
    return fmt::format("{:016x}", hash);
}

}  // namespace noli
