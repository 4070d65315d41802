#pragma once

#include <Eigen/Core>
#include <vector>

#include "solvers/interior_point/ipm_run.h"

namespace lcpbench {

/// Tries the active set of a warm start: F = {f > w}, w_F = 0 by refinement on one factorisation with the other rows
/// taken out, and a few block pivots as long as they pay. In double, with about half the work of an interior-point
/// step for one set, so that a guess that fails costs a few per cent of a cold solve. [Judice, Pires 1994]
///
/// A first set with many wrong rows ends it at once, and so does a pivot that neither halves the number of wrong rows
/// nor leaves few. Where A_FF is singular the proximal term about f picks the forces, as in proximal_pivoting.h.
class InteriorGuess {
 public:
  void Reserve(Index n);

  /// @param f, w  scaled, w the gaps of f
  /// @returns whether run->best_f() meets the tier now; where not, it is the best of all iterates, clipped, unless a
  ///     limit is hit
  bool Try(IpmRun* run, const Eigen::VectorXd& f, const Eigen::VectorXd& w);
  /// Offers f, clipped and scaled, to the run. *w becomes its scaled gaps.
  bool Judge(IpmRun* run, const Eigen::VectorXd& f, Eigen::VectorXd* w);

 private:
  bool Refine(IpmRun* run);
  double Rho(const ScaledSystem& system);
  Index Flip(const ScaledSystem& system);

  std::vector<char> active_;
  Eigen::VectorXd x_, gap_, right_, correction_, theta_, forces_, gaps_;
};

}  // namespace lcpbench
