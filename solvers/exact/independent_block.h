#pragma once

#include <Eigen/SparseCholesky>
#include <optional>
#include <vector>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// S A_RR S + part I on some rows R, factorized in doubles: rows and columns are scaled by powers of two S = diag s
/// that bring the diagonal to [1/2, 2), which rounds nothing. Internal to solvers/exact/.
class ProximalFactor {
 public:
  using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

  /// @param rows  ascending, without rows of A_ii = 0. O(fill) of a sparse LDL^T in an AMD order
  ProximalFactor(const LcpProblem& problem, std::vector<Index> rows, double part);

  const std::vector<Index>& rows() const { return rows_; }
  /// s_k of row k of R.
  const Eigen::VectorXd& scale() const { return scale_; }
  /// About (A_RR + part S^-2)^-1 r, numbered within R; NaN where it is not factorized.
  Eigen::VectorXd Solve(const Eigen::VectorXd& r) const;
  /// d_k of row k of R, where the rows before it in the order of the factor are eliminated.
  double Pivot(Index k) const;
  bool IsFactorized() const { return rows_.empty() || factor_.info() == Eigen::Success; }
  /// Lower triangle, without part I.
  const Matrix& block() const { return block_; }

 private:
  std::vector<Index> rows_;
  Eigen::VectorXd scale_;
  Matrix block_;
  Eigen::VectorXd pivots_;
  Eigen::SimplicialLDLT<Matrix> factor_;
};

/// The block A_GG of the rows G among some that are independent of each other, factorized in doubles, and a bound of
/// its least eigenvalue that its rounding errors cannot break. Internal to solvers/exact/.
class IndependentBlock {
 public:
  /// @param rows  as of ProximalFactor. O(fill) of a sparse LDL^T, twice
  IndependentBlock(const LcpProblem& problem, const std::vector<Index>& rows);

  /// G: the rows but those whose pivot vanishes to rounding where earlier ones of the order are eliminated. Which ones
  /// are left out is a guess in doubles; nothing is proved by it.
  const std::vector<Index>& independent() const { return factor_->rows(); }
  const std::vector<Index>& dependent() const { return dependent_; }
  const ProximalFactor& factor() const { return *factor_; }

  /// A lower bound of the least eigenvalue of S A_GG S, S = diag s; 0 where none > 0 can be shown.
  ///
  /// Cholesky's method in doubles on B = S A_GG S - c I, where it ends, gives L with |L L^T - B| <= g |L||L^T|, g = (r
  /// + 1) u / (1 - (r + 1) u), r the most entries in a row of L, whatever the order of its sums [Higham, Accuracy and
  /// Stability of Numerical Algorithms, 2002, theorem 10.3]. As L L^T is semidefinite, the least eigenvalue is at least
  /// c - g | |L||L^T| |_inf, less what the entries of A_GG themselves were rounded by [Rump, Verification of positive
  /// definiteness, BIT 46, 2006].
  double LeastEigenvalueBound() const;

 private:
  double EstimateLeastEigenvalue() const;
  double EntryErrors() const;

  const LcpProblem& problem_;
  std::vector<Index> dependent_;
  std::optional<ProximalFactor> factor_;
};

}  // namespace lcpbench
