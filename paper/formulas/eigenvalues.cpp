// SPDX-License-Identifier: Apache-2.0
#include "energy/barrier.hpp"
#include "tables.hpp"

#include <cmath>

namespace noli::paper {
namespace {

/// d lambda_1 / dg by fourth-order central differences of the library's lambda_1.
double slope_of_lambda1(int exponent, double g) {
    const double h = 1e-3 * std::fmin(g, 1.0 - g);
    const auto at = [&](double t) { return barrier_lambda1(exponent, g + t * h); };
    return (8.0 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12.0 * h);
}

/// Eqs. (5), (6), (9) as printed, dhat = 1.
double printed_eq5(double g) {
    const double L = std::log(g);
    return 2.0 * (6.0 * g + 2.0 * g * L - 7.0 * g * g - 6.0 * g * g * L + 1.0) / g;
}
double printed_eq6(double g) {
    return -2.0 * (g - 1.0) * (g + 2.0 * g * std::log(g) - 1.0) / (g * g);
}
double printed_eq9(double g) {
    return -2.0 * (13.0 * g * g - 2.0 * g + 6.0 * g * g * std::log(g) + 1.0) / (g * g);
}

}  // namespace

/// Half of the rows are spaced evenly in ln g, half in g.
void print_eigenvalues(const SampleOptions& options) {
    std::vector<double> gaps;
    for (int i = 0; i < options.samples; ++i) {
        const double t = (i + 0.5) / options.samples;
        gaps.push_back(t);
        gaps.push_back(std::pow(10.0, -8.0 * t));
    }
    std::sort(gaps.begin(), gaps.end());
    std::printf(
        "g,lambda1_r1,lambda23_r1,slope_r1,lambda1_r2,lambda23_r2,slope_r2,"
        "eq5,eq6_printed,eq6_corrected,eq9\n");
    for (double g : gaps) {
        std::printf("%.17g", g);
        for (int r : {1, 2})
            std::printf(",%.17g,%.17g,%.17g",
                        barrier_lambda1(r, g),
                        barrier_lambda23(r, g),
                        slope_of_lambda1(r, g));
        std::printf(",%.17g,%.17g,%.17g,%.17g\n",
                    printed_eq5(g),
                    printed_eq6(g),
                    g * printed_eq6(g),
                    printed_eq9(g));
    }
}

}  // namespace noli::paper
