#pragma once

#include <Eigen/Core>
#include <vector>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// A sparse working copy of an LCP for direct methods: scaled, with rows and columns in an order of little fill.
///
/// Scaling: A~ = S A S, b~ = t S b, f~ = t S^-1 f, w~ = t S w, with powers of two S_ii that bring A_ii into [1, 4) and
/// t that brings the largest |b~_i| into [1, 2), as PermutedLcp: nothing is rounded. A~_ii is not 1, so tolerances must
/// be relative to it.
///
/// "Position" is the place of a row in the order, which is fixed: approximate minimum degree on all of A [Amestoy,
/// Davis, Duff 1996]. Restricted to any set of rows it is an order of little fill for that block, too. Rows with
/// A_ii = 0 (zero rows, for PSD A) keep their place, marked as dead.
struct OrderedLcp {
  using Index = Eigen::Index;

  /// Order and structure, from the pattern of A only.  O(fill of the order)
  void Analyse(const LcpProblem& problem);
  /// Values. False if an A_ii < 0.  O(nnz A)
  bool Load(const LcpProblem& problem);

  /// out = A x.  O(nnz A)
  void Product(const double* x, double* out) const;

  double GivenForce(Index p, double f) const { return f * (scale[p] / b_scale); }
  double ScaledForce(Index p, double given) const { return given * b_scale / scale[p]; }

  Index n = 0;
  /// Row p: columns column[begin[p] .. begin[p + 1]), ascending; those before diagonal_at[p] are the lower triangle.
  std::vector<int> begin, diagonal_at, column;
  std::vector<double> value;
  std::vector<int> row, position;  ///< position -> row of the problem, and back
  std::vector<char> bilateral, dead;
  Eigen::VectorXd diagonal, b, scale;  ///< by position; diagonal and scale are 1 for dead rows
  double b_scale = 1;

 private:
  std::vector<int> source_;  // entry -> its place in the values of SparseA()
};

}  // namespace lcpbench
