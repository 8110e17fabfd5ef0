// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What the iterative solvers take and report, and when they stop.

#include "core/stop_flag.hpp"
#include "core/vec.hpp"
#include "core/view.hpp"

#include <functional>

namespace noli {

enum class PreconditionerKind {
    BlockJacobi,
    GaussSeidel,         ///< symmetric block Gauss-Seidel; CPU only
    IncompleteCholesky,  ///< block IC(0); CPU only
    Schwarz,             ///< dense blocks of 32 vertices; DevicePcg only
};

/// A preconditioner that the solver at hand does not have becomes block Jacobi.
struct PcgOptions {
    enum class Test {
        Residual,  ///< r.P⁻¹r against its first value
        Energy,    ///< estimated |x - x*|_A^2 against |x|_A^2
    };
    /// Stop when the test's ratio of squared norms is at most this. > 0
    double tolerance = 1e-4;
    Test test = Test::Residual;
    int max_iterations = 10000;  ///< >= 0
    PreconditionerKind preconditioner = PreconditionerKind::BlockJacobi;
    /// Asked once when `tolerance` is reached: true goes on from there to
    /// `fine_tolerance`. Host memory only; may be empty.
    std::function<bool(View<const Vec3d> x)> refine;
    double fine_tolerance = 1e-4;
    /// Contacts as dense blocks, multiplied by warps (linear/dense_terms.hpp). With the
    /// preconditioners that conjugate gradients have on a device; others are not used.
    bool contacts_by_warps = false;
    /// (num_rows) multiple of the identity in each row, or empty: lets a solver tell
    /// whether single precision can store the matrix.
    View<const double> inertia = {};
    /// The operator need not be positive definite: a breakdown is an answer.
    bool may_break = false;
    /// (num_rows) positions, or empty: where the rigid modes of the coarse space are
    /// taken, if the preconditioner has one. Empty does without it.
    View<const Vec3d> positions = {};
    /// Looked at before every iteration, on a device before every batch of them.
    StopFlag stop = nullptr;
};

/// Decides when the iteration ends.
///
/// An iteration lowers the energy x.Ax / 2 - b.x by alpha r.z / 2, and what all that are
/// still to come will lower it by is half of the squared energy norm of the error: a
/// lower bound of that error is the sum over the last few iterations, of what the error
/// was before them. Unlike the residual test it means the same for every preconditioner.
///
/// Source: [Hestenes1952]; [StrakosTichy2002] eq. (9)
class PcgStop {
  public:
    PcgStop() = default;
    explicit PcgStop(const PcgOptions& options)
        : test_(options.test), tolerance_(options.tolerance) {}

    /// What the first guess has lowered the energy by already, twice; 0 for x = 0.
    NOLI_HD void start(double decrease) { total_ = decrease; }

    /// `decrease` = alpha r.z of an iteration.
    NOLI_HD void add(double decrease) {
        total_ += decrease;
        last_[next_] = decrease;
        next_ = (next_ + 1) % kDelay;
        ++count_;
    }

    NOLI_HD void set_tolerance(double tolerance) { tolerance_ = tolerance; }

    /// `residual_ratio` = r.z over its first value. True also where both are 0.
    [[nodiscard]] NOLI_HD bool reached(double residual_ratio) const {
        if (test_ == PcgOptions::Test::Residual || residual_ratio == 0.0)
            return residual_ratio <= tolerance_;
        double recent = 0.0;
        for (const double d : last_)
            recent += d;
        return count_ >= kDelay && recent <= tolerance_ * total_;
    }

  private:
    static constexpr int kDelay = 4;  ///< iterations that an error is estimated over
    PcgOptions::Test test_ = PcgOptions::Test::Residual;
    double tolerance_ = 0.0;
    double total_ = 0.0;
    double last_[kDelay] = {};
    int next_ = 0;
    int count_ = 0;
};

struct PcgResult {
    enum class Outcome {
        Converged,
        MaxIterations,
        Cancelled,  ///< PcgOptions::stop was set
        Breakdown,  ///< p.Ap <= 0 (the operator is not positive definite) or not a number
    };
    int iterations = 0;    ///< products with the operator
    bool refined = false;  ///< went on to the fine tolerance
    Outcome outcome = Outcome::Converged;
    double residual_ratio = 0.0;  ///< r.P⁻¹r over its first value
    /// What was used: block Jacobi where the chosen one could not be built.
    PreconditionerKind preconditioner = PreconditionerKind::BlockJacobi;
};

}  // namespace noli
