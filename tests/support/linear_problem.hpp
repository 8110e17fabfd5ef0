// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A random linear system as a solver gets it: operator in the memory of an executor,
/// right-hand side and prescribed vertices; and its vectors in the order of the rows that
/// a solver of the CPU sees.

#include "linear/pcg_options.hpp"
#include "linear/scaled_operator.hpp"
#include "unit/linear/random_system.hpp"

#include <cstdint>
#include <initializer_list>
#include <vector>

namespace noli::test {

template <class Exec>
struct LinearProblem {
    LinearProblem(const RandomSystem& system,
                  int seed_of_b,
                  std::initializer_list<std::size_t> fixed_vertices = {})
        : s(system),
          loaded(load(exec, s)),
          b(random_vector(s.num_vertices, seed_of_b)),
          fixed(b.size(), 0) {
        for (const std::size_t v : fixed_vertices)
            fixed[v] = 1;
    }

    template <class Solver>
    PcgResult solve(Solver& solver, const PcgOptions& options, std::vector<Vec3d>& x) {
        x.resize(b.size());
        return solver.solve(exec,
                            loaded.matrix,
                            loaded.terms,
                            view_of(b),
                            view_of(fixed),
                            options,
                            view_of(x));
    }

    [[nodiscard]] ColouredOperator rows(const RowCut& cut = ScaledOperator::kRowCut) {
        OperatorCopy copy;
        ColouredOperator op(cut);
        op.update_pattern(
            exec, view_operator(exec, loaded.matrix, loaded.terms, copy), view_of(fixed));
        return op;
    }

    Exec exec;
    RandomSystem s;
    LoadedSystem<Exec> loaded;
    std::vector<Vec3d> b;
    std::vector<std::uint8_t> fixed;
};

/// Components of the free vertices.
inline Eigen::VectorXd in_row_order(const std::vector<Vec3d>& v,
                                    const Numbering& numbering) {
    Eigen::VectorXd out(3 * static_cast<Eigen::Index>(numbering.vertex.size()));
    for (Eigen::Index i = 0; i < out.size(); ++i)
        out[i] =
            v[static_cast<std::size_t>(numbering.vertex[static_cast<std::size_t>(i / 3)])]
             [static_cast<int>(i % 3)];
    return out;
}

}  // namespace noli::test
