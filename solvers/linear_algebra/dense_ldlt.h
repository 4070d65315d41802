#pragma once

#include <Eigen/Core>
#include <vector>

#include "solvers/lcp/solver.h"

namespace lcpbench {

/// L D L^T of a symmetric positive definite matrix whose rows come and go.
///
/// L is unit lower triangular, D diagonal. A row enters at the end (one forward substitution, which a pivoting method
/// has done already to find its direction) and leaves anywhere. Taking out row k leaves
///     L33 D3 L33^T + d_k l l^T
/// for the rows after k, a rank-one *update with a positive weight*: all pivots grow, nothing cancels, so that leaving
/// is as stable as entering.  [Gill, Golub, Murray, Saunders 1974, method C1] Many rows at once are factored from
/// scratch, right-looking by panels of eight columns: m^3 / 6 multiply-adds, each some ten times faster than in the
/// m^2 / 2 of a substitution. By no library routine, because those allocate.
///
/// Append judges no pivot: the caller decides by its own rank rule whether a row may enter, and passes pivots > 0
/// only. Cost with m rows: solve m^2 per pair of substitutions, Append m, Remove k < m: k (m - k) moves and (m - k)^2
/// multiply-adds. Columns of L are contiguous; leading zeros of a right-hand side are skipped, which makes decoupled
/// groups of rows cheap. Only Reserve allocates.
class DenseLdlt {
 public:
  using Index = Eigen::Index;  ///< signed, as Eigen's

  /// Allocates for up to `max_rows` rows; forgets all rows.
  void Reserve(Index max_rows);
  /// Forgets all rows and lays out storage for up to `rows` rows, at most as many as reserved.
  void Reset(Index rows);

  /// Rows that are in the factor.
  Index size() const { return size_; }
  /// D_kk.
  double pivot(Index k) const { return pivots_[k]; }
  /// 1 / D_kk.
  double inverse_pivot(Index k) const { return inverse_[k]; }
  /// L_ik, i > k.
  double lower(Index i, Index k) const { return columns_[k * stride_ + i]; }

  /// Columns are computed by so many entries together.
  static constexpr Index kLanes = 8;
  /// Where Factor finds its matrix: entries i >= k of column k, and zeros behind the last one up to a whole number of
  /// lanes. Overwritten by any other call that adds rows.
  double* column(Index k) { return columns_.data() + k * stride_; }
  /// Forgets all rows and factors the matrix in the lower triangle of the columns [0, rows). A row whose pivot is not
  /// above `threshold` times its diagonal entry is left out; the rows after it move up.
  /// @param kept      receives the numbers of the other rows, ascending; reserved by the caller. nullptr: no row is
  ///                  left out, but its pivot raised to that least one
  /// @param deadline  nullptr for none; looked at every some 10 us
  /// @returns false if the deadline passed meanwhile: no rows are left then
  bool Factor(Index rows, double threshold, std::vector<Index>* kept, const Deadline* deadline);

  /// x := L^-1 x.
  void ForwardSolve(double* x) const;
  /// x := L^-T x.
  void BackSolve(double* x) const;
  /// x := (L D L^T)^-1 x.
  void Solve(double* x) const;

  /// The pivot that a row with z = L^-1 a and diagonal entry `diagonal` would have: diagonal - z^T D^-1 z.
  double PivotOf(const double* z, double diagonal) const;
  /// Adds a row at the end, given z = L^-1 a and its pivot > 0.
  void Append(const double* z, double pivot);
  /// Takes out row k; the rows after it move up by one.
  void Remove(Index k);

 private:
  void FactorPanel(Index begin, Index width, Index rows, double threshold, bool all_enter);
  void UpdateBehindPanel(Index begin, Index column, Index rows);
  void Keep(const std::vector<Index>& kept);

  Index size_ = 0;
  Index stride_ = 0;
  Eigen::VectorXd columns_;  // L below its diagonal, column k from k * stride_
  Eigen::VectorXd pivots_;
  Eigen::VectorXd inverse_;  // 1 / pivots_
  Eigen::VectorXd update_;
};

}  // namespace lcpbench
