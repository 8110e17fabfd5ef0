// SPDX-License-Identifier: Apache-2.0
#include "linear/coarse_pattern.hpp"

#include "core/index.hpp"

#include <algorithm>
#include <numeric>

namespace noli {

namespace {

using detail::at;

void sort_without_repeats(std::vector<int>& v) {
    std::sort(v.begin(), v.end());
    v.erase(std::unique(v.begin(), v.end()), v.end());
}

/// Lists the couplings of each aggregate.
void find_couplings_of_each(int num_aggregates, RowCouplings& out) {
    out.of_begin.assign(at(num_aggregates) + 1, 0);
    for (const int a : out.aggregate)
        ++out.of_begin[at(a) + 1];
    std::partial_sum(out.of_begin.begin(), out.of_begin.end(), out.of_begin.begin());
    out.of_row.resize(out.size());
    out.of_place.resize(out.size());
    std::vector<int> next(out.of_begin.begin(), out.of_begin.end() - 1);
    for (std::size_t e = 0; e < out.size(); ++e) {
        out.of_place[e] = next[at(out.aggregate[e])]++;
        out.of_row[at(out.of_place[e])] = out.row[e];
    }
}

/// In:   begin, end  of the columns of a row
template <class Begin, class End>
void find_couplings(int num_rows,
                    const Begin& begin,
                    const End& end,
                    const std::vector<int>& col,
                    const std::vector<int>& aggregate,
                    RowCouplings& out) {
    out.begin.assign(1, 0);
    out.aggregate.clear();
    out.row.clear();
    std::vector<int> found;
    for (int i = 0; i < num_rows; ++i) {
        found.clear();
        for (int p = begin(i); p < end(i); ++p) {
            const int a = aggregate[at(col[at(p)])];
            if (a >= 0 && (found.empty() || found.back() != a)) found.push_back(a);
        }
        sort_without_repeats(found);
        out.aggregate.insert(out.aggregate.end(), found.begin(), found.end());
        out.row.resize(out.size(), i);
        out.begin.push_back(static_cast<int>(out.size()));
    }
}

}  // namespace

void CoarsePattern::update(const ColouredOperator& op,
                           std::span<const int> of_vertex,
                           int count,
                           bool with_lower) {
    find_rows(op, of_vertex, count);
    find_couplings(
        op.num_rows(),
        [&](int i) { return op.first_upper(i); },
        [&](int i) { return op.end_upper(i); },
        op.upper_col,
        aggregate,
        upper);
    find_couplings_of_each(count, upper);
    find_couplings_of_aggregates();
    lower = {};
    if (!with_lower) return;
    find_couplings(
        op.num_rows(),
        [&](int i) { return op.lower().row_begin[at(i)]; },
        [&](int i) { return op.lower().row_begin[at(i) + 1] - 1; },
        op.lower().col,
        aggregate,
        lower);
    find_couplings_of_each(count, lower);
}

void CoarsePattern::find_rows(const ColouredOperator& op,
                              std::span<const int> of_vertex,
                              int count) {
    const int n = op.num_rows();
    aggregate.resize(at(n));
    rows_begin.assign(at(count) + 1, 0);
    for (int i = 0; i < n; ++i) {
        aggregate[at(i)] = of_vertex[at(op.numbering().vertex[at(i)])];
        if (aggregate[at(i)] >= 0) ++rows_begin[at(aggregate[at(i)]) + 1];
    }
    std::partial_sum(rows_begin.begin(), rows_begin.end(), rows_begin.begin());
    rows.resize(at(rows_begin.back()));
    std::vector<int> next(rows_begin.begin(), rows_begin.end() - 1);
    for (int i = 0; i < n; ++i)
        if (aggregate[at(i)] >= 0) rows[at(next[at(aggregate[at(i)])]++)] = i;
}

void CoarsePattern::find_couplings_of_aggregates() {
    const int n = static_cast<int>(rows_begin.size()) - 1;
    begin.assign(1, 0);
    col.clear();
    place.resize(upper.size());
    const auto for_couplings_of = [this](int a, const auto& f) {
        for (int r = rows_begin[at(a)]; r < rows_begin[at(a) + 1]; ++r)
            for (int e = upper.begin[at(rows[at(r)])];
                 e < upper.begin[at(rows[at(r)]) + 1];
                 ++e)
                f(e);
    };
    std::vector<int> seen_by(at(n), -1);
    std::vector<int> place_in_row(at(n));
    for (int a = 0; a < n; ++a) {
        found_.clear();
        for_couplings_of(a, [&](int e) {
            const int b = upper.aggregate[at(e)];
            if (seen_by[at(b)] == a) return;
            seen_by[at(b)] = a;
            found_.push_back(b);
        });
        std::sort(found_.begin(), found_.end());
        for (const int b : found_) {
            place_in_row[at(b)] = static_cast<int>(col.size());
            col.push_back(b);
        }
        for_couplings_of(
            a, [&](int e) { place[at(e)] = place_in_row[at(upper.aggregate[at(e)])]; });
        begin.push_back(static_cast<int>(col.size()));
    }
}

int CoarsePattern::place_of(int a, int b) const {
    const auto first = col.begin() + begin[at(a)];
    const auto last = col.begin() + begin[at(a) + 1];
    const auto found = std::lower_bound(first, last, b);
    return found != last && *found == b ? static_cast<int>(found - col.begin()) : -1;
}

void CoarsePattern::find_matrix(CoarseMatrix& matrix) {
    const int n = static_cast<int>(rows_begin.size()) - 1;
    std::vector<std::vector<int>> cols(at(n));
    for (int a = 0; a < n; ++a) {
        cols[at(a)].push_back(a);
        for (int p = begin[at(a)]; p < begin[at(a) + 1]; ++p)
            cols[at(std::max(a, col[at(p)]))].push_back(std::min(a, col[at(p)]));
    }
    matrix.row_begin.assign(1, 0);
    matrix.col.clear();
    from.clear();
    for (int a = 0; a < n; ++a) {
        std::vector<int>& of_row = cols[at(a)];
        sort_without_repeats(of_row);
        for (const int b : of_row) {
            from.push_back(place_of(a, b));
            from.push_back(place_of(b, a));
        }
        matrix.col.insert(matrix.col.end(), of_row.begin(), of_row.end());
        matrix.row_begin.push_back(static_cast<int>(matrix.col.size()));
    }
    matrix.value.resize(matrix.col.size());
}

}  // namespace noli
