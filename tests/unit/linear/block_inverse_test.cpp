// SPDX-License-Identifier: Apache-2.0
#include "linear/block_inverse.hpp"

#include "exec/cpu.hpp"
#include "random_system.hpp"

namespace noli {
namespace {

using namespace test;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

RowMajor random_spd(int size, int rank, int seed) {
    std::mt19937 rng(static_cast<unsigned>(seed));
    std::normal_distribution<double> normal;
    Eigen::MatrixXd half(size, rank);
    for (double& h : half.reshaped())
        h = normal(rng);
    return half * half.transpose();
}

template <class Exec>
std::vector<RowMajor> inverses(const std::vector<RowMajor>& of) {
    Exec exec;
    BlockInverse<Exec> inverse;
    const auto size = static_cast<int>(of[0].rows());
    inverse.resize(static_cast<int>(of.size()), size);
    double* to = inverse.matrices().values.data;
    for (const RowMajor& m : of)
        to = std::copy_n(m.data(), m.size(), to);
    inverse.invert(exec);
    std::vector<RowMajor> out;
    for (std::size_t k = 0; k < of.size(); ++k)
        out.emplace_back(Eigen::Map<const RowMajor>(
            &inverse.matrices().at(static_cast<int>(k), 0, 0), size, size));
    return out;
}

TEST(BlockInverse, InvertsManyMatricesAtOnce) {
    for (const int size : {6, 12, 96}) {
        std::vector<RowMajor> all;
        for (int seed = 0; seed < 5; ++seed)
            all.push_back(random_spd(size, 2 * size, seed));
        const auto got = inverses<CpuExec>(all);
        for (std::size_t k = 0; k < all.size(); ++k)
            EXPECT_LT((got[k] * all[k] - RowMajor::Identity(size, size)).norm(),
                      1e-9 * size)
                << size;
    }
}

TEST(BlockInverse, LeavesOutDirectionsWithoutStiffness) {
    // The leading block has an inverse, unknowns 8 to 17 have no stiffness at all, and
    // unknown 5 is a copy of unknown 4.
    RowMajor a = RowMajor::Zero(18, 18);
    a.topLeftCorner(8, 8) = random_spd(8, 16, 3);
    a.row(5) = a.row(4);
    a.col(5) = a.col(4);
    const RowMajor inverse = inverses<SerialExec>({a})[0];
    EXPECT_TRUE(inverse.allFinite());
    EXPECT_EQ(inverse.bottomRightCorner(10, 10).norm(), 0.0);
    EXPECT_LT((a * inverse * a - a).norm(), 1e-9 * a.norm());  // a generalised inverse
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spectrum(inverse);
    EXPECT_GE(spectrum.eigenvalues().minCoeff(), -1e-12 * inverse.norm());
}

TEST(BlockInverse, HasTheSameBitsOnEveryExecutor) {
    std::vector<RowMajor> all;
    for (int seed = 0; seed < 7; ++seed)
        all.push_back(random_spd(96, seed < 2 ? 40 : 150, seed));
    const auto reference = inverses<SerialExec>(all);
    const auto cpu = inverses<CpuExec>(all);
    const auto shuffled = inverses<ShuffledExec>(all);
    for (std::size_t k = 0; k < all.size(); ++k) {
        EXPECT_TRUE((cpu[k].array() == reference[k].array()).all());
        EXPECT_TRUE((shuffled[k].array() == reference[k].array()).all());
    }
}

}  // namespace
}  // namespace noli
