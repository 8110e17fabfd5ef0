// SPDX-License-Identifier: Apache-2.0
/// The loops over pairs compute in doubles first; pairs for which these do not suffice
/// come out of them as the formulas have them with exact stages.

#include "objective/pair_terms.hpp"

#include "exec/cpu.hpp"
#include "unit/geometry/oracle.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <vector>

namespace noli {
namespace {

using Exec = SerialExec;
using test::Random;

constexpr BarrierParams kBarrier{
    .dhat = 4.0, .kappa = 10.0, .exponent = 1, .curvature_cap = 0.0};
constexpr int kPairs = 3000;

/// Bits of vectors, so that NaN equals NaN and 0 differs from -0.
std::vector<std::uint64_t> bits_of(View<const Vec3d> vectors) {
    std::vector<std::uint64_t> out;
    for (int i = 0; i < vectors.size; ++i)
        for (int c = 0; c < 3; ++c)
            out.push_back(std::bit_cast<std::uint64_t>(vectors[i][c]));
    return out;
}

/// Degenerate pairs on points of their own.
struct Pairs {
    std::vector<Vec3d> x;
    std::vector<Stencil<4>> stencils;

    explicit Pairs(unsigned seed) {
        Random random(seed);
        for (int i = 0; i < kPairs; ++i) {
            stencils.push_back(test::degenerate_stencil(random));
            for (const Vec3d& point : stencils.back().x)
                x.push_back(point);
        }
    }
    template <int S>
    [[nodiscard]] std::vector<typename detail::PairIndex<S>::Type> indices() const {
        std::vector<typename detail::PairIndex<S>::Type> out(kPairs);
        for (int i = 0; i < kPairs; ++i)
            for (int k = 0; k < S; ++k)
                out[static_cast<std::size_t>(i)][k] = 4 * i + k;
        return out;
    }
    [[nodiscard]] std::vector<MollifiedPair> mollified() const {
        std::vector<MollifiedPair> out;
        for (int i = 0; i < kPairs; ++i) {
            const Int4 v{{4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3}};
            if (i % 3 == 0) out.push_back({v, PairKind::PointPoint, {1, 2, -1, -1}, 9.0});
            if (i % 3 == 1) out.push_back({v, PairKind::PointEdge, {0, 2, 3, -1}, 9.0});
            if (i % 3 == 2) out.push_back({v, PairKind::EdgeEdge, {0, 1, 2, 3}, 9.0});
        }
        return out;
    }
};

/// Memory for the terms of all pairs, and a view of it for the loops.
struct Terms {
    std::vector<Int4> vertices;
    std::vector<int> first_mode;
    std::vector<Mode> modes;
    std::vector<Vec3d> gradients;
    TermRange range;

    explicit Terms(int rank)
        : vertices(kPairs),
          first_mode(kPairs),
          modes(static_cast<std::size_t>(rank) * kPairs),
          gradients(4UL * kPairs),
          range{view_of(vertices),
                view_of(first_mode),
                view_of(modes),
                view_of(gradients),
                0,
                0,
                rank} {}

    [[nodiscard]] std::vector<std::uint64_t> bits() const {
        std::vector<std::uint64_t> out =
            bits_of({gradients.data(), static_cast<int>(gradients.size())});
        for (const Mode& mode : modes)
            for (const std::uint64_t word : bits_of({mode.q, 4}))
                out.push_back(word);
        return out;
    }

  private:
    template <class T>
    static View<T> view_of(std::vector<T>& v) {
        return {v.data(), static_cast<int>(v.size())};
    }
};

template <class T>
View<const T> view_of(const std::vector<T>& v) {
    return {v.data(), static_cast<int>(v.size())};
}

template <int S>
Stencil<S> first_points(const Stencil<4>& s) {
    Stencil<S> out;
    for (int k = 0; k < S; ++k)
        out.x[k] = s.x[k];
    return out;
}

template <int S>
void expect_exact_pairs(PairKind kind, ContactHessian model) {
    const Pairs pairs(17);
    const auto indices = pairs.indices<S>();
    const int rank = max_rank(kind, model);
    Terms from_loop(rank);
    Terms from_formulas(rank);
    Exec exec;
    const ContactLaw law{kBarrier, model, MollifiedHessian::FourMode};
    fill_pair_terms<S>(exec,
                       kind,
                       view_of(indices),
                       view_of(pairs.x),
                       law,
                       from_loop.range,
                       Doubles::First);
    for (std::size_t i = 0; i < kPairs; ++i) {
        const Stencil<S> at = first_points<S>(pairs.stencils[i]);
        detail::store_term(from_formulas.range,
                           static_cast<int>(i),
                           indices[i].v,
                           pair_gradient(kind, at, kBarrier),
                           pair_hessian(model, kind, at, kBarrier));
        const View<const typename detail::PairIndex<S>::Type> one{&indices[i], 1};
        const double energy = exec.value(pair_energy_sum<S>(
            exec, kind, one, view_of(pairs.x), kBarrier, Doubles::First));
        ASSERT_EQ(std::bit_cast<std::uint64_t>(energy),
                  std::bit_cast<std::uint64_t>(0.0 + pair_energy(kind, at, kBarrier)))
            << i;
    }
    EXPECT_EQ(from_loop.bits(), from_formulas.bits());
}

class PairTerms : public testing::TestWithParam<ContactHessian> {};

TEST_P(PairTerms, OfDegeneratePairsAreTheExactOnes) {
    expect_exact_pairs<2>(PairKind::PointPoint, GetParam());
    expect_exact_pairs<3>(PairKind::PointEdge, GetParam());
    expect_exact_pairs<4>(PairKind::PointTriangle, GetParam());
    expect_exact_pairs<4>(PairKind::EdgeEdge, GetParam());
}
INSTANTIATE_TEST_SUITE_P(Models,
                         PairTerms,
                         testing::Values(ContactHessian::GaussNewton,
                                         ContactHessian::GaussNewtonPlus,
                                         ContactHessian::Exact));

template <MollifiedHessian Model>
void expect_exact_mollified() {
    const Pairs pairs(18);
    const std::vector<MollifiedPair> mollified = pairs.mollified();
    Terms from_loop(max_rank(Model));
    Terms from_formulas(max_rank(Model));
    Exec exec;
    const ContactLaw law{kBarrier, ContactHessian::GaussNewtonPlus, Model};
    fill_mollified_terms(
        exec, view_of(mollified), view_of(pairs.x), law, from_loop.range, Doubles::First);
    for (std::size_t i = 0; i < kPairs; ++i) {
        const MollifiedPair& pair = mollified[i];
        const MollifiedCase sub = detail::mollified_case(pair);
        const Stencil<4>& at = pairs.stencils[i];
        detail::store_term(from_formulas.range,
                           static_cast<int>(i),
                           pair.v.v,
                           mollified_gradient(sub, at, pair.eps_cross, kBarrier),
                           mollified_modes<Model>(sub, at, pair.eps_cross, kBarrier));
        const double energy = exec.value(mollified_energy_sum(
            exec, {&pair, 1}, view_of(pairs.x), kBarrier, Doubles::First));
        const double exact = mollified_energy(sub, at, pair.eps_cross, kBarrier);
        ASSERT_EQ(std::bit_cast<std::uint64_t>(energy),
                  std::bit_cast<std::uint64_t>(0.0 + exact))
            << i;
    }
    EXPECT_EQ(from_loop.bits(), from_formulas.bits());
}

TEST(MollifiedTerms, OfDegeneratePairsAreTheExactOnes) {
    expect_exact_mollified<MollifiedHessian::TwoMode>();
    expect_exact_mollified<MollifiedHessian::FourMode>();
    expect_exact_mollified<MollifiedHessian::Exact>();
}

}  // namespace
}  // namespace noli
