// SPDX-License-Identifier: Apache-2.0
#pragma once
/// "Did you mean ...": the nearest known word to a misspelt one.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace noli {

/// Letters to insert, drop, replace or swap with their neighbour to get from a to b,
/// ignoring case.
int edit_distance(std::string_view a, std::string_view b);

/// The candidate nearest to `word`, if it is near enough to be a slip of the keyboard.
std::optional<std::string> nearest_word(std::string_view word,
                                        const std::vector<std::string>& candidates);

/// "; did you mean "young"?" or nothing.
std::string did_you_mean(std::string_view word,
                         const std::vector<std::string>& candidates);

/// "a", "b" or "c", each in quotes.
std::string quoted_list(const std::vector<std::string>& words);

}  // namespace noli
