#include "solvers/linear_algebra/sparse_lu.h"

#ifdef LCPBENCH_WITH_SUITESPARSE
#include <klu.h>
#else
#include <Eigen/SparseLU>
#endif

namespace lcpbench {
namespace {

// Diagonal pivots, which keep the order, are taken down to this part of the largest in their column.
constexpr double kLeastPivot = 1e-3;

}  // namespace

#ifdef LCPBENCH_WITH_SUITESPARSE

struct SparseLu::Factor {
  Factor() {
    klu_defaults(&common);
    common.tol = kLeastPivot;
  }
  Factor(const Factor&) = delete;
  Factor& operator=(const Factor&) = delete;
  ~Factor() { Free(); }

  void Free() {
    klu_free_numeric(&numeric, &common);
    klu_free_symbolic(&symbolic, &common);
  }
  bool Compute(const Eigen::SparseMatrix<double>& K) {
    Free();
    size = static_cast<int>(K.cols());
    // KLU only reads what it takes as pointers to mutable arrays.
    const auto columns = const_cast<int*>(K.outerIndexPtr()), rows = const_cast<int*>(K.innerIndexPtr());
    symbolic = klu_analyze(size, columns, rows, &common);
    if (symbolic != nullptr) numeric = klu_factor(columns, rows, const_cast<double*>(K.valuePtr()), symbolic, &common);
    return numeric != nullptr && common.status == KLU_OK;
  }
  void Solve(Eigen::VectorXd* x) { klu_solve(symbolic, numeric, size, 1, x->data(), &common); }
  void SolveTransposed(Eigen::VectorXd* x) { klu_tsolve(symbolic, numeric, size, 1, x->data(), &common); }

  int size = 0;
  klu_common common;
  klu_symbolic* symbolic = nullptr;
  klu_numeric* numeric = nullptr;
};

#else

struct SparseLu::Factor : Eigen::SparseLU<Eigen::SparseMatrix<double>, Eigen::AMDOrdering<int> > {
  // From 48 rows on, with one right-hand side, triangular solves of Eigen 3.4 may block for fewer rows than a panel
  // that they pack has, and write past their workspace on the stack: not with supernodes of so few columns.
  Factor() {
    m_perfv.maxsuper = 32;
    setPivotThreshold(kLeastPivot);
  }

  bool Compute(const Eigen::SparseMatrix<double>& K) {
    compute(K);
    return info() == Eigen::Success;
  }
  void Solve(Eigen::VectorXd* x) { *x = solve(*x).eval(); }
  void SolveTransposed(Eigen::VectorXd* x) { *x = transpose().solve(*x).eval(); }
};

#endif

SparseLu::SparseLu() : factor_(std::make_unique<Factor>()) {}
SparseLu::~SparseLu() = default;

bool SparseLu::Factorize(const Eigen::SparseMatrix<double>& K) { return factor_->Compute(K); }

Eigen::VectorXd SparseLu::Solve(const Eigen::VectorXd& b) const {
  Eigen::VectorXd x = b;
  factor_->Solve(&x);
  return x;
}

Eigen::VectorXd SparseLu::SolveTransposed(const Eigen::VectorXd& b) const {
  Eigen::VectorXd x = b;
  factor_->SolveTransposed(&x);
  return x;
}

}  // namespace lcpbench
