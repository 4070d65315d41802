#pragma once

#include <Eigen/Core>
#include <vector>

#include "solvers/lcp/solver.h"
#include "solvers/ordered_lcp.h"

namespace lcpbench {

/// L D L^T of A_FF + shift diag(A)_FF, shift > 0, for any set F of rows of one ordered problem with PSD A. Made row by
/// row: row k of L is one sparse triangular solve with the rows before it, whose pattern is found on the way from the
/// elimination tree of F [Liu 1990; Davis, Direct Methods for Sparse Linear Systems, 2006, sec. 4.8]. Since rows enter
/// in their order, a factor for another F keeps all rows before the first one that changed.
///
/// Cost: O(sum over columns of (entries of the column)^2), a solve O(entries of L). Only Analyse allocates.
class SparseLdlt {
 public:
  using Index = Eigen::Index;

  /// Reserves room for the factor of all of A, in which every F's fits. False, with nothing reserved, if that has 2^31
  /// entries and more.  O(entries of L)
  bool Analyse(const OrderedLcp& lcp);

  /// Values of A have changed: nothing is kept from the factor before.
  void Forget() { shift_ = -1; }

  /// Makes the factor for F = {p : in_F[p] != 0}, rows with A_pp = 0 not among them. A pivot that rounding has taken
  /// below shift A_pp (it cannot be for PSD A) is lifted to that.
  /// @returns false if the deadline passed meanwhile; there is no factor then
  bool Factor(const OrderedLcp& lcp, double shift, const char* in_F, const Deadline& deadline);

  /// x_F := (A_FF + shift diag)^-1 x_F, other entries := 0.
  void Solve(double* x) const;

  /// Rows of F, ascending.
  const std::vector<int>& rows() const { return rows_; }
  /// The least pivot over its A_pp, before lifting: clearly negative if A is not PSD.
  double least_pivot() const { return least_pivot_; }

 private:
  void Truncate(int first);
  Index AppendRow(const OrderedLcp& lcp, int k, const char* in_F);

  int n_ = 0;
  double shift_ = -1;
  double least_pivot_ = 0;
  std::vector<int> start_;     // column j of L: places start_[j] .. start_[j] + count_[j]
  std::vector<int> count_;     // of the current factor
  std::vector<int> index_;     // row of an entry, ascending in a column
  std::vector<double> lower_;  // its value
  std::vector<int> parent_;    // elimination tree of F, -1 at roots
  std::vector<int> mark_, pattern_;
  std::vector<double> work_;  // zero between rows
  std::vector<double> pivot_;
  std::vector<char> in_F_;
  std::vector<int> rows_;
};

}  // namespace lcpbench
