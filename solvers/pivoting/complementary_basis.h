#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "solvers/linear_algebra/dense_ldlt.h"
#include "solvers/linear_algebra/scaled_lcp.h"

namespace lcpbench {

/// The basis of a principal pivoting method, that is its active rows F, and the factor of A_FF: positions [0, m) of the
/// permuted problem are F, and the L D L^T of A_FF is updated when a row enters and when one leaves, O(m^2) each; it is
/// never made from scratch. Only Reserve allocates.
class ComplementaryBasis {
 public:
  using Index = Eigen::Index;

  void Reserve(Index max_rows);
  /// F becomes empty; for the problem that `lcp` holds now.
  void Reset();

  /// The problem in its current order. Callers move rows outside F only.
  PermutedLcp lcp;

  Index size() const { return m_; }
  /// The pivot of the row of F at position p in the order of the factor, when it entered.
  double pivot(Index p) const { return ldlt_.pivot(slot_[static_cast<size_t>(p)]); }

  /// F := the positions [0, rows) but those whose pivot, in their order, is at most `threshold` A_pp. The rows left out
  /// move behind F, in no particular order; rows before the first of them stay. O(m^3)
  /// @param deadline  nullptr for none
  /// @returns false if the deadline passed meanwhile; F is empty then
  bool Factor(Index rows, double threshold, const Deadline* deadline);
  /// Where the first of the rows left out was; `rows` if there was none.
  Index first_left_out(Index rows) const {
    const auto is_other = [first = Index{0}](Index row) mutable { return row != first++; };
    return std::min(rows, std::find_if(kept_.begin(), kept_.end(), is_other) - kept_.begin());
  }

  /// The driven row d outside F: L^-1 A_Fd is kept, and follows rows that enter. Returns s = A_dd - A_dF A_FF^-1 A_Fd,
  /// the pivot that d would have in F.  O(m^2)
  double SetDriven(Index d);
  /// df_F = -A_FF^-1 A_Fd for the driven row. Returns y.D y for y = (df_F, 1), D = diag A.  O(m^2)
  double Direction(Index d);
  /// By position, F only.
  const double* df() const { return df_.data(); }

  /// The driven row d, of pivot s, joins F: it moves to position m, and the row there to its place.  O(m + n)
  void EnterDriven(Index d, double s);
  /// The pivot that row p (not the driven one) would have; to be followed by Enter, or by nothing.  O(m^2)
  double PivotOf(Index p);
  /// Row p joins F after PivotOf(p) returned `pivot`. Returns the new s of the driven row d.  O(m + n)
  double Enter(Index p, double pivot, Index d);
  /// Row p of F leaves: it moves to position m - 1, now the first outside. The driven row must be set again.  O(m^2 +
  /// n)
  void Leave(Index p);

  /// f_F = -A_FF^-1 b_F. Returns the largest A_ii f_i^2.  O(m^2)
  double SolveForces();
  /// f_F -= A_FF^-1 w_F with w by position in lcp.w, which becomes 0.  O(m^2)
  void CorrectForces();
  /// x := A_FF^-1 x, x by position.  O(m^2)
  void SolveSystem(double* x);

 private:
  void Append(Index p, const double* z, double pivot);
  void Gather(Index p, double* z) const;

  DenseLdlt ldlt_;  // in the order of entering
  Index m_ = 0;
  std::vector<Index> order_;         // row of the factor -> position
  std::vector<Index> slot_;          // position in F -> row of the factor
  std::vector<Index> kept_;          // positions, of the latest Factor
  Eigen::VectorXd df_;               // by position
  Eigen::VectorXd z_, z_other_, x_;  // by row of the factor
};

}  // namespace lcpbench
