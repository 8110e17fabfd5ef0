// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Tetrahedra in the order of an ElementPartition, kElementGroup together, so that a pack
/// loads each of their constants with one instruction. CPU only.

#include "core/pack_transpose.hpp"
#include "energy/tet.hpp"
#include "linear/element_sums.hpp"
#include "model/model.hpp"

#include <algorithm>
#include <vector>

namespace noli {

struct alignas(64) TetGroup {
    double dm_inv[9][kElementGroup];
    double volume[kElementGroup];
    double mu[kElementGroup];
    double lambda[kElementGroup];
    int vertex[4][kElementGroup];
};

/// One group for each kElementGroup elements of each block; the last of a block repeats
/// its last element where it has fewer. One more at the end, so that every group has a
/// next one to prefetch.
inline std::vector<TetGroup> group_tets(const Model& model,
                                        const ElementPartition& partition) {
    std::vector<TetGroup> groups;
    for (int b = 0; b < partition.num_blocks(); ++b) {
        const int begin = partition.block_begin[static_cast<std::size_t>(b)];
        const int end = partition.block_begin[static_cast<std::size_t>(b) + 1];
        for (int first = begin; first < end; first += kElementGroup) {
            TetGroup& group = groups.emplace_back();
            for (int j = 0; j < kElementGroup; ++j) {
                const auto entry = static_cast<std::size_t>(std::min(first + j, end - 1));
                const auto t = static_cast<std::size_t>(partition.element[entry]);
                for (int k = 0; k < 9; ++k)
                    group.dm_inv[k][j] = model.dm_inv[t].a[k];
                group.volume[j] = model.volume[t];
                group.mu[j] = model.mu[t];
                group.lambda[j] = model.lambda[t];
                for (int c = 0; c < 4; ++c)
                    group.vertex[c][j] = model.tets[t][c];
            }
        }
    }
    groups.push_back({});
    return groups;
}

namespace detail {

/// Elements first ... first + W - 1 of a group.
template <int W>
inline TetShape<Pack<W>> load_tets(const TetGroup& group,
                                   View<const Vec3d> x,
                                   int first,
                                   double scale) {
    using T = Pack<W>;
    TetShape<T> shape;
    for (int c = 0; c < 4; ++c) {
        const int* v = &group.vertex[c][first];
        for (int j = 0; j < W; ++j) {
            const Vec3d& at = x[v[j]];
            shape.x[c].x.set(j, at.x);
            shape.x[c].y.set(j, at.y);
            shape.x[c].z.set(j, at.z);
        }
    }
    for (int k = 0; k < 9; ++k)
        shape.dm_inv.a[k] = load_pack<W>(&group.dm_inv[k][first]);
    shape.weight = T(scale) * load_pack<W>(&group.volume[first]);
    return shape;
}

template <int W>
inline LameParameters<Pack<W>> load_lame(const TetGroup& group, int first) {
    return {load_pack<W>(&group.mu[first]), load_pack<W>(&group.lambda[first])};
}

/// Where vertex a of an element has a greater number than vertex b.
template <int W>
inline typename Pack<W>::Mask is_turned(const TetGroup& group, int a, int b, int first) {
    const auto numbers = [&](int c) {
        Pack<W> out;
        for (int j = 0; j < W; ++j)
            out.set(j, group.vertex[c][first + j]);
        return out;
    };
    return numbers(a) > numbers(b);
}

}  // namespace detail

}  // namespace noli
