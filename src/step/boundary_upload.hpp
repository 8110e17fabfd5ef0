// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The boundary data of a step in the memory of an executor. Only what changed since the
/// last step goes there, and of positions only those that are prescribed: a device gets
/// nothing at all where nothing moves by prescription.

#include "core/vec.hpp"
#include "core/view.hpp"
#include "model/boundary.hpp"

#include <cstring>
#include <vector>

namespace noli {

namespace detail {

/// path[leg * num_vertices + ids[k]] = points[leg * ids.size + k]
template <class Exec>
void scatter_path(Exec& exec,
                  View<const int> ids,
                  View<const Vec3d> points,
                  int num_vertices,
                  View<Vec3d> path) {
    exec.for_each("step/scatter_path", points.size, [=] NOLI_HD(int k) {
        const int leg = k / ids.size;
        path[leg * num_vertices + ids[k % ids.size]] = points[k];
    });
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size()
        && (a.empty() || std::memcmp(a.data(), b.data(), sizeof(T) * a.size()) == 0);
}

}  // namespace detail

template <class Exec>
class BoundaryUpload {
  public:
    void update(Exec& exec, const StepBoundary& boundary) {
        if (!detail::same_bytes(boundary.acceleration, acceleration_)) {
            acceleration_ = boundary.acceleration;
            exec.upload(acceleration_, on_device_.acceleration);
        }
        const bool same_set = detail::same_bytes(boundary.prescribed, prescribed_)
                           && detail::same_bytes(boundary.axes, axes_);
        if (!same_set) {
            prescribed_ = boundary.prescribed;
            axes_ = boundary.axes;
            ids_.clear();
            for (std::size_t v = 0; v < prescribed_.size(); ++v)
                if (prescribed_[v] != 0 || (!axes_.empty() && axes_[v] != 0))
                    ids_.push_back(static_cast<int>(v));
            exec.upload(prescribed_, on_device_.fixed);
            if (!axes_.empty()) exec.upload(axes_, on_device_.axes);
            exec.upload(ids_, on_device_.ids);
        }
        update_path(exec, boundary, same_set);
    }

    [[nodiscard]] View<const std::uint8_t> fixed() const {
        return on_device_.fixed.view();
    }
    /// StepBoundary::axes; empty where no single axes are prescribed.
    [[nodiscard]] View<const std::uint8_t> axes() const {
        if (axes_.empty()) return {};
        return on_device_.axes.view();
    }
    [[nodiscard]] View<const Vec3d> acceleration() const {
        return on_device_.acceleration.view();
    }
    /// Legs times num_vertices positions; only those of vertices that are prescribed,
    /// wholly or on single axes, are set.
    [[nodiscard]] View<const Vec3d> path() const { return on_device_.path.view(); }

  private:
    void update_path(Exec& exec, const StepBoundary& boundary, bool same_set) {
        std::vector<Vec3d> points;
        points.reserve(boundary.path.size() * ids_.size());
        for (const std::vector<Vec3d>& leg : boundary.path)
            for (const int v : ids_)
                points.push_back(leg[static_cast<std::size_t>(v)]);
        const auto legs = boundary.path.size();
        const int num_vertices = static_cast<int>(prescribed_.size());
        const bool same_legs = legs == legs_;
        legs_ = legs;
        if (same_set && same_legs && detail::same_bytes(points, points_)) return;
        points_.swap(points);
        on_device_.path.resize(static_cast<int>(legs) * num_vertices);
        exec.upload(points_, on_device_.points);
        detail::scatter_path(exec,
                             View<const int>(on_device_.ids.view()),
                             View<const Vec3d>(on_device_.points.view()),
                             num_vertices,
                             on_device_.path.view());
    }

    std::vector<std::uint8_t> prescribed_, axes_;
    std::vector<int> ids_;  ///< of the vertices of the path
    std::vector<Vec3d> acceleration_, points_;
    std::size_t legs_ = 0;
    struct {
        typename Exec::template Buffer<std::uint8_t> fixed, axes;
        typename Exec::template Buffer<int> ids;
        typename Exec::template Buffer<Vec3d> points, path, acceleration;
    } on_device_;
};

}  // namespace noli
