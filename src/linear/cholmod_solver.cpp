// SPDX-License-Identifier: Apache-2.0
#include "linear/cholmod_solver.hpp"

#if defined(NOLI_HAVE_CHOLMOD)
#include <cholmod.h>
#include <cmath>
#include <cstring>

// Present when the BLAS in use is OpenBLAS.
extern "C" __attribute__((weak)) void openblas_set_num_threads(int);
#endif

namespace noli {

#if defined(NOLI_HAVE_CHOLMOD)

struct CholmodSolver::Impl {
    cholmod_common common = {};
    cholmod_factor* factor = nullptr;
    std::vector<int> col_begin, row;  ///< pattern of the analysis in `factor`
    int num_analyses = 0;
    bool factorized = false;

    Impl() {
        if (openblas_set_num_threads != nullptr) openblas_set_num_threads(1);
        cholmod_start(&common);
        common.nmethods = 1;
        common.method[0].ordering = CHOLMOD_METIS;
        common.postorder = 1;
        common.supernodal = CHOLMOD_SUPERNODAL;
        common.print = 0;
        // A failed factorisation keeps its analysis; the caller decides what to do.
        common.quick_return_if_not_posdef = 1;
    }
    ~Impl() {
        cholmod_free_factor(&factor, &common);
        cholmod_finish(&common);
    }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;

    /// CHOLMOD's description of our arrays; it only reads them.
    static cholmod_sparse describe(const SparseMatrix& upper) {
        cholmod_sparse a = {};
        a.nrow = a.ncol = static_cast<std::size_t>(upper.num_rows);
        a.nzmax = upper.row.size();
        a.p = const_cast<int*>(upper.col_begin.data());
        a.i = const_cast<int*>(upper.row.data());
        a.x = const_cast<double*>(upper.value.data());
        a.stype = 1;
        a.itype = CHOLMOD_INT;
        a.xtype = CHOLMOD_REAL;
        a.dtype = CHOLMOD_DOUBLE;
        a.sorted = a.packed = 1;
        return a;
    }

    void analyze(cholmod_sparse& a, const SparseMatrix& upper) {
        if (factor != nullptr && col_begin == upper.col_begin && row == upper.row) return;
        cholmod_free_factor(&factor, &common);
        factor = cholmod_analyze(&a, &common);
        col_begin = upper.col_begin;
        row = upper.row;
        ++num_analyses;
    }
};

bool CholmodSolver::available() {
    return true;
}

CholmodSolver::Outcome CholmodSolver::factorize(const SparseMatrix& upper) {
    cholmod_sparse a = Impl::describe(upper);
    impl_->factorized = upper.num_rows == 0;
    if (impl_->factorized) return Outcome::Solved;
    impl_->analyze(a, upper);
    if (impl_->factor == nullptr) return Outcome::Failed;
    cholmod_factorize(&a, impl_->factor, &impl_->common);
    if (impl_->common.status == CHOLMOD_NOT_POSDEF) return Outcome::NotPositiveDefinite;
    if (impl_->common.status != CHOLMOD_OK) return Outcome::Failed;
    impl_->factorized = true;
    return Outcome::Solved;
}

CholmodSolver::Outcome CholmodSolver::solve(std::span<const double> b,
                                            std::span<double> x) {
    if (impl_->factorized && b.empty() && x.empty()) return Outcome::Solved;
    if (!impl_->factorized || impl_->factor == nullptr || b.size() != impl_->factor->n
        || x.size() != b.size())
        return Outcome::Failed;
    cholmod_dense rhs = {};
    rhs.nrow = rhs.nzmax = rhs.d = b.size();
    rhs.ncol = 1;
    rhs.x = const_cast<double*>(b.data());
    rhs.xtype = CHOLMOD_REAL;
    rhs.dtype = CHOLMOD_DOUBLE;
    cholmod_dense* solution =
        cholmod_solve(CHOLMOD_A, impl_->factor, &rhs, &impl_->common);
    if (solution == nullptr) return Outcome::Failed;
    std::memcpy(x.data(), solution->x, x.size() * sizeof(double));
    cholmod_free_dense(&solution, &impl_->common);
    for (const double value : x)
        if (!std::isfinite(value)) return Outcome::NotPositiveDefinite;
    return Outcome::Solved;
}

int CholmodSolver::num_analyses() const {
    return impl_->num_analyses;
}

#else

struct CholmodSolver::Impl {};

bool CholmodSolver::available() {
    return false;
}
CholmodSolver::Outcome CholmodSolver::factorize(const SparseMatrix&) {
    return Outcome::NotAvailable;
}
CholmodSolver::Outcome CholmodSolver::solve(std::span<const double>, std::span<double>) {
    return Outcome::NotAvailable;
}
int CholmodSolver::num_analyses() const {
    return 0;
}

#endif

CholmodSolver::CholmodSolver() : impl_(std::make_unique<Impl>()) {}
CholmodSolver::~CholmodSolver() = default;
CholmodSolver::CholmodSolver(CholmodSolver&&) noexcept = default;
CholmodSolver& CholmodSolver::operator=(CholmodSolver&&) noexcept = default;

}  // namespace noli
