// SPDX-License-Identifier: Apache-2.0
#include "linear/low_rank.hpp"

#include "random_system.hpp"

#include <tbb/global_control.h>

namespace noli {
namespace {

using namespace test;

template <class Exec>
class LowRankTermsOn : public testing::Test {
  public:
    Exec exec;
};
using Executors = testing::Types<SerialExec, CpuExec, ShuffledExec>;
TYPED_TEST_SUITE(LowRankTermsOn, Executors);

TYPED_TEST(LowRankTermsOn, MultiplyAddMatchesDenseMatrix) {
    for (const int terms : {1, 5, 33, 250}) {
        const RandomSystem s = random_system(61, 0, terms, terms);
        auto loaded = load(this->exec, s);
        const auto x = random_vector(61, 1);
        auto y = random_vector(61, 2);
        const Eigen::VectorXd expected = to_eigen(y) + dense_terms(s) * to_eigen(x);
        loaded.terms.multiply_add(this->exec, view_of(x), view_of(y));
        EXPECT_LT((to_eigen(y) - expected).norm(), 1e-13 * expected.norm()) << terms;
        const double form = to_eigen(x).dot(dense_terms(s) * to_eigen(x));
        EXPECT_NEAR(loaded.terms.quadratic_form(this->exec, view_of(x)),
                    form,
                    1e-12 * form + 1e-300);
    }
}

TYPED_TEST(LowRankTermsOn, AddDiagonalMatchesDenseMatrix) {
    const RandomSystem s = random_system(47, 0, 90, 3);
    const auto loaded = load(this->exec, s);
    const Eigen::MatrixXd dense = dense_terms(s);
    std::vector<Mat3d> blocks(47, identity3());
    loaded.terms.add_diagonal(this->exec, view_of(blocks));
    for (int i = 0; i < 47; ++i)
        for (int k = 0; k < 9; ++k)
            EXPECT_NEAR(blocks[static_cast<std::size_t>(i)].a[k],
                        dense(3 * i + k / 3, 3 * i + k % 3) + (k % 4 == 0 ? 1.0 : 0.0),
                        1e-11);
}

TYPED_TEST(LowRankTermsOn, IncidenceListsEverySlotOfEachTouchedVertexInOrder) {
    const RandomSystem s = random_system(500, 0, 77, 4);
    const auto loaded = load(this->exec, s);
    const auto touched = loaded.terms.touched();
    const auto begin = loaded.terms.touched_begin();
    const auto slots = loaded.terms.slots();
    std::vector<std::vector<int>> expected(500);
    for (int t = 0; t < 77; ++t)
        for (int k = 0; k < 4; ++k)
            if (const int v = s.term_vertices[static_cast<std::size_t>(t)][k]; v >= 0)
                expected[static_cast<std::size_t>(v)].push_back(4 * t + k);
    int i = 0;
    for (int v = 0; v < 500; ++v) {
        const auto& list = expected[static_cast<std::size_t>(v)];
        if (list.empty()) continue;
        ASSERT_LT(i, touched.size);
        EXPECT_EQ(touched[i], v);
        EXPECT_EQ(
            std::vector<int>(slots.begin() + begin[i], slots.begin() + begin[i + 1]),
            list);
        ++i;
    }
    EXPECT_EQ(i, touched.size);
}

TYPED_TEST(LowRankTermsOn, GatherAddSumsSlotsOfEachVertex) {
    const RandomSystem s = random_system(30, 0, 41, 5);
    const auto loaded = load(this->exec, s);
    const auto per_slot = random_vector(4 * 41, 6);
    std::vector<Vec3d> y(30, Vec3d{1, 2, 3});
    std::vector<Vec3d> expected = y;
    for (int t = 0; t < 41; ++t)
        for (int k = 0; k < 4; ++k)
            if (const int v = s.term_vertices[static_cast<std::size_t>(t)][k]; v >= 0)
                expected[static_cast<std::size_t>(v)] +=
                    per_slot[static_cast<std::size_t>(4 * t + k)];
    loaded.terms.gather_add(this->exec, view_of(per_slot), view_of(y));
    EXPECT_LT((to_eigen(y) - to_eigen(expected)).norm(), 1e-13);
}

TYPED_TEST(LowRankTermsOn, WithoutTermsNothingIsAdded) {
    const RandomSystem s = random_system(9, 0, 0, 6);
    auto loaded = load(this->exec, s);
    const auto x = random_vector(9, 1);
    auto y = x;
    std::vector<Mat3d> blocks(9, identity3());
    loaded.terms.multiply_add(this->exec, view_of(x), view_of(y));
    loaded.terms.add_diagonal(this->exec, view_of(blocks));
    EXPECT_TRUE(same_bits(x, y));
    EXPECT_TRUE(same_bits(blocks, std::vector<Mat3d>(9, identity3())));
    EXPECT_EQ(loaded.terms.touched().size, 0);
}

TYPED_TEST(LowRankTermsOn, TermsWithoutUsedSlotsAreHarmless) {
    LowRankTerms<TypeParam> terms;
    terms.resize(1, 1);
    terms.vertices.view()[0] = {{-1, -1, -1, -1}};
    terms.first_mode.view()[0] = 0;
    terms.first_mode.view()[1] = 1;
    terms.modes.view()[0] = Mode{};
    terms.build_incidence(this->exec, 3);
    const auto x = random_vector(3, 1);
    auto y = x;
    terms.multiply_add(this->exec, view_of(x), view_of(y));
    EXPECT_TRUE(same_bits(x, y));
}

template <class Exec>
std::vector<Vec3d> fingerprint(const RandomSystem& s) {
    Exec exec;
    auto loaded = load(exec, s);
    const auto x = random_vector(s.num_vertices, 11);
    std::vector<Vec3d> y = x;
    loaded.terms.multiply_add(exec, view_of(x), view_of(y));
    std::vector<Mat3d> blocks(x.size(), identity3());
    loaded.terms.add_diagonal(exec, view_of(blocks));
    for (const Mat3d& b : blocks)
        y.push_back({b.a[0], b.a[5], b.a[7]});
    return y;
}

TEST(LowRankTerms, HaveTheSameBitsOnEveryExecutorAndThreadCount) {
    const RandomSystem s = random_system(701, 0, 3001, 6);
    const auto reference = fingerprint<SerialExec>(s);
    EXPECT_TRUE(same_bits(fingerprint<ShuffledExec>(s), reference));
    for (const std::size_t threads : {1, 2, 3, 4}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                        threads);
        EXPECT_TRUE(same_bits(fingerprint<CpuExec>(s), reference)) << threads;
    }
}

}  // namespace
}  // namespace noli
