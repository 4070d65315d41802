#pragma once

#include <Eigen/Core>
#include <vector>

#include "solvers/first_order/sweeps/lanes.h"
#include "solvers/lcp/problem.h"

/// Internal to solvers/.
namespace lcpbench {

/// An LCP in units in which diag A = 1 and 1 <= |b| < 2, so that no step divides and nothing depends on the units of
/// the given problem. (b is scaled by a power of two, so that the iterates' bits do not depend on the rounding of |b|.)
/// Row k here is row order[k] of the given problem; all arrays run over k.
struct ScaledProblem {
  Index size = 0;
  std::vector<Index> order;  ///< empty: the given order
  Array b;
  double b_norm = 1;   ///< |b| here, 1 where b = 0: rho is the norm of the natural residual over this
  Array unit;          ///< f_k of the given problem per f_k here
  Array inverse_root;  ///< (A_kk)^-1/2 of the given problem, 1 where A_kk = 0
  /// Rows that step differently: a bilateral row is not projected (floor -inf), a row without diagonal does not step
  /// (gain 0; for PSD A the whole row is 0). Most problems have neither (`mixed` false): then nothing reads these.
  bool mixed = false;
  Array floor;  ///< 0 or -infinity
  Array gain;   ///< 1 or 0

  /// All but b and its units.  O(n) and the diagonal of A.
  void Reset(const LcpProblem& problem, std::vector<Index> order);
  /// b, b_norm and unit, of the problem that was given to Reset, or of one that shares its matrix.  O(n)
  void SetB(const LcpProblem& problem);

  Index Given(Index k) const { return order.empty() ? k : order[static_cast<size_t>(k)]; }
  bool IsFree(Index k) const { return mixed && floor[k] != 0; }

  /// The start of a solve: zero, or `given` clipped to the bounds.
  void Start(const Eigen::VectorXd* given, Array* f) const;
  /// @param given  of n entries already
  void ToGiven(const Array& f, Eigen::VectorXd* given) const;
};

}  // namespace lcpbench
