#pragma once

#include <vector>

#include "solvers/lcp/problem.h"
#include "support/array_index.h"

namespace lcpbench {

/// A symmetric A as a caller's arrays give it, dense or by compressed rows, read in place by methods that need no
/// LcpProblem. Internal to solvers/.
class MatrixArrays {
 public:
  /// False where only LcpProblem will do: factors, arrays that do not fit (it says which), numbers out of range, A not
  /// symmetric in all bits, an A_ii <= 0. The arrays must stay as they are while this is used.  O(nnz)
  bool Take(const ProblemView& arrays);
  /// From here on with another b, n numbers.
  void SetB(std::span<const double> b) { arrays_.b = b; }

  const ProblemView& arrays() const { return arrays_; }  ///< those that were taken
  Index size() const { return arrays_.rows; }            ///< n
  bool is_dense() const { return arrays_.form == MatrixForm::kDense; }
  /// max |i - j| over entries; n - 1 where A is dense.
  Index bandwidth() const { return bandwidth_; }
  /// n numbers: diag A.
  const std::vector<double>& diagonal() const { return diagonal_; }
  bool is_joint(Index i) const { return !arrays_.bilateral.empty() && arrays_.bilateral[At(i)] != 0; }
  /// The column of row i's first entry.
  Index first(Index i) const { return is_dense() ? 0 : arrays_.column[At(arrays_.row_start[At(i)])]; }
  /// visit(j, A_ij) over row i, j ascending.
  template <typename Visit>
  void ForEntries(Index i, const Visit& visit) const {
    const double* const value = arrays_.value.data();
    if (is_dense()) {
      for (Index j = 0; j < size(); ++j) visit(j, value[i * size() + j]);
      return;
    }
    const int* const column = arrays_.column.data();
    for (int e = arrays_.row_start[At(i)]; e < arrays_.row_start[At(i) + 1]; ++e) visit(Index{column[e]}, value[e]);
  }

 private:
  bool TakeDense();
  bool TakeRows();

  ProblemView arrays_;
  Index bandwidth_ = 0;
  std::vector<double> diagonal_;
  std::vector<int> next_;  // by row: its first entry that has not met its mirror image yet
};

}  // namespace lcpbench
