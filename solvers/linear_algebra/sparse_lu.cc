#include "solvers/linear_algebra/sparse_lu.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "support/array_index.h"

#ifdef LCPBENCH_WITH_SUITESPARSE
#include <klu.h>
#else
#include <Eigen/SparseLU>
#endif

namespace lcpbench {
namespace {

// Diagonal pivots, which keep the order, are taken down to this part of the largest in their column.
constexpr double kLeastPivot = 1e-3;

#ifdef LCPBENCH_WITH_SUITESPARSE
// By its cycles, each of which is taken apart.
bool IsOddPermutation(std::vector<int> to) {
  bool is_odd = false;
  for (int i = 0; i < static_cast<int>(to.size()); ++i) {
    for (; to[At(i)] != i; is_odd = !is_odd) std::swap(to[At(i)], to[At(to[At(i)])]);
  }
  return is_odd;
}
#endif

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
  // KLU only reads what it takes as pointers to mutable arrays.
  bool SetPattern(const Eigen::SparseMatrix<double>& K) {
    Free();
    size = static_cast<int>(K.cols());
    symbolic = klu_analyze(size, const_cast<int*>(K.outerIndexPtr()), const_cast<int*>(K.innerIndexPtr()), &common);
    return symbolic != nullptr;
  }
  // With the pivots of the factor before, which is several times faster, where they still do.
  bool FactorizeValues(const Eigen::SparseMatrix<double>& K) {
    constexpr double kLeastGrowth = 1e-4;  // reciprocal: smallest of max |K| over max |U|, by columns
    const auto columns = const_cast<int*>(K.outerIndexPtr()), rows = const_cast<int*>(K.innerIndexPtr());
    const auto values = const_cast<double*>(K.valuePtr());
    if (numeric != nullptr && klu_refactor(columns, rows, values, symbolic, numeric, &common) != 0 &&
        klu_rgrowth(columns, rows, values, symbolic, numeric, &common) != 0 && common.rgrowth > kLeastGrowth) {
      return true;
    }
    klu_free_numeric(&numeric, &common);
    numeric = klu_factor(columns, rows, values, symbolic, &common);
    return numeric != nullptr && common.status == KLU_OK;
  }
  bool HasNegativeDeterminant() const {
    const auto* const diagonal = static_cast<const double*>(numeric->Udiag);
    bool is_odd = std::count_if(diagonal, diagonal + size, [](double pivot) { return pivot < 0; }) % 2 != 0;
    for (const int* order : {numeric->Pnum, symbolic->Q}) is_odd = is_odd != IsOddPermutation({order, order + size});
    return is_odd;
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

  bool SetPattern(const Eigen::SparseMatrix<double>& K) {
    analyzePattern(K);
    return true;
  }
  bool FactorizeValues(const Eigen::SparseMatrix<double>& K) {
    factorize(K);
    return info() == Eigen::Success;
  }
  bool HasNegativeDeterminant() { return signDeterminant() < 0; }
  void Solve(Eigen::VectorXd* x) { *x = solve(*x).eval(); }
  void SolveTransposed(Eigen::VectorXd* x) { *x = transpose().solve(*x).eval(); }
};

#endif

SparseLu::SparseLu() : factor_(std::make_unique<Factor>()) {}
SparseLu::~SparseLu() = default;

bool SparseLu::SetPattern(const Eigen::SparseMatrix<double>& K) { return factor_->SetPattern(K); }

bool SparseLu::FactorizeValues(const Eigen::SparseMatrix<double>& K) { return factor_->FactorizeValues(K); }

bool SparseLu::has_negative_determinant() const { return factor_->HasNegativeDeterminant(); }

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
