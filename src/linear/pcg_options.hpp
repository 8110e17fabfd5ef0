// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the iterative solvers take and report.

namespace noli {

enum class PreconditionerKind {
    BlockJacobi,
    GaussSeidel,         ///< symmetric block Gauss-Seidel; CPU only
    IncompleteCholesky,  ///< block IC(0); CPU only
};

/// A preconditioner that runs on the CPU only becomes block Jacobi on a device.
struct PcgOptions {
    /// Stop when r.P⁻¹r <= tolerance * its first value: a ratio of squared norms. > 0
    double tolerance = 1e-4;
    int max_iterations = 10000;  ///< >= 0
    PreconditionerKind preconditioner = PreconditionerKind::BlockJacobi;
};

struct PcgResult {
    enum class Outcome {
        Converged,
        MaxIterations,
        Breakdown,  ///< p.Ap <= 0 (the operator is not positive definite) or not a number
    };
    int iterations = 0;  ///< products with the operator
    Outcome outcome = Outcome::Converged;
    double residual_ratio = 0.0;  ///< r.P⁻¹r over its first value
    /// What was used: block Jacobi where the chosen one could not be built.
    PreconditionerKind preconditioner = PreconditionerKind::BlockJacobi;
};

}  // namespace noli
