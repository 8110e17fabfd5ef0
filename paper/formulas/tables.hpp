// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The tables of noli_paper_formulas: each prints one CSV table, with a header line, to
/// standard output.

#include <algorithm>
#include <cstdio>
#include <vector>

namespace noli::paper {

/// What every table with random pairs takes.
struct SampleOptions {
    unsigned seed = 1;
    int samples = 1000;  ///< random pairs per row; > 0
};

/// Supplement 1 and 2: the explicit constructions, and the second term of Eq. (4) beside
/// the first.
void print_constructions(const SampleOptions& options);

/// Supplement 3: eigenvalues of the barrier over the gap g, r = 1 and 2.
void print_eigenvalues(const SampleOptions& options);

/// Supplement 4: Hessian models of nearly parallel edges against the exact projection.
void print_mollified(const SampleOptions& options);

/// Supplement 5: eigenvalues of the 2 x 2 friction block.
void print_friction(const SampleOptions& options);

/// Sorts the values and prints ",q10,median,q90,max" of them and a line end.
inline void print_quantiles(std::vector<double>& values) {
    std::sort(values.begin(), values.end());
    const double last = double(values.size() - 1);
    for (double q : {0.1, 0.5, 0.9, 1.0})
        std::printf(",%.6g", values[std::size_t(q * last + 0.5)]);
    std::printf("\n");
}

}  // namespace noli::paper
