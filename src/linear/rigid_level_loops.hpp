// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Loops over the nodes of one coarse level: frames, coarse matrix, and the transfer of
/// forces and motions between vertices, nodes and nodes of nodes. Gathers only.

#include "linear/block_inverse.hpp"
#include "linear/operator_rows.hpp"
#include "linear/pcg_state.hpp"
#include "linear/rigid_motion.hpp"

namespace noli::detail {

/// A level as kernels see it.
struct RigidLevelView {
    View<const int> node_of_vertex;
    View<const int> member_begin, members;
    View<const RigidFrame> frames;
    int nodes_per_block;

    [[nodiscard]] NOLI_HD int num_nodes() const { return member_begin.size - 1; }
    [[nodiscard]] NOLI_HD int block_of(int node) const { return node / nodes_per_block; }
    /// Unknowns of a block.
    [[nodiscard]] NOLI_HD int block_size() const { return kRigidModes * nodes_per_block; }
    /// First unknown of a node in its block.
    [[nodiscard]] NOLI_HD int unknown_of(int node) const {
        return kRigidModes * (node % nodes_per_block);
    }
};

NOLI_HD inline RigidMotion load_motion(View<const double> from, int node) {
    const double* a = &from[kRigidModes * node];
    return {{a[0], a[1], a[2]}, {a[3], a[4], a[5]}};
}
NOLI_HD inline void store_motion(const RigidMotion& motion, int node, View<double> to) {
    for (int m = 0; m < kRigidModes; ++m)
        to[kRigidModes * node + m] = motion[m];
}

/// Frames from the free vertices of each node.
template <class Exec>
void node_frames(Exec& exec,
                 View<const int> member_begin,
                 View<const int> members,
                 View<const std::uint8_t> fixed,
                 View<const Vec3d> x,
                 View<RigidFrame> frames) {
    exec.for_each(
        "linear/node_frames",
        frames.size,
        [=] NOLI_HD(int node) {
            RigidFrame frame{{0, 0, 0}, 0.0, 0.0};
            for (int k = member_begin[node]; k < member_begin[node + 1]; ++k) {
                if (fixed[members[k]] != 0) continue;
                frame.centre += x[members[k]];
                frame.count += 1.0;
            }
            if (frame.count > 0.0) frame.centre = (1.0 / frame.count) * frame.centre;
            double spread = 0.0;
            for (int k = member_begin[node]; k < member_begin[node + 1]; ++k)
                if (fixed[members[k]] == 0)
                    spread += norm_sq(x[members[k]] - frame.centre);
            frame.per_radius = spread > 0.0 ? std::sqrt(frame.count / spread) : 0.0;
            frames[node] = frame;
        },
        8);
}

/// Frames of nodes that consist of `group` consecutive nodes of the level below.
template <class Exec>
void group_frames(Exec& exec,
                  View<const RigidFrame> parts,
                  int group,
                  View<RigidFrame> frames) {
    exec.for_each(
        "linear/group_frames",
        frames.size,
        [=] NOLI_HD(int node) {
            const int begin = node * group;
            const int end = begin + group < parts.size ? begin + group : parts.size;
            RigidFrame frame{{0, 0, 0}, 0.0, 0.0};
            for (int p = begin; p < end; ++p) {
                frame.centre += parts[p].count * parts[p].centre;
                frame.count += parts[p].count;
            }
            if (frame.count > 0.0) frame.centre = (1.0 / frame.count) * frame.centre;
            double spread = 0.0;
            for (int p = begin; p < end; ++p) {
                const double radius =
                    parts[p].per_radius > 0.0 ? 1.0 / parts[p].per_radius : 0.0;
                spread += parts[p].count
                        * (norm_sq(parts[p].centre - frame.centre) + radius * radius);
            }
            frame.per_radius = spread > 0.0 ? std::sqrt(frame.count / spread) : 0.0;
            frames[node] = frame;
        },
        8);
}

/// Adds what one vertex contributes to one row of the coarse matrix.
struct CoarseRowVisit {
    const RigidLevelView& level;
    View<const Vec3d> x;
    int block;
    double* row;

    NOLI_HD void operator()(int j, const Vec3d& force) const {
        const int node = level.node_of_vertex[j];
        if (node < 0 || level.block_of(node) != block) return;
        const RigidMotion add = generalised_force(level.frames[node], force, x[j]);
        double* to = row + level.unknown_of(node);
        for (int m = 0; m < kRigidModes; ++m)
            to[m] += add[m];
    }
};

/// parts.at(chunk * num_blocks + block): share of the coarse matrix that comes from one
/// chunk of the members of each node. Rows of places without a node are 0.
template <class Exec>
void coarse_rows(Exec& exec,
                 OperatorRows op,
                 RigidLevelView level,
                 View<const Vec3d> x,
                 int num_blocks,
                 int num_chunks,
                 DenseMatrices parts) {
    exec.for_each(
        "linear/coarse_rows",
        num_chunks * num_blocks * level.block_size(),
        [=] NOLI_HD(int index) {
            const int matrix = index / level.block_size();
            const int r = index % level.block_size();
            const int chunk = matrix / num_blocks;
            const int block = matrix % num_blocks;
            const int node = block * level.nodes_per_block + r / kRigidModes;
            double* row = &parts.at(matrix, r, 0);
            for (int c = 0; c < parts.size; ++c)
                row[c] = 0.0;
            if (node >= level.num_nodes()) return;
            const RigidMotion motion = unit_motion(r % kRigidModes);
            CoarseRowVisit visit{level, x, block, row};
            for (int k = level.member_begin[node] + chunk;
                 k < level.member_begin[node + 1];
                 k += num_chunks) {
                const int i = level.members[k];
                if (op.fixed[i] != 0) continue;
                op.visit_row(i, displacement(level.frames[node], motion, x[i]), visit);
            }
        },
        4);
}

/// out = sum of `num_chunks` arrays of its size, in order.
template <class Exec>
void sum_chunks(Exec& exec, View<const double> parts, int num_chunks, View<double> out) {
    exec.for_each(
        "linear/sum_chunks",
        out.size,
        [=] NOLI_HD(int e) {
            double sum = 0.0;
            for (int c = 0; c < num_chunks; ++c)
                sum += parts[c * out.size + e];
            out[e] = sum;
        },
        1024);
}

/// forces[node] = Zᵀ r over its free vertices; 0 for places without a node.
template <class Exec>
void restrict_to_nodes(Exec& exec,
                       View<const PcgState> state,
                       RigidLevelView level,
                       View<const std::uint8_t> fixed,
                       View<const Vec3d> x,
                       View<const Vec3d> r,
                       View<double> forces) {
    exec.for_each(
        "linear/restrict_to_nodes",
        forces.size / kRigidModes,
        [=] NOLI_HD(int node) {
            if (state[0].skip) return;
            RigidMotion sum{{0, 0, 0}, {0, 0, 0}};
            const bool used = node < level.num_nodes();
            const int begin = used ? level.member_begin[node] : 0;
            const int end = used ? level.member_begin[node + 1] : 0;
            for (int k = begin; k < end; ++k) {
                const int v = level.members[k];
                if (fixed[v] != 0) continue;
                const RigidMotion add = generalised_force(level.frames[node], r[v], x[v]);
                sum.t += add.t;
                sum.w += add.w;
            }
            store_motion(sum, node, forces);
        },
        8);
}

/// The same from the forces of the level below, `group` nodes to each.
template <class Exec>
void restrict_to_groups(Exec& exec,
                        View<const PcgState> state,
                        View<const RigidFrame> part_frames,
                        View<const double> part_forces,
                        int group,
                        View<const RigidFrame> frames,
                        View<double> forces) {
    exec.for_each(
        "linear/restrict_to_groups",
        frames.size,
        [=] NOLI_HD(int node) {
            if (state[0].skip) return;
            const int begin = node * group;
            const int end =
                begin + group < part_frames.size ? begin + group : part_frames.size;
            RigidMotion sum{{0, 0, 0}, {0, 0, 0}};
            for (int p = begin; p < end; ++p) {
                const RigidMotion add = force_on_whole(
                    frames[node], load_motion(part_forces, p), part_frames[p]);
                sum.t += add.t;
                sum.w += add.w;
            }
            store_motion(sum, node, forces);
        },
        8);
}

/// out = inverse times in, block by block.
template <class Exec>
void apply_inverse(Exec& exec,
                   View<const PcgState> state,
                   DenseMatrices inverse,
                   View<const double> in,
                   View<double> out) {
    exec.for_each(
        "linear/apply_inverse",
        out.size,
        [=] NOLI_HD(int r) {
            if (state[0].skip) return;
            const int matrix = r / inverse.size;
            const int row = r % inverse.size;
            const double* from = &in[matrix * inverse.size];
            double sum = 0.0;
            // By columns of the symmetric matrix: neighbours read neighbours.
            for (int k = 0; k < inverse.size; ++k)
                sum += inverse.at(matrix, k, row) * from[k];
            out[r] = sum;
        },
        32);
}

}  // namespace noli::detail
