// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Rigid motions of aggregates, added to a local preconditioner P of a device:
///
///     P⁻¹ + sum over the levels of Z_l B_l⁻¹ Z_lᵀ
///
/// Z_l holds the six rigid motions of each node of level l, B_l the diagonal blocks (16
/// nodes, 96 unknowns each) of Z_lᵀ A Z_l, contacts included; on the last level there is
/// one block, so that B is exact there. All inverses are dense: an application is a
/// handful of loops with much to do in parallel, and none needs the host.
///
/// Source: additive Schwarz with a coarse space, [Saad2003] 14.3; rigid modes,
/// [Vanek1996]. Why not more levels, and other ways: docs/decisions/008-device-solver.md.

#include "linear/rigid_level_loops.hpp"
#include "linear/rigid_levels.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace noli {

template <class Exec>
class RigidCoarse {
  public:
    template <class T>
    using Buffer = typename Exec::template Buffer<T>;

    /// Uploads when it is next built.
    void set_aggregates(const RigidAggregates& aggregates,
                        int most_dense_nodes = kMostDenseNodes) {
        host_ = make_rigid_levels(aggregates, most_dense_nodes);
        is_uploaded_ = false;
    }
    [[nodiscard]] bool available() const { return !host_.levels.empty(); }

    /// Frames at the positions x and the inverses of the coarse matrices.
    void build(Exec& exec,
               const OperatorRows& op,
               View<const std::uint8_t> fixed,
               View<const Vec3d> x) {
        if (!is_uploaded_) upload(exec);
        is_uploaded_ = true;
        x_ = x;
        fixed_ = fixed;
        detail::node_frames(exec,
                            View<const int>(levels_[0].member_begin.view()),
                            View<const int>(levels_[0].members.view()),
                            fixed,
                            x,
                            levels_[0].frames.view());
        if (levels_.size() > 1)
            detail::group_frames(exec,
                                 View<const RigidFrame>(levels_[0].frames.view()),
                                 host_.group,
                                 levels_[1].frames.view());
        for (std::size_t l = 0; l < levels_.size(); ++l)
            build_level(exec, op, l);
    }

    /// Coarse corrections of r, to be added by `correction`.
    void solve(Exec& exec, View<const PcgState> state, View<const Vec3d> r) {
        detail::restrict_to_nodes(
            exec, state, view(0), fixed_, x_, r, levels_[0].force.view());
        if (levels_.size() > 1)
            detail::restrict_to_groups(exec,
                                       state,
                                       View<const RigidFrame>(levels_[0].frames.view()),
                                       View<const double>(levels_[0].force.view()),
                                       host_.group,
                                       View<const RigidFrame>(levels_[1].frames.view()),
                                       levels_[1].force.view());
        for (Level& level : levels_)
            detail::apply_inverse(exec,
                                  state,
                                  level.inverse.matrices(),
                                  View<const double>(level.force.view()),
                                  level.motion.view());
    }

    /// What `solve` found, per vertex.
    struct Correction {
        detail::RigidLevelView level[2];
        View<const double> motion[2];
        int count;  ///< of levels
        View<const Vec3d> x;

        /// At a free vertex.
        [[nodiscard]] NOLI_HD Vec3d at(int vertex) const {
            Vec3d sum{0, 0, 0};
            for (int l = 0; l < count; ++l) {
                const int node = level[l].node_of_vertex[vertex];
                if (node >= 0)
                    sum += displacement(level[l].frames[node],
                                        detail::load_motion(motion[l], node),
                                        x[vertex]);
            }
            return sum;
        }
    };
    [[nodiscard]] Correction correction() {
        Correction out{{}, {}, static_cast<int>(levels_.size()), x_};
        for (std::size_t l = 0; l < levels_.size(); ++l) {
            out.level[l] = view(l);
            out.motion[l] = levels_[l].motion.view();
        }
        return out;
    }

  private:
    static constexpr int kMostChunks = 16;       ///< of the members of a node
    static constexpr int kMembersPerChunk = 64;  ///< about
    struct Level {
        Buffer<int> node_of_vertex, member_begin, members;
        Buffer<RigidFrame> frames;
        Buffer<double> parts;  ///< of the coarse matrix
        Buffer<double> force, motion;
        BlockInverse<Exec> inverse;
        int num_chunks = 1;
    };

    void upload(Exec& exec) {
        levels_.resize(host_.levels.size());
        for (std::size_t l = 0; l < levels_.size(); ++l) {
            const RigidLevel& from = host_.levels[l];
            Level& to = levels_[l];
            exec.upload(from.node_of_vertex, to.node_of_vertex);
            exec.upload(from.member_begin, to.member_begin);
            exec.upload(from.members, to.members);
            to.frames.resize(from.num_nodes());
            const int size = kRigidModes * from.nodes_per_block;
            to.inverse.resize(from.num_blocks(), size);
            to.force.resize(from.num_blocks() * size);
            to.motion.resize(from.num_blocks() * size);
            const int mean = static_cast<int>(from.members.size()) / from.num_nodes();
            to.num_chunks = std::clamp(mean / kMembersPerChunk, 1, kMostChunks);
            if (to.num_chunks > 1)
                to.parts.resize(to.num_chunks * from.num_blocks() * size * size);
        }
    }

    void build_level(Exec& exec, const OperatorRows& op, std::size_t l) {
        Level& level = levels_[l];
        const DenseMatrices out = level.inverse.matrices();
        const int num_blocks = host_.levels[l].num_blocks();
        DenseMatrices parts = out;
        if (level.num_chunks > 1) {
            parts.values = level.parts.view();
            parts.count = level.num_chunks * num_blocks;
        }
        detail::coarse_rows(exec, op, view(l), x_, num_blocks, level.num_chunks, parts);
        if (level.num_chunks > 1)
            detail::sum_chunks(
                exec, View<const double>(parts.values), level.num_chunks, out.values);
        level.inverse.invert(exec);
    }

    [[nodiscard]] detail::RigidLevelView view(std::size_t l) {
        const Level& level = levels_[l];
        return {level.node_of_vertex.view(),
                level.member_begin.view(),
                level.members.view(),
                level.frames.view(),
                host_.levels[l].nodes_per_block};
    }

    RigidLevels host_;
    bool is_uploaded_ = false;
    std::vector<Level> levels_;
    View<const Vec3d> x_{};
    View<const std::uint8_t> fixed_{};
};

}  // namespace noli
