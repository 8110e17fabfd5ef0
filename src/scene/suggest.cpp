// SPDX-License-Identifier: Apache-2.0
#include "scene/suggest.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>

namespace noli {

namespace {

char lower(char c) {
    return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

}  // namespace

int edit_distance(std::string_view a, std::string_view b) {
    const std::size_t n = b.size() + 1;
    // Three rows of the table of prefix distances: two back, one back, this one.
    std::vector<int> two_back(n, 0), previous(n), row(n);
    for (std::size_t j = 0; j < n; ++j)
        previous[j] = static_cast<int>(j);
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = static_cast<int>(i);
        for (std::size_t j = 1; j < n; ++j) {
            const bool same = lower(a[i - 1]) == lower(b[j - 1]);
            row[j] = std::min(
                {previous[j] + 1, row[j - 1] + 1, previous[j - 1] + (same ? 0 : 1)});
            const bool swapped = i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2])
                              && lower(a[i - 2]) == lower(b[j - 1]);
            if (swapped) row[j] = std::min(row[j], two_back[j - 2] + 1);
        }
        two_back.swap(previous);
        previous.swap(row);
    }
    return previous[n - 1];
}

std::optional<std::string> nearest_word(std::string_view word,
                                        const std::vector<std::string>& candidates) {
    std::optional<std::string> best;
    int best_distance = static_cast<int>(std::max<std::size_t>(1, word.size() / 3)) + 1;
    for (const std::string& candidate : candidates) {
        const int distance = edit_distance(word, candidate);
        if (distance < best_distance) {
            best = candidate;
            best_distance = distance;
        }
    }
    return best;
}

std::string did_you_mean(std::string_view word,
                         const std::vector<std::string>& candidates) {
    const std::optional<std::string> best = nearest_word(word, candidates);
    return best ? fmt::format("; did you mean \"{}\"?", *best) : std::string{};
}

std::string quoted_list(const std::vector<std::string>& words) {
    std::string text;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (i > 0) text += i + 1 == words.size() ? " or " : ", ";
        text += '"' + words[i] + '"';
    }
    return text;
}

}  // namespace noli
