// SPDX-License-Identifier: Apache-2.0
#include "noli/scene.hpp"

#include <gtest/gtest.h>

namespace noli {
namespace {

TEST(ValueNames, AreThoseOfTheSceneFormatInItsOrder) {
    EXPECT_EQ(value_names<LinearSolver>(),
              (std::vector<std::string>{
                  "pcg", "cholmod", "block_jacobi", "incomplete_cholesky"}));
    EXPECT_EQ(value_names<Integrator>(),
              (std::vector<std::string>{"implicit_euler", "bdf2", "newmark"}));
    EXPECT_EQ(value_names<ContactModel>(),
              (std::vector<std::string>{"gn", "gn+", "exact", "numeric"}));
    EXPECT_EQ(value_names<MollifierModel>(),
              (std::vector<std::string>{"two_mode", "four_mode", "exact"}));
}

TEST(ValueNamed, FindsTheValueOfAName) {
    EXPECT_EQ(value_named<LinearSolver>("block_jacobi"), LinearSolver::BlockJacobi);
    EXPECT_EQ(value_named<Integrator>("newmark"), Integrator::Newmark);
    EXPECT_EQ(value_named<ContactModel>("gn+"), ContactModel::GnPlus);
    EXPECT_EQ(value_named<MollifierModel>("exact"), MollifierModel::Exact);
}

TEST(ValueNamed, FindsNothingForOtherWords) {
    EXPECT_FALSE(value_named<LinearSolver>(""));
    EXPECT_FALSE(value_named<LinearSolver>("magic"));
    EXPECT_FALSE(value_named<MollifierModel>("gn"));
}

}  // namespace
}  // namespace noli
