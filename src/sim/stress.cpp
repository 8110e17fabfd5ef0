// SPDX-License-Identifier: Apache-2.0
#include "sim/stress.hpp"

#include "energy/tet.hpp"

#include <algorithm>

namespace noli {

namespace {

template <ElasticModel M>
Mat3d stress_of(const Model& model, const std::vector<Vec3d>& x, std::size_t t) {
    Vec3d at[4];
    for (int k = 0; k < 4; ++k)
        at[k] = x[static_cast<std::size_t>(model.tets[t][k])];
    const Mat3d F = deformation_gradient(at, model.dm_inv[t]);
    return cauchy_stress<M>(F, LameParameters<double>{model.mu[t], model.lambda[t]});
}

Mat3d stress_of(const Model& model, const std::vector<Vec3d>& x, int t) {
    const std::size_t k = static_cast<std::size_t>(t);
    if (t < model.model_begin[1])
        return stress_of<ElasticModel::StableNeoHookean>(model, x, k);
    if (t < model.model_begin[2]) return stress_of<ElasticModel::NeoHookean>(model, x, k);
    return stress_of<ElasticModel::FixedCorotated>(model, x, k);
}

}  // namespace

void tet_stresses(const Model& model,
                  const std::vector<Vec3d>& x,
                  std::vector<std::array<double, 9>>& stress,
                  std::vector<double>& von_mises_out) {
    stress.resize(model.tets.size());
    von_mises_out.resize(model.tets.size());
    for (int t = 0; t < model.num_tets(); ++t) {
        const Mat3d s = stress_of(model, x, t);
        const std::size_t to =
            static_cast<std::size_t>(model.tet_source[static_cast<std::size_t>(t)]);
        std::copy_n(s.a, 9, stress[to].begin());
        von_mises_out[to] = von_mises(s);
    }
}

}  // namespace noli
