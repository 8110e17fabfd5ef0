// SPDX-License-Identifier: Apache-2.0
/// The preconditioners of DevicePcg against dense algebra.
#include "linear/rigid_coarse.hpp"
#include "linear/schwarz_banks.hpp"
#include "random_system.hpp"

#include <numeric>

namespace noli {
namespace {

using namespace test;

/// A random system with contact terms, fixed vertices and positions of its own.
class DevicePreconditioner : public testing::Test {
  protected:
    static constexpr int kNumVertices = 171;

    DevicePreconditioner() {
        fixed[2] = fixed[50] = fixed[170] = 1;
        for (int i = 0; i < kNumVertices; ++i)
            if (fixed[static_cast<std::size_t>(i)] != 0) {
                dense.middleRows(3 * i, 3).setZero();
                dense.middleCols(3 * i, 3).setZero();
            }
        std::iota(order.begin(), order.end(), 0);
        aggregates = cut_aggregates(s.elements, order, 8);
        state.resize(1);
        state.view()[0] = PcgState{};
        rows = operator_rows(
            exec, loaded.matrix, loaded.terms, view_of(fixed), touched_index);
    }

    /// Z_l written from the definition: translations, and turns about the origin.
    [[nodiscard]] Eigen::MatrixXd motions(int group) const {
        const int nodes = (aggregates.count + group - 1) / group;
        Eigen::MatrixXd z = Eigen::MatrixXd::Zero(3 * kNumVertices, 6 * nodes);
        for (int i = 0; i < kNumVertices; ++i) {
            const int a = aggregates.of_vertex[static_cast<std::size_t>(i)];
            if (a < 0 || fixed[static_cast<std::size_t>(i)] != 0) continue;
            const Vec3d& at = x[static_cast<std::size_t>(i)];
            for (int k = 0; k < 3; ++k) {
                z(3 * i + k, 6 * (a / group) + k) = 1.0;
                z.block<3, 1>(3 * i, 6 * (a / group) + 3 + k) =
                    Eigen::Vector3d::Unit(k).cross(Eigen::Vector3d(at.x, at.y, at.z));
            }
        }
        return z;
    }

    /// Z B⁻¹ Zᵀ r, B the diagonal blocks of Zᵀ A Z with `nodes_per_block` nodes each.
    [[nodiscard]] Eigen::VectorXd expected(int group, int nodes_per_block) const {
        const Eigen::MatrixXd z = motions(group);
        const Eigen::MatrixXd coarse = z.transpose() * dense * z;
        const Eigen::VectorXd force = z.transpose() * to_eigen(r);
        Eigen::VectorXd motion = Eigen::VectorXd::Zero(force.size());
        for (Eigen::Index at = 0; at < force.size(); at += 6 * nodes_per_block) {
            const Eigen::Index n =
                std::min<Eigen::Index>(6 * nodes_per_block, force.size() - at);
            motion.segment(at, n) =
                coarse.block(at, at, n, n).ldlt().solve(force.segment(at, n));
        }
        return z * motion;
    }

    [[nodiscard]] Eigen::VectorXd correction(int most_dense_nodes) {
        RigidCoarse<ShuffledExec> coarse;
        ShuffledExec shuffled;
        BlockMatrix<ShuffledExec> matrix;
        LowRankTerms<ShuffledExec> terms;
        auto here = load(shuffled, s);
        HostBuffer<int> index;
        coarse.set_aggregates(aggregates, most_dense_nodes);
        coarse.build(
            shuffled,
            operator_rows(shuffled, here.matrix, here.terms, view_of(fixed), index),
            view_of(fixed),
            view_of(x));
        coarse.solve(shuffled, state.view(), view_of(r));
        std::vector<Vec3d> out(r.size(), Vec3d{0, 0, 0});
        for (int i = 0; i < kNumVertices; ++i)
            if (fixed[static_cast<std::size_t>(i)] == 0)
                out[static_cast<std::size_t>(i)] = coarse.correction().at(i);
        return to_eigen(out);
    }

    RandomSystem s = random_system(kNumVertices, 480, 70, 5);
    Eigen::MatrixXd dense = dense_elements(s) + dense_terms(s);
    SerialExec exec;
    LoadedSystem<SerialExec> loaded = load(exec, s);
    std::vector<Vec3d> r = random_vector(kNumVertices, 3);
    std::vector<Vec3d> x = random_vector(kNumVertices, 4);
    std::vector<std::uint8_t> fixed = std::vector<std::uint8_t>(kNumVertices, 0);
    std::vector<int> order = std::vector<int>(kNumVertices);
    RigidAggregates aggregates;
    HostBuffer<PcgState> state;
    HostBuffer<int> touched_index;
    OperatorRows rows{};
};

TEST_F(DevicePreconditioner, OneLevelIsTheExactCoarseCorrection) {
    const Eigen::VectorXd got = correction(kMostDenseNodes);
    const Eigen::VectorXd want = expected(1, aggregates.count);
    EXPECT_LT((got - want).norm(), 1e-9 * want.norm());
}

TEST_F(DevicePreconditioner, TwoLevelsAddBlocksOfAggregatesAndGroupsOfThem) {
    for (const int most : {7, 3, 1}) {
        const int group = (aggregates.count + most - 1) / most;
        ASSERT_GT(group, 1);
        const Eigen::VectorXd got = correction(most);
        const Eigen::VectorXd want =
            expected(1, kNodesPerBlock) + expected(group, aggregates.count);
        EXPECT_LT((got - want).norm(), 1e-9 * want.norm()) << most;
    }
}

TEST_F(DevicePreconditioner, BanksAreTheInversesOfDiagonalBlocks) {
    SchwarzBanks<SerialExec> banks;
    std::vector<int> backwards(order.rbegin(), order.rend());
    banks.set_order(backwards);
    banks.build(exec, rows);
    std::vector<Vec3d> z(r.size());
    banks.apply(exec, state.view(), view_of(r), view_of(z));
    for (int first = 0; first < kNumVertices; first += kBankVertices) {
        const int count = std::min(kBankVertices, kNumVertices - first);
        // In the order of the vertices: those of this bank are a run, backwards.
        const int low = kNumVertices - first - count;
        Eigen::MatrixXd block = dense.block(3 * low, 3 * low, 3 * count, 3 * count);
        Eigen::VectorXd rhs = to_eigen(r).segment(3 * low, 3 * count);
        for (int i = 0; i < 3 * count; ++i)
            if (fixed[static_cast<std::size_t>(low + i / 3)] != 0) {
                block(i, i) = 1.0;
                rhs[i] = 0.0;
            }
        const Eigen::VectorXd want = block.ldlt().solve(rhs);
        const Eigen::VectorXd got = to_eigen(z).segment(3 * low, 3 * count);
        EXPECT_LT((got - want).norm(), 1e-9 * want.norm()) << first;
    }
}

TEST_F(DevicePreconditioner, DoesNothingOnceTheSolverHasEnded) {
    SchwarzBanks<SerialExec> banks;
    banks.build(exec, rows);
    state.view()[0].skip = true;
    std::vector<Vec3d> z(r.size(), Vec3d{7, 8, 9});
    banks.apply(exec, state.view(), view_of(r), view_of(z));
    for (const Vec3d& at : z)
        EXPECT_EQ(at.x + at.y + at.z, 24.0);
}

}  // namespace
}  // namespace noli
