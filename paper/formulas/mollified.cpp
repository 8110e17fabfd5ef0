// SPDX-License-Identifier: Apache-2.0
#include "support/mollified_reference.hpp"
#include "tables.hpp"

namespace noli::paper {
namespace {

constexpr double kDhat = 0.1;  // edges of length 1
constexpr double kEps = 1e-3;  // their mollifier threshold

struct Variant {
    const char* name;
    MollifiedHessian model;
};

constexpr Variant kVariants[] = {
    {"two-mode", MollifiedHessian::TwoMode},
    {"four-mode", MollifiedHessian::FourMode},
    {"exact", MollifiedHessian::Exact},
};

struct SubCase {
    const char* name;
    PairKind kind;
};

constexpr SubCase kSubCases[] = {{"PP", PairKind::PointPoint},
                                 {"PE", PairKind::PointEdge},
                                 {"EE", PairKind::EdgeEdge}};

struct Range {
    double lo, hi;  ///< of gamma / eps
};

/// One decade cut in three, then up to the end of the mollified band; lambda_gamma1
/// changes its sign at 1/3.
constexpr Range kRanges[] = {{1e-6, 1e-5},
                             {1e-5, 1e-4},
                             {1e-4, 1e-3},
                             {1e-3, 1e-2},
                             {1e-2, 3e-2},
                             {3e-2, 0.1},
                             {0.1, 0.2},
                             {0.2, 1.0 / 3.0},
                             {1.0 / 3.0, 0.5},
                             {0.5, 0.7},
                             {0.7, 0.9},
                             {0.9, 1.0}};

/// ||H - P|| / ||P||, and ||H|| / ||P||, P the exact projection, per variant.
struct Errors {
    std::vector<double> distance[3], size[3];
};

Errors errors_of(const SubCase& sub,
                 double s,
                 const Range& range,
                 int r,
                 const SampleOptions& options) {
    Errors out;
    test::PairSampler sampler(options.seed);
    for (int i = 0; i < options.samples; ++i) {
        const double gamma =
            kEps * std::exp(sampler.uniform(std::log(range.lo), std::log(range.hi)));
        const Stencil<4> x =
            sampler.near_parallel(sub.kind, std::asin(std::sqrt(gamma)), s * kDhat);
        const MollifiedCase local = test::near_parallel_case(sub.kind);
        const auto exact =
            test::positive_part(test::mollified_oracle(local, x, kEps, r, kDhat).h);
        for (int v = 0; v < 3; ++v) {
            const auto H = test::dense(mollified_hessian(
                kVariants[v].model, local, x, kEps, {kDhat, 1.0, r, 0.0}));
            out.distance[v].push_back(test::relative_error(H, exact));
            out.size[v].push_back(H.norm() / exact.norm());
        }
    }
    return out;
}

}  // namespace

void print_mollified(const SampleOptions& options) {
    std::printf(
        "subcase,r,s,gamma_over_eps_lo,gamma_over_eps_hi,variant,samples,quantity,q10,"
        "median,"
        "q90,max\n");
    for (const SubCase& sub : kSubCases)
        for (int r : {1, 2})
            for (double s : {0.1, 0.5, 0.9})
                for (const Range& range : kRanges) {
                    Errors errors = errors_of(sub, s, range, r, options);
                    for (int v = 0; v < 3; ++v) {
                        const auto row = [&](const char* quantity,
                                             std::vector<double>& values) {
                            std::printf("%s,%d,%g,%g,%g,%s,%d,%s",
                                        sub.name,
                                        r,
                                        s,
                                        range.lo,
                                        range.hi,
                                        kVariants[v].name,
                                        options.samples,
                                        quantity);
                            print_quantiles(values);
                        };
                        row("error", errors.distance[v]);
                        row("size", errors.size[v]);
                    }
                }
}

}  // namespace noli::paper
