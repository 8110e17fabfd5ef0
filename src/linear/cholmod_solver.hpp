// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Direct solver: CHOLMOD's supernodal Cholesky with METIS ordering. An optional
/// component, since CHOLMOD's supernodal module is GPL; without it the class exists and
/// says that it is missing.
///
/// Results are reproducible: BLAS is set to one thread, where the BLAS in use lets us say
/// so.

#include "linear/assemble.hpp"

#include <memory>
#include <span>

namespace noli {

class CholmodSolver {
  public:
    enum class Outcome {
        Solved,
        NotPositiveDefinite,  ///< the factorisation met a pivot <= 0 or not a number
        Failed,               ///< out of memory, or the problem is too large
        NotAvailable,         ///< built without CHOLMOD
    };

    CholmodSolver();
    ~CholmodSolver();
    CholmodSolver(CholmodSolver&&) noexcept;
    CholmodSolver& operator=(CholmodSolver&&) noexcept;

    /// True when this build contains CHOLMOD.
    static bool available();

    /// Factorises the matrix. The ordering and symbolic analysis of the last call are
    /// used again when the pattern is the same.
    Outcome factorize(const SparseMatrix& upper);

    /// Solves with the last factorisation that succeeded; b and x (num_rows), may be the
    /// same.
    Outcome solve(std::span<const double> b, std::span<double> x);

    /// Symbolic analyses made so far.
    [[nodiscard]] int num_analyses() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Solves (matrix + terms) x = b on the free vertices; x = 0 at the fixed ones. x is
/// untouched unless the outcome is Solved. b, x (num_rows) and fixed (num_rows) are
/// executor memory.
template <class Exec>
CholmodSolver::Outcome solve_direct(Exec& exec,
                                    CholmodSolver& solver,
                                    const BlockMatrix<Exec>& matrix,
                                    const LowRankTerms<Exec>& terms,
                                    View<const Vec3d> b,
                                    View<const std::uint8_t> fixed,
                                    typename Exec::template Buffer<Vec3d>& x) {
    std::vector<std::uint8_t> host_fixed;
    exec.download(fixed, host_fixed);
    const Numbering numbering = number_free_vertices(host_fixed);
    const auto factorized =
        solver.factorize(assemble_sparse(exec, matrix, terms, numbering));
    if (factorized != CholmodSolver::Outcome::Solved) return factorized;

    std::vector<Vec3d> host;
    exec.download(b, host);
    std::vector<double> unknowns;
    unknowns.reserve(3 * numbering.vertex.size());
    for (const int v : numbering.vertex)
        for (int k = 0; k < 3; ++k)
            unknowns.push_back(host[static_cast<std::size_t>(v)][k]);
    const auto solved = solver.solve(unknowns, unknowns);
    if (solved != CholmodSolver::Outcome::Solved) return solved;
    host.assign(host.size(), Vec3d{0, 0, 0});
    for (std::size_t i = 0; i < unknowns.size(); ++i)
        host[static_cast<std::size_t>(numbering.vertex[i / 3])][static_cast<int>(i % 3)] =
            unknowns[i];
    exec.upload(host, x);
    return solved;
}

}  // namespace noli
