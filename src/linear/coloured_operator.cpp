// SPDX-License-Identifier: Apache-2.0
#include "linear/coloured_operator.hpp"

#include "core/index.hpp"

#include <algorithm>
#include <utility>

namespace noli {

namespace {

using detail::at;

template <class T>
bool same(const std::vector<T>& a, View<const T> b) {
    return a.size() == at(b.size) && std::equal(a.begin(), a.end(), b.begin());
}

}  // namespace

bool ColouredOperator::matrix_changed(const OperatorView& op,
                                      View<const std::uint8_t> fixed) {
    if (same(seen_row_begin_, op.row_begin) && same(seen_col_, op.col)
        && same(seen_fixed_, fixed))
        return false;
    seen_row_begin_.assign(op.row_begin.begin(), op.row_begin.end());
    seen_col_.assign(op.col.begin(), op.col.end());
    seen_fixed_.assign(fixed.begin(), fixed.end());
    return true;
}

bool ColouredOperator::terms_changed(const OperatorView& op) {
    if (same(seen_terms_, op.vertices)) return false;
    seen_terms_.assign(op.vertices.begin(), op.vertices.end());
    return true;
}

void ColouredOperator::count_columns(int part) {
    for (int r = 0; r < num_rows(); ++r)
        place_of(part, r) = 0;
    const int last = num_rows() - 1;
    for (int i = first_row(part); i < first_row(part + 1); ++i)
        for (int p = lower_.row_begin[at(i)]; p < lower_.row_begin[at(i) + 1] - 1; ++p)
            ++place_of(part, last - lower_.col[at(p)]);
}

void ColouredOperator::sum_counts(int part) {
    for (int r = first_row(part); r < first_row(part + 1); ++r) {
        int sum = 0;
        for (int k = 0; k < kParts; ++k)
            sum += place_of(k, r);
        upper_begin[at(r) + 1] = sum;
    }
}

void ColouredOperator::find_places(int part) {
    for (int r = first_row(part); r < first_row(part + 1); ++r) {
        int place = upper_begin[at(r)];
        for (int k = 0; k < kParts; ++k)
            place += std::exchange(place_of(k, r), place);
    }
}

void ColouredOperator::fill_upper(int part) {
    const int last = num_rows() - 1;
    for (int i = first_row(part); i < first_row(part + 1); ++i)
        for (int p = lower_.row_begin[at(i)]; p < lower_.row_begin[at(i) + 1] - 1; ++p) {
            const int to = place_of(part, last - lower_.col[at(p)])++;
            upper_col[at(to)] = i;
            upper_place[at(p - i)] = to;
        }
}

}  // namespace noli
