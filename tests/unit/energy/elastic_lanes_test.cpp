// SPDX-License-Identifier: Apache-2.0
/// Every pack width gives the bits of the scalar code: DESIGN 1.3.

#include "core/pack.hpp"
#include "energy/tet.hpp"
#include "exec/lanes.hpp"
#include "unit/energy/elastic_cases.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace noli {
namespace {

constexpr int kShapeValues = 22;
constexpr int kResultValues = 1 + 12 + 90 + 10;

template <class T, class Get>
T gather(Get get) {
    if constexpr (std::is_same_v<T, double>) {
        return get(0);
    } else {
        T out(0.0);
        for (int j = 0; j < static_cast<int>(sizeof(T) / sizeof(double)); ++j)
            out.set(j, get(j));
        return out;
    }
}

template <class T>
double lane_of(const T& value, int j) {
    if constexpr (std::is_same_v<T, double>)
        return value;
    else
        return value[j];
}

/// Shapes and results are arrays of structures of doubles, one after the other.
template <ElasticModel M>
struct Kernel {
    const double* shapes;
    double* results;
    bool project;

    template <class T>
    void operator()(Lane<T> lane) const {
        const auto in = [&](int k) {
            return gather<T>(
                [&](int j) { return shapes[(lane.first + j) * kShapeValues + k]; });
        };
        TetShape<T> tet;
        for (int v = 0; v < 4; ++v)
            tet.x[v] = {in(3 * v), in(3 * v + 1), in(3 * v + 2)};
        for (int k = 0; k < 9; ++k)
            tet.dm_inv.a[k] = in(12 + k);
        tet.weight = in(21);
        const LameParameters<T> lame{T(4e5), T(1.7e6)};

        const TetDerivatives<T> d = tet_derivatives<M>(tet, lame, project);
        int row = 0;
        const auto out = [&](const T& value) {
            for (int j = 0; j < static_cast<int>(sizeof(T) / sizeof(double)); ++j)
                results[(lane.first + j) * kResultValues + row] = lane_of(value, j);
            ++row;
        };
        out(d.energy);
        for (const Vec3<T>& g : d.gradient.g) {
            out(g.x);
            out(g.y);
            out(g.z);
        }
        for (const Mat3<T>& block : d.hessian.block) {
            for (const T& value : block.a)
                out(value);
        }
        const Mat3<T> F = deformation_gradient(tet.x, tet.dm_inv);
        const Mat3<T> cauchy = cauchy_stress<M>(F, lame);
        for (const T& value : cauchy.a)
            out(value);
        out(von_mises(cauchy));
    }
};

/// Random and special deformations, then degenerate ones: flat, folded onto a line, a
/// point.
std::vector<double> shapes() {
    elastic_test::Random random(3);
    std::vector<Mat3d> gradients;
    for (const auto& c : elastic_test::deformation_cases(true))
        gradients.push_back(c.F);
    for (int k = 0; k < 500; ++k)
        gradients.push_back(elastic_test::from_eigen(random.matrix(1.5)));
    for (double b : {0.0, 0.5, 1.0}) {
        for (double c : {0.0, -0.5, -1.0})
            gradients.push_back({1, 0, 0, 0, b, 0, 0, 0, c});
    }
    gradients.push_back(zero3());
    gradients.push_back({-1, 0, 0, 0, -1, 0, 0, 0, -1});

    std::vector<double> values;
    for (const Mat3d& F : gradients) {
        const bool exact = &F >= &gradients[gradients.size() - 11];
        const Vec3d x0 = exact ? Vec3d{0, 0, 0} : Vec3d{0.3, -0.2, 0.7};
        for (const Vec3d& x : {x0, x0 + F.col(0), x0 + F.col(1), x0 + F.col(2)})
            values.insert(values.end(), {x.x, x.y, x.z});
        values.insert(values.end(), {1, 0, 0, 0, 1, 0, 0, 0, 1, 0.02});
    }
    return values;
}

template <ElasticModel M>
void expect_equal_bits(bool project) {
    const std::vector<double> in = shapes();
    const int n = static_cast<int>(in.size()) / kShapeValues;
    ASSERT_NE(n % 8, 0) << "the last elements must go through the scalar code";
    const std::size_t size = static_cast<std::size_t>(n * kResultValues);
    std::vector<double> scalar(size);
    for (int i = 0; i < n; ++i)
        Kernel<M>{in.data(), scalar.data(), project}(Lane<double>{i});

    const auto compare = [&](LaneDispatch dispatch, int width) {
        std::vector<double> packed(size, -1.0);
        run_lane_block(dispatch, 0, n, Kernel<M>{in.data(), packed.data(), project});
        for (std::size_t k = 0; k < size; ++k) {
            ASSERT_EQ(std::bit_cast<std::uint64_t>(scalar[k]),
                      std::bit_cast<std::uint64_t>(packed[k]))
                << "width " << width << ", tet " << k / kResultValues << ", value "
                << k % kResultValues << ": " << scalar[k] << " " << packed[k];
        }
    };
    compare(LaneDispatch::Width2, 2);
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2")) compare(LaneDispatch::Width4, 4);
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")
        && __builtin_cpu_supports("avx512vl"))
        compare(LaneDispatch::Width8, 8);
#endif
}

TEST(ElasticLanes, StableNeoHookeanHasEqualBitsForEveryWidth) {
    expect_equal_bits<ElasticModel::StableNeoHookean>(true);
    expect_equal_bits<ElasticModel::StableNeoHookean>(false);
}

TEST(ElasticLanes, NeoHookeanHasEqualBitsForEveryWidth) {
    expect_equal_bits<ElasticModel::NeoHookean>(true);
    expect_equal_bits<ElasticModel::NeoHookean>(false);
}

TEST(ElasticLanes, FixedCorotatedHasEqualBitsForEveryWidth) {
    expect_equal_bits<ElasticModel::FixedCorotated>(true);
    expect_equal_bits<ElasticModel::FixedCorotated>(false);
}

TEST(Pack, FabsClearsTheSignOfZeroLikeTheScalarFunction) {
    Pack<4> a(-0.0);
    a.set(1, -3.5);
    a.set(2, 2.0);
    a.set(3, 0.0);
    const Pack<4> b = fabs(a);
    for (int j = 0; j < 4; ++j)
        EXPECT_EQ(std::bit_cast<std::uint64_t>(b[j]),
                  std::bit_cast<std::uint64_t>(std::fabs(a[j])));
}

}  // namespace
}  // namespace noli
