#pragma once

#include <Eigen/SparseCore>
#include <memory>

/// Internal to solvers/.
namespace lcpbench {

/// LU factor of a sparse nonsymmetric K with a nearly symmetric pattern: minimum degree order of the pattern of K +
/// K^T, diagonal pivots down to a part of the largest in their column. The factor is KLU's [T. Davis, E. Palamadai
/// Natarajan 2010]; a build without SuiteSparse takes Eigen's, which fills in far more.
class SparseLu {
 public:
  SparseLu();
  ~SparseLu();

  /// @param K  n x n, compressed; is read again by no later call
  /// @return false where K is singular in double: there is no factor then
  bool Factorize(const Eigen::SparseMatrix<double>& K) { return SetPattern(K) && FactorizeValues(K); }
  /// The two parts of it: the order, and the factor of a matrix of the same pattern, with the pivots of the factor
  /// before where these still do.
  bool SetPattern(const Eigen::SparseMatrix<double>& K);
  bool FactorizeValues(const Eigen::SparseMatrix<double>& K);
  /// The sign of det K.  O(n). A factor was made.
  bool has_negative_determinant() const;
  /// x with K x = b; O(nnz of the factor). Factorize has returned true.
  Eigen::VectorXd Solve(const Eigen::VectorXd& b) const;
  /// x with K^T x = b.
  Eigen::VectorXd SolveTransposed(const Eigen::VectorXd& b) const;

 private:
  struct Factor;
  std::unique_ptr<Factor> factor_;
};

}  // namespace lcpbench
