// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The way of the prescribed vertices through one step: one leg, or several where
/// something turns far (model/boundary.hpp).

#include "core/vec.hpp"
#include "core/view.hpp"

namespace noli {

class BoundaryPath {
  public:
    /// In:  points  legs times num_vertices positions, leg by leg
    BoundaryPath(View<const Vec3d> points, int legs)
        : points_(points), legs_(legs), size_(points.size / legs) {}

    /// Where the leg ends that the vertices are on.
    [[nodiscard]] View<const Vec3d> target() const {
        return {points_.data + static_cast<long>(leg_) * size_, size_};
    }
    /// Where the step ends.
    [[nodiscard]] View<const Vec3d> end() const {
        return {points_.data + static_cast<long>(legs_ - 1) * size_, size_};
    }
    [[nodiscard]] bool is_one_leg() const { return legs_ == 1; }
    /// False on the last leg.
    bool next_leg() {
        if (leg_ + 1 >= legs_) return false;
        ++leg_;
        return true;
    }

  private:
    View<const Vec3d> points_;
    int legs_;
    int size_;
    int leg_ = 0;
};

}  // namespace noli
