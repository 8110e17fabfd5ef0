// SPDX-License-Identifier: Apache-2.0
#include "derivative/contact_oracle.hpp"
#include "support/paper_constructions.hpp"
#include "tables.hpp"

#include <map>
#include <string>

namespace noli::paper {
namespace {

using test::ChangeOfBasis;
using test::JacobianSpace;
using test::Shape;

constexpr double kDhat = 1e-3;
constexpr int kExponent = 2;  // the ratios below do not depend on it

using Samples = std::map<std::string, std::vector<double>>;

const char* name_of(PairKind kind) {
    constexpr const char* kNames[] = {"PP", "PE", "PT", "EE"};
    return kNames[int(kind)];
}

/// How well the construction does what it is for: relative errors.
template <int S>
void add_construction_errors(const Shape<S>& shape,
                             const PairGeometry<S>& pair,
                             Samples& out) {
    const double s = pair.d / kDhat;
    const auto F = shape.jacobian().eval();
    const double g = (F * shape.normal).squaredNorm();
    out["error_gap"].push_back(std::fabs(g / (s * s) - 1.0));
    Eigen::Matrix<double, S - 1, S - 1> stretch_sq =
        Eigen::Matrix<double, S - 1, S - 1>::Identity();
    stretch_sq += (s * s - 1.0) * shape.normal * shape.normal.transpose();
    out["error_stretch"].push_back((F.transpose() * F - stretch_sq).norm());
}

/// Sizes of the second term of Eq. (4) relative to the first.
template <int S>
void add_second_term(const ChangeOfBasis<S>& basis,
                     const JacobianSpace<S>& space,
                     Samples& out) {
    const auto ratio = [&](const typename JacobianSpace<S>::Vec& mode) {
        return (basis.second.transpose() * mode).norm()
             / (basis.first.transpose() * mode).norm();
    };
    out["second_tensor"].push_back(basis.second.norm() / basis.first.norm());
    out["second_gradient"].push_back(ratio(space.stress));
    out["second_kept_mode"].push_back(ratio(space.kept));
    const auto twist_size = [&](const auto& tensor) {
        return std::hypot((tensor.transpose() * space.twists[0]).norm(),
                          (tensor.transpose() * space.twists[1]).norm());
    };
    out["second_dropped_modes"].push_back(twist_size(basis.second)
                                          / twist_size(basis.first));
}

/// Distance of the library's closed forms from what the construction gives.
template <int S>
void add_closed_form_errors(PairKind kind,
                            const Stencil<S>& x,
                            const ChangeOfBasis<S>& basis,
                            const JacobianSpace<S>& space,
                            const BarrierParams& params,
                            Samples& out) {
    const auto q = (basis.sum().transpose() * space.kept).eval();
    const auto gradient = (basis.sum().transpose() * space.stress).eval();
    out["error_gradient"].push_back(
        test::relative_error(test::flat(pair_gradient(kind, x, params).g), gradient));
    out["error_hessian"].push_back(test::relative_error(
        test::dense(pair_hessian(ContactHessian::GaussNewton, kind, x, params)),
        (space.lambda1 * q * q.transpose()).eval()));
}

}  // namespace

void print_constructions(const SampleOptions& options) {
    const BarrierParams params{kDhat, 1.0, kExponent, 0.0};
    std::printf("pair,edge_over_dhat,s,samples,quantity,q10,median,q90,max\n");
    for (double size : {2.0, 10.0, 100.0}) {
        for (double s : {0.01, 0.1, 0.5, 0.9}) {
            test::PairSampler sampler(options.seed);
            std::map<PairKind, Samples> tables;
            for (int i = 0; i < options.samples; ++i)
                for_each_kind(
                    sampler,
                    s * kDhat,
                    size * kDhat,
                    [&]<int S>(PairKind kind, const Stencil<S>& x) {
                        const auto shape = test::paper_shape(kind, x, kDhat);
                        const auto basis = test::change_of_basis(kind, x, kDhat);
                        const auto space = test::jacobian_space(shape, params);
                        Samples& out = tables[kind];
                        add_construction_errors(shape, pair_geometry(kind, x), out);
                        add_second_term(basis, space, out);
                        add_closed_form_errors(kind, x, basis, space, params, out);
                    });
            for (auto& [kind, samples] : tables)
                for (auto& [quantity, values] : samples) {
                    std::printf("%s,%g,%g,%d,%s",
                                name_of(kind),
                                size,
                                s,
                                options.samples,
                                quantity.c_str());
                    print_quantiles(values);
                }
        }
    }
}

}  // namespace noli::paper
