#pragma once

#include <vector>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// A as a caller's arrays give it, dense or by compressed rows, read in place: what of LcpProblem's checks, and of
/// symmetry, a method needs that makes no LcpProblem. Internal to solvers/.
class MatrixArrays {
 public:
  /// False where only LcpProblem will do: factors, arrays that do not fit (it says which), numbers out of range, A not
  /// symmetric to LcpProblem::kSymmetryTolerance or stored in one triangle, an A_ii <= 0. The arrays must stay as they
  /// are while this is used.  O(nnz)
  bool Take(const ProblemArrays& arrays);

  const ProblemArrays& arrays() const { return *arrays_; }  ///< those that were taken
  Index size() const { return arrays_->rows; }              ///< n
  bool is_dense() const { return arrays_->form == MatrixForm::kDense; }
  /// A_ij = A_ji in all bits, so that rows may be read as columns.
  bool is_exactly_symmetric() const { return is_exact_; }
  /// max |i - j| over entries; n - 1 where A is dense.
  Index bandwidth() const { return bandwidth_; }
  /// n numbers: diag A.
  const std::vector<double>& diagonal() const { return diagonal_; }
  bool is_joint(Index i) const {
    return !arrays_->bilateral.empty() && arrays_->bilateral[static_cast<std::size_t>(i)] != 0;
  }

 private:
  bool TakeDense();
  bool TakeRows();
  bool IsSmall(double difference, double d_i, double d_j);

  const ProblemArrays* arrays_ = nullptr;
  Index bandwidth_ = 0;
  bool is_exact_ = true;
  std::vector<double> diagonal_;
  std::vector<int> next_;  // by row: its first entry that has not met its mirror image yet
};

}  // namespace lcpbench
