// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "noli/simulator.hpp"

#include "model/model.hpp"

#include <memory>
#include <vector>

namespace noli {

/// Exact test of positions for intersections and inverted tetrahedra, independent of the
/// solver. Pairs of obstacle vertices alone are not tested.
class Verifier {
  public:
    /// The model must outlive the verifier.
    explicit Verifier(const Model& model);
    ~Verifier();

    VerifyReport run(const std::vector<Vec3d>& x);

    /// Distances at x below dhat: the smallest, m (+infinity if none).
    double min_gap(const std::vector<Vec3d>& x);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace noli
