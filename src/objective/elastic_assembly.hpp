// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The sum of all elements' gradients and projected Hessians. CPU executors add them to
/// the matrix block by block of elements (objective/coloured_elasticity.hpp); a device
/// stores them and gathers: the loops in which every thread does the same.

#include "linear/block_matrix.hpp"
#include "objective/elastic_terms.hpp"
#if !defined(__CUDACC__)
#include "objective/coloured_elasticity.hpp"
#endif

#include <type_traits>

namespace noli {

/// Stores what each element adds, then gathers per block of the matrix and per vertex.
/// On CPU executors the reference that tests compare with.
template <class Exec>
class GatheredElasticity {
  public:
    GatheredElasticity(const Model& /*model*/, const BlockPattern& /*pattern*/) {}

    /// matrix = Hessian of scale V Psi(F), projected or exact, + diagonal * identity;
    /// gradient += its gradient, unless gradient is empty.
    void assemble(Exec& exec,
                  const DeviceModel<Exec>& model,
                  View<const Vec3d> x,
                  double scale,
                  View<const double> diagonal,
                  View<Vec3d> gradient,
                  BlockMatrix<Exec>& matrix,
                  bool project = true) {
        elastic_derivatives(exec, model, x, scale, corners_, blocks_, project);
        if (gradient.size > 0) gather_corners(exec, model, corners_.view(), gradient);
        matrix.assemble(exec, blocks_.view(), diagonal);
    }

  private:
    typename Exec::template Buffer<Vec3d> corners_;
    typename Exec::template Buffer<double> blocks_;
};

#if defined(__CUDACC__)
template <class Exec>
using ElasticAssembly = GatheredElasticity<Exec>;
#else
template <class Exec>
using ElasticAssembly =
    std::conditional_t<Exec::kIsDevice, GatheredElasticity<Exec>, ColouredElasticity>;
#endif

}  // namespace noli
