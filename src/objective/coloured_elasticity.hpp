// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Gradient and projected Hessian of elasticity, added to the matrix while they are in
/// the first-level cache: linear/element_sums.hpp says how, and why without atomics. CPU
/// only.

#include "core/morton.hpp"
#include "exec/lanes.hpp"
#include "linear/block_matrix.hpp"
#include "linear/local_sums.hpp"
#include "objective/elastic_terms.hpp"
#include "objective/tet_groups.hpp"

namespace noli {

/// Tetrahedra per block: a multiple of kElementGroup. Larger ones have fewer sums for
/// each element, smaller ones keep more threads at work.
inline constexpr int kTetsPerBlock = 64;

namespace detail {

/// What one block of tetrahedra is computed from.
struct TetBlock {
    const TetGroup* group;
    const std::uint16_t* slot;
    int num_tets;
    const int* kind_begin;
    const SumTarget* target;
};

template <ElasticModel M>
struct TetBlockKernel {
    TetBlock block;
    View<const Vec3d> x;
    double scale;
    bool project;
    SumOutput out;

    template <int W>
    void operator()(Lane<Pack<W>> /*lane*/) const {
        alignas(64) double head[kBlocksPerElement * kTetsPerBlock][8];
        double tail[kBlocksPerElement * kTetsPerBlock];
        const LocalSums sums{head, tail};
        set_zero<W>(sums, block.kind_begin[sum_kind::kCount] - block.kind_begin[0]);
        GroupBlocks group;
        const std::uint16_t* slot = block.slot;
        for (int first = 0; first < block.num_tets; first += kElementGroup) {
            const TetGroup& tets = block.group[first / kElementGroup];
            prefetch(first, tets);
            for (int j = 0; j < kElementGroup; j += W)
                differentiate<W>(tets, j, group);
            add_elements<W>(
                group, slot, std::min(kElementGroup, block.num_tets - first), sums);
            slot += std::ptrdiff_t{kElementGroup} * kBlocksPerElement;
        }
        move_sums<W>(sums, block.kind_begin, block.target, out);
    }

  private:
    /// Asks for the next group's constants and for a share of what the sums will be moved
    /// to: when assembly begins, a solve has filled the caches with other things.
    void prefetch(int first, const TetGroup& tets) const {
        prefetch_bytes<sizeof(TetGroup), kToRead>(&tets + 1);
        const int groups = (block.num_tets + kElementGroup - 1) / kElementGroup;
        const int group = first / kElementGroup;
        const int num_sums = block.kind_begin[sum_kind::kCount] - block.kind_begin[0];
        prefetch_targets(block.kind_begin,
                         block.target,
                         num_sums * group / groups,
                         num_sums * (group + 1) / groups,
                         out);
    }

    template <int W>
    void differentiate(const TetGroup& tets, int j, GroupBlocks& to) const {
        const auto all = tet_derivatives<M, kResist>(
            load_tets<W>(tets, x, j, scale), load_lame<W>(tets, j), project);
        int slot = 0;
#pragma GCC unroll 4
        for (int a = 0; a < 4; ++a) {
            store_diagonal<W>(all.hessian.block[slot], all.gradient.g[a], slot, j, to);
            ++slot;
#pragma GCC unroll 3
            for (int b = a + 1; b < 4; ++b, ++slot)
                store_off_diagonal<W>(
                    all.hessian.block[slot], is_turned<W>(tets, a, b, j), slot, j, to);
        }
    }
};

}  // namespace detail

class ColouredElasticity {
  public:
    ColouredElasticity(const Model& model, const BlockPattern& pattern) {
        std::vector<Vec3d> centroids;
        for (const Int4& t : model.tets) {
            const auto at = [&](int c) {
                return model.x0[static_cast<std::size_t>(t[c])];
            };
            centroids.push_back(0.25 * (at(0) + at(1) + at(2) + at(3)));
        }
        partition_ = partition_elements(model.num_vertices,
                                        model.tets,
                                        model.model_begin,
                                        morton_order(centroids),
                                        kTetsPerBlock);
        sums_ = build_element_sums(partition_, pattern);
        groups_ = group_tets(model, partition_);
    }

    /// matrix = Hessian of scale V Psi(F), projected or exact, + diagonal * identity;
    /// gradient += its gradient, unless gradient is empty.
    template <class Exec>
    void assemble(Exec& exec,
                  const DeviceModel<Exec>& /*model*/,
                  View<const Vec3d> x,
                  double scale,
                  View<const double> diagonal,
                  View<Vec3d> gradient,
                  BlockMatrix<Exec>& matrix,
                  bool project = true,
                  LaneDispatch dispatch = lane_dispatch()) const {
        [[maybe_unused]] const auto threads = exec.stand_by();
        const detail::SumOutput out{
            matrix.mutable_values().data, diagonal.data, gradient.data};
        for (int c = 0; c < partition_.num_colours(); ++c) {
            const int first = partition_.colour_begin[static_cast<std::size_t>(c)];
            const int last = partition_.colour_begin[static_cast<std::size_t>(c) + 1];
            constexpr int kBlocksPerTask = 1;
            exec.for_each(
                "objective/coloured_elasticity",
                last - first,
                [&](int b) { add_block(first + b, x, scale, project, out, dispatch); },
                kBlocksPerTask);
        }
        for (const int row : sums_.untouched) {
            const double d = diagonal[row];
            out.values[matrix.diagonal()[row]] = {d, 0, 0, 0, d, 0, 0, 0, d};
        }
    }

    [[nodiscard]] const ElementPartition& partition() const { return partition_; }

  private:
    void add_block(int b,
                   View<const Vec3d> x,
                   double scale,
                   bool project,
                   const detail::SumOutput& out,
                   LaneDispatch dispatch) const {
        const auto k = static_cast<std::size_t>(b);
        const int group = sums_.group_begin[k];
        const int* kind_begin = &sums_.kind_begin[k * sum_kind::kCount];
        const detail::TetBlock block{
            &groups_[static_cast<std::size_t>(group)],
            &sums_.slot[static_cast<std::size_t>(group) * kElementGroup
                        * kBlocksPerElement],
            partition_.block_begin[k + 1] - partition_.block_begin[k],
            kind_begin,
            &sums_.target[static_cast<std::size_t>(*kind_begin)]};
        const auto run = [&](const auto& kernel) { call_with_packs(dispatch, kernel); };
        switch (static_cast<ElasticModel>(partition_.block_range[k])) {
            case ElasticModel::StableNeoHookean:
                return run(detail::TetBlockKernel<ElasticModel::StableNeoHookean>{
                    block, x, scale, project, out});
            case ElasticModel::NeoHookean:
                return run(detail::TetBlockKernel<ElasticModel::NeoHookean>{
                    block, x, scale, project, out});
            case ElasticModel::FixedCorotated:
                return run(detail::TetBlockKernel<ElasticModel::FixedCorotated>{
                    block, x, scale, project, out});
        }
    }

    ElementPartition partition_;
    ElementSums sums_;
    std::vector<TetGroup> groups_;
};

}  // namespace noli
