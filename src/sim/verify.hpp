// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "noli/simulator.hpp"

#include "contact/min_gap.hpp"
#include "model/model.hpp"

#include <memory>
#include <vector>

namespace noli {

/// Two bodies, or a body and a half-space, that are closer than dhat, and where they are
/// closest. A body may be close to itself.
struct BodyGap {
    int a = -1;
    int b = -1;      ///< body; -1: half-space
    int plane = -1;  ///< half-space; -1: body
    MinGap closest{};
    /// Sum over the pairs of the barrier for kappa = 1, m^4, without those of nearly
    /// parallel edges.
    double barrier = 0.0;
};

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

    /// All that is closer than dhat at x, in the order of the bodies; `exponent` is the
    /// barrier's.
    std::vector<BodyGap> gaps(const std::vector<Vec3d>& x, int exponent);

    /// Where obstacles cross other obstacles, which `run` does not look at.
    std::vector<ExactIntersection> obstacle_overlaps(const std::vector<Vec3d>& x);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace noli
