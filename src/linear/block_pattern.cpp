// SPDX-License-Identifier: Apache-2.0
#include "linear/block_pattern.hpp"

#include <algorithm>
#include <cstddef>

namespace noli {

namespace {

constexpr int kNoContribution = -1;

/// One coupling of the upper triangle before merging: row <= col.
struct Entry {
    int row, col;
    int packed;  ///< a Contribution, or kNoContribution
};

/// Stable counting sort of the entries by one of their members.
void sort_entries(std::vector<Entry>& entries, int Entry::*key, int num_keys) {
    std::vector<std::size_t> begin(static_cast<std::size_t>(num_keys) + 1, 0);
    for (const Entry& e : entries)
        ++begin[static_cast<std::size_t>(e.*key) + 1];
    for (std::size_t k = 1; k < begin.size(); ++k)
        begin[k] += begin[k - 1];
    std::vector<Entry> sorted(entries.size());
    for (const Entry& e : entries)
        sorted[begin[static_cast<std::size_t>(e.*key)]++] = e;
    entries.swap(sorted);
}

/// The two ends of each upper block, merged from entries that are sorted by (row, col).
std::vector<Int2> merge_into_upper(const std::vector<Entry>& entries,
                                   BlockPattern& pattern) {
    std::vector<Int2> ends;
    for (const Entry& e : entries) {
        if (ends.empty() || ends.back() != Int2{{e.row, e.col}}) {
            ends.push_back({{e.row, e.col}});
            pattern.gather_begin.push_back(static_cast<int>(pattern.gather.size()));
        }
        if (e.packed != kNoContribution) pattern.gather.push_back(e.packed);
    }
    pattern.gather_begin.push_back(static_cast<int>(pattern.gather.size()));
    return ends;
}

/// Rows of both triangles. Visiting the upper blocks in order appends to every row in
/// ascending column order: the blocks left of the diagonal come from earlier rows.
void fill_rows(const std::vector<Int2>& ends, BlockPattern& pattern) {
    const auto at = [](std::vector<int>& v, int i) -> int& {
        return v[static_cast<std::size_t>(i)];
    };
    pattern.row_begin.assign(static_cast<std::size_t>(pattern.num_rows) + 1, 0);
    for (const Int2& e : ends) {
        ++at(pattern.row_begin, e[0] + 1);
        if (e[0] != e[1]) ++at(pattern.row_begin, e[1] + 1);
    }
    for (int i = 0; i < pattern.num_rows; ++i)
        at(pattern.row_begin, i + 1) += at(pattern.row_begin, i);

    std::vector<int> next(pattern.row_begin.begin(), pattern.row_begin.end() - 1);
    pattern.col.resize(static_cast<std::size_t>(pattern.row_begin.back()));
    pattern.diagonal.resize(static_cast<std::size_t>(pattern.num_rows));
    for (const Int2& e : ends) {
        const int upper = at(next, e[0])++;
        at(pattern.col, upper) = e[1];
        int lower = upper;
        if (e[0] == e[1]) {
            at(pattern.diagonal, e[0]) = upper;
        } else {
            lower = at(next, e[1])++;
            at(pattern.col, lower) = e[0];
        }
        pattern.upper.push_back(upper);
        pattern.lower.push_back(lower);
    }
}

BlockPattern build_from_entries(int num_rows, std::vector<Entry> entries) {
    sort_entries(entries, &Entry::col, num_rows);
    sort_entries(entries, &Entry::row, num_rows);
    BlockPattern pattern;
    pattern.num_rows = num_rows;
    fill_rows(merge_into_upper(entries, pattern), pattern);
    return pattern;
}

std::vector<Entry> diagonal_entries(int num_rows, std::size_t capacity) {
    std::vector<Entry> entries;
    entries.reserve(static_cast<std::size_t>(num_rows) + capacity);
    for (int i = 0; i < num_rows; ++i)
        entries.push_back({i, i, kNoContribution});
    return entries;
}

}  // namespace

BlockPattern build_block_pattern(int num_vertices, std::span<const Int4> elements) {
    std::vector<Entry> entries =
        diagonal_entries(num_vertices, kBlocksPerElement * elements.size());
    for (std::size_t e = 0; e < elements.size(); ++e) {
        const Int4& v = elements[e];
        int slot = 0;
        for (int a = 0; a < 4; ++a)
            for (int b = a; b < 4; ++b, ++slot) {
                NOLI_DCHECK(a == b || v[a] != v[b]);
                const Contribution c{static_cast<int>(e), slot, v[a] > v[b]};
                entries.push_back(
                    {std::min(v[a], v[b]), std::max(v[a], v[b]), c.packed()});
            }
    }
    return build_from_entries(num_vertices, std::move(entries));
}

BlockPattern build_block_pattern(int num_rows, std::span<const Int2> couplings) {
    std::vector<Entry> entries = diagonal_entries(num_rows, couplings.size());
    for (const Int2& c : couplings)
        entries.push_back({std::min(c[0], c[1]), std::max(c[0], c[1]), kNoContribution});
    return build_from_entries(num_rows, std::move(entries));
}

}  // namespace noli
