// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The parts of a Model that kernels read, where the executor's kernels run.

#include "core/view.hpp"
#include "model/model.hpp"

#include <vector>

namespace noli {

namespace detail {

/// Corners (4 tet + slot) of each vertex, ascending: the gather lists of per-corner
/// gradients.
inline void corner_lists(const Model& model,
                         std::vector<int>& begin,
                         std::vector<int>& corners) {
    begin.assign(static_cast<std::size_t>(model.num_vertices) + 1, 0);
    for (const Int4& tet : model.tets)
        for (const int v : tet.v)
            ++begin[static_cast<std::size_t>(v) + 1];
    for (std::size_t v = 1; v < begin.size(); ++v)
        begin[v] += begin[v - 1];
    corners.resize(4 * model.tets.size());
    std::vector<int> next(begin.begin(), begin.end() - 1);
    for (std::size_t t = 0; t < model.tets.size(); ++t)
        for (int k = 0; k < 4; ++k) {
            int& at = next[static_cast<std::size_t>(model.tets[t][k])];
            corners[static_cast<std::size_t>(at++)] = 4 * static_cast<int>(t) + k;
        }
}

}  // namespace detail

template <class Exec>
struct DeviceModel {
    template <class T>
    using Buffer = typename Exec::template Buffer<T>;

    int num_vertices = 0;
    int num_tets = 0;
    int num_bodies = 0;
    std::array<int, kNumElasticModels + 1> model_begin{};

    Buffer<Int4> tets;
    Buffer<Mat3d> dm_inv;
    Buffer<double> volume, mu, lambda;
    Buffer<double> mass;
    Buffer<int> corner_begin, corners;
    Buffer<int> body;
    Buffer<double> pair_friction, wall_friction;

    void upload(Exec& exec, const Model& model) {
        num_vertices = model.num_vertices;
        num_tets = model.num_tets();
        num_bodies = model.num_bodies();
        model_begin = model.model_begin;
        exec.upload(model.tets, tets);
        exec.upload(model.dm_inv, dm_inv);
        exec.upload(model.volume, volume);
        exec.upload(model.mu, mu);
        exec.upload(model.lambda, lambda);
        exec.upload(model.mass, mass);
        exec.upload(model.body, body);
        exec.upload(model.pair_friction, pair_friction);
        exec.upload(model.wall_friction, wall_friction);
        std::vector<int> begin;
        std::vector<int> lists;
        detail::corner_lists(model, begin, lists);
        exec.upload(begin, corner_begin);
        exec.upload(lists, corners);
    }
};

}  // namespace noli
