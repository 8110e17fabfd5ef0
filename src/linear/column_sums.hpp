// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Products of a row of 3x3 blocks with a vector, four lanes at a time.

#include "linear/wide.hpp"

namespace noli::detail {

/// Running sums of B x over column-major 3x3 blocks B, one per column so that they do not
/// wait for each other. Loads of four reach one number past each column; total() drops
/// that lane.
struct ColumnSums {
    Wide c0{}, c1{}, c2{};

    template <class Number>
    void add(const Number* block, const double* x) {
        c0 += load_wide(block) * x[0];
        c1 += load_wide(block + 3) * x[1];
        c2 += load_wide(block + 6) * x[2];
    }
    [[nodiscard]] Wide total() const { return three_lanes(c0 + c1 + c2); }
};

}  // namespace noli::detail
