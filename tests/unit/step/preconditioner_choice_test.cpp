// SPDX-License-Identifier: Apache-2.0
#include "step/preconditioner_choice.hpp"

#include <gtest/gtest.h>

namespace noli {
namespace {

constexpr auto kSweeps = PreconditionerKind::GaussSeidel;
constexpr auto kJacobi = PreconditionerKind::BlockJacobi;

TEST(PreconditionerChoice, TakesBlockJacobiWhileSolvesAreShort) {
    PreconditionerChoice choice;
    EXPECT_EQ(choice.kind(), kSweeps);
    choice.after_solve(12);  // 24 of block Jacobi would take as long, setup included
    EXPECT_EQ(choice.kind(), kSweeps);
    choice.after_solve(11);
    EXPECT_EQ(choice.kind(), kJacobi);
    choice.after_solve(23);
    EXPECT_EQ(choice.kind(), kJacobi);
    choice.after_solve(24);
    EXPECT_EQ(choice.kind(), kSweeps);
}

TEST(PreconditionerChoice, BeginsEveryStepAnew) {
    PreconditionerChoice choice;
    choice.after_solve(3);
    ASSERT_EQ(choice.kind(), kJacobi);
    choice.begin_step();
    EXPECT_EQ(choice.kind(), kSweeps);
}

}  // namespace
}  // namespace noli
