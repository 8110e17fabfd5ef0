// SPDX-License-Identifier: Apache-2.0
/// When the iteration ends, against the errors that dense algebra knows.

#include "linear/pcg.hpp"
#include "random_system.hpp"

#include <gtest/gtest.h>

namespace noli {
namespace {

using namespace test;

constexpr std::size_t kDelay = 4;  ///< iterations that PcgStop looks back

/// A random system with its exact solution, and solves of it.
class Problem {
  public:
    explicit Problem(int seed, int num_vertices = 150)
        : system_(random_system(num_vertices, 3 * num_vertices, 40, seed)),
          loaded_(load(exec_, system_)),
          b_(random_vector(num_vertices, seed + 1)),
          fixed_(b_.size(), 0),
          dense_(dense_elements(system_) + dense_terms(system_)),
          exact_(dense_.llt().solve(to_eigen(b_))) {}

    PcgResult solve(const PcgOptions& options, std::vector<Vec3d>& x) {
        Pcg<SerialExec> pcg;
        const std::vector<int> order = every_vertex();
        pcg.set_aggregates(cut_aggregates(system_.elements, order, 16));
        x.resize(b_.size());
        return pcg.solve(exec_,
                         loaded_.matrix,
                         loaded_.terms,
                         view_of(b_),
                         view_of(fixed_),
                         options,
                         view_of(x));
    }

    void set_rhs_to_zero() { b_.assign(b_.size(), Vec3d{0, 0, 0}); }

    [[nodiscard]] double energy_norm_sq(const Eigen::VectorXd& v) const {
        return v.dot(dense_ * v);
    }
    [[nodiscard]] double error_sq(const std::vector<Vec3d>& x) const {
        return energy_norm_sq(to_eigen(x) - exact_);
    }
    [[nodiscard]] double relative_error(const std::vector<Vec3d>& x) const {
        return std::sqrt(error_sq(x) / energy_norm_sq(exact_));
    }

  private:
    [[nodiscard]] std::vector<int> every_vertex() const {
        std::vector<int> order(b_.size());
        std::iota(order.begin(), order.end(), 0);
        return order;
    }

    SerialExec exec_;
    RandomSystem system_;
    LoadedSystem<SerialExec> loaded_;
    std::vector<Vec3d> b_;
    std::vector<std::uint8_t> fixed_;
    Eigen::MatrixXd dense_;
    Eigen::VectorXd exact_;
};

struct Way {
    const char* name;
    PreconditionerKind kind;
    bool coarse;
};

class StopWith : public testing::TestWithParam<Way> {
  protected:
    PcgOptions options(PcgOptions::Test test, double tolerance) const {
        PcgOptions out;
        out.test = test;
        out.tolerance = tolerance;
        out.preconditioner = GetParam().kind;
        if (GetParam().coarse) out.positions = view_of(positions_);
        return out;
    }

    std::vector<Vec3d> positions_ = random_vector(150, 77);
};
INSTANTIATE_TEST_SUITE_P(
    ,
    StopWith,
    testing::Values(Way{"BlockJacobi", PreconditionerKind::BlockJacobi, false},
                    Way{"GaussSeidel", PreconditionerKind::GaussSeidel, false},
                    Way{"CoarseSpace", PreconditionerKind::GaussSeidel, true}),
    [](const auto& test) { return std::string(test.param.name); });

TEST_P(StopWith, EndsWhereTheEnergyOfTheLastIterationsSaysSo) {
    for (const int seed : {1, 2, 3}) {
        Problem problem(seed);
        for (const double tolerance : {1e-2, 1e-4, 1e-7}) {
            std::vector<Vec3d> x;
            const PcgResult got =
                problem.solve(options(PcgOptions::Test::Energy, tolerance), x);
            EXPECT_EQ(got.outcome, PcgResult::Outcome::Converged);

            // From x = 0 the energy is -|x|_A^2 / 2 in every iterate.
            std::vector<double> norm_sq(1, 0.0);
            int expected = 0;
            while (expected == 0) {
                const std::size_t k = norm_sq.size();
                ASSERT_LT(k, 400u);
                PcgOptions fixed_count = options(PcgOptions::Test::Residual, 1e-30);
                fixed_count.max_iterations = static_cast<int>(k);
                problem.solve(fixed_count, x);
                norm_sq.push_back(problem.energy_norm_sq(to_eigen(x)));
                if (k < kDelay) continue;
                const double recent = norm_sq.back() - norm_sq[k - kDelay];
                if (recent <= tolerance * norm_sq.back()) expected = static_cast<int>(k);
            }
            EXPECT_EQ(got.iterations, expected) << seed << " " << tolerance;
        }
    }
}

TEST_P(StopWith, LeavesAFewPercentOfErrorAtTheUsualTolerance) {
    for (int seed = 1; seed <= 8; ++seed) {
        Problem problem(seed);
        std::vector<Vec3d> x;
        const PcgResult got = problem.solve(options(PcgOptions::Test::Energy, 1e-4), x);
        EXPECT_EQ(got.outcome, PcgResult::Outcome::Converged);
        EXPECT_LT(problem.relative_error(x), 0.03) << seed;
    }
}

TEST_P(StopWith, AsksOnceWhetherToRefineAndThenGoesOn) {
    Problem problem(4);
    for (const auto test : {PcgOptions::Test::Residual, PcgOptions::Test::Energy}) {
        std::vector<Vec3d> coarse, fine, got, seen;
        const PcgResult at_coarse = problem.solve(options(test, 1e-2), coarse);
        const PcgResult at_fine = problem.solve(options(test, 1e-8), fine);
        ASSERT_LT(at_coarse.iterations, at_fine.iterations);

        PcgOptions refined = options(test, 1e-2);
        refined.fine_tolerance = 1e-8;
        int asked = 0;
        refined.refine = [&](View<const Vec3d> x) {
            ++asked;
            seen.assign(x.begin(), x.end());
            return true;
        };
        const PcgResult result = problem.solve(refined, got);
        EXPECT_EQ(asked, 1);
        EXPECT_TRUE(result.refined);
        EXPECT_EQ(result.outcome, PcgResult::Outcome::Converged);
        EXPECT_TRUE(same_bits(seen, coarse));
        EXPECT_TRUE(same_bits(got, fine));
        EXPECT_EQ(result.iterations, at_fine.iterations);
        EXPECT_EQ(result.residual_ratio, at_fine.residual_ratio);
    }
}

TEST_P(StopWith, StopsWhereRefiningIsNotWanted) {
    Problem problem(4);
    std::vector<Vec3d> coarse, got;
    const PcgOptions plain = options(PcgOptions::Test::Energy, 1e-3);
    const PcgResult at_coarse = problem.solve(plain, coarse);
    PcgOptions asking = plain;
    asking.fine_tolerance = 1e-8;
    int asked = 0;
    asking.refine = [&asked](View<const Vec3d>) { return ++asked == 0; };
    const PcgResult result = problem.solve(asking, got);
    EXPECT_EQ(asked, 1);
    EXPECT_FALSE(result.refined);
    EXPECT_EQ(result.outcome, PcgResult::Outcome::Converged);
    EXPECT_EQ(result.iterations, at_coarse.iterations);
    EXPECT_TRUE(same_bits(got, coarse));
}

TEST_P(StopWith, StopsAtOnceWhenTheFineToleranceIsReachedToo) {
    Problem problem(4);
    std::vector<Vec3d> coarse, got;
    PcgOptions options = this->options(PcgOptions::Test::Energy, 1e-3);
    const PcgResult at_coarse = problem.solve(options, coarse);
    options.fine_tolerance = 1e-3;
    options.refine = [](View<const Vec3d>) { return true; };
    const PcgResult result = problem.solve(options, got);
    EXPECT_EQ(result.iterations, at_coarse.iterations);
    EXPECT_TRUE(same_bits(got, coarse));
}

TEST_P(StopWith, DoesNotAskWhenThereIsNothingToSolve) {
    Problem problem(5);
    problem.set_rhs_to_zero();
    PcgOptions options = this->options(PcgOptions::Test::Energy, 1e-3);
    int asked = 0;
    options.refine = [&asked](View<const Vec3d>) { return ++asked > 0; };
    std::vector<Vec3d> x;
    const PcgResult result = problem.solve(options, x);
    EXPECT_EQ(result.outcome, PcgResult::Outcome::Converged);
    EXPECT_EQ(result.iterations, 0);
    EXPECT_EQ(asked, 0);
}

PcgOptions energy_test() {
    PcgOptions options;
    options.test = PcgOptions::Test::Energy;
    return options;
}

/// The estimate over |x|_A^2: the least tolerance that is reached.
double estimate(PcgStop stop) {
    double low = 0.0;
    double high = 2.0;
    for (int k = 0; k < 100; ++k) {
        const double middle = 0.5 * (low + high);
        stop.set_tolerance(middle);
        (stop.reached(1e-3) ? high : low) = middle;
    }
    return high;
}

TEST(PcgStop, EstimatesALowerBoundOfTheErrorFourIterationsAgo) {
    const RandomSystem s = random_system(120, 400, 30, 6);
    const Eigen::MatrixXd a = dense_elements(s) + dense_terms(s);
    const Eigen::VectorXd b = to_eigen(random_vector(120, 2));
    const Eigen::VectorXd exact = a.llt().solve(b);
    const Eigen::VectorXd inverse = a.diagonal().cwiseInverse();
    Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size());
    Eigen::VectorXd r = b;
    Eigen::VectorXd p = inverse.cwiseProduct(r);
    double delta = r.dot(p);
    PcgStop stop(energy_test());
    std::vector<double> error_sq(1, exact.dot(b));
    while (error_sq.back() > 1e-9 * error_sq.front()) {
        const Eigen::VectorXd q = a * p;
        const double alpha = delta / p.dot(q);
        stop.add(alpha * delta);
        x += alpha * p;
        r -= alpha * q;
        const Eigen::VectorXd z = inverse.cwiseProduct(r);
        p = z + (r.dot(z) / delta) * p;
        delta = r.dot(z);
        error_sq.push_back((x - exact).dot(a * (x - exact)));
        const std::size_t k = error_sq.size() - 1;
        ASSERT_LT(k, 200u);
        if (k < kDelay) continue;
        const double before = error_sq[k - kDelay];
        const double got = estimate(stop) * x.dot(a * x);
        EXPECT_LE(got, before * (1.0 + 1e-6)) << k;
        EXPECT_NEAR(got, before - error_sq.back(), 1e-6 * before) << k;
    }
    EXPECT_GT(error_sq.size(), 12u);
}

TEST(PcgStop, WaitsForFourIterations) {
    PcgStop stop(energy_test());
    stop.add(1.0);
    for (int k = 0; k < 2; ++k) {
        stop.add(0.0);
        EXPECT_FALSE(stop.reached(1e-3));
    }
    stop.add(0.0);
    EXPECT_FALSE(stop.reached(1e-3));  // the first decrease is still in sight
    stop.add(0.0);
    EXPECT_TRUE(stop.reached(1e-3));
    EXPECT_FALSE(PcgStop(energy_test()).reached(1e-3));
    EXPECT_TRUE(PcgStop(energy_test()).reached(0.0));
}

TEST(PcgStop, ComparesTheResidualWhenAskedTo) {
    PcgOptions options;
    options.tolerance = 1e-3;
    PcgStop stop(options);
    EXPECT_FALSE(stop.reached(1.1e-3));
    EXPECT_TRUE(stop.reached(1e-3));
    stop.set_tolerance(1e-5);
    EXPECT_FALSE(stop.reached(1e-3));
}

}  // namespace
}  // namespace noli
