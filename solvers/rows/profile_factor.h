#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "solvers/first_order/sweeps/scaled_rows.h"

namespace lcpbench {

/// L D L^T of A~_FF + diag(shift), F the active rows of an island of ScaledRows. A~ is stored by rows from its first
/// nonzero to the diagonal (its profile), and the factor stays within it [Jennings 1966]; rows outside F are passed
/// over. Pivots that are rounding (below 1e-12 of A~_ii = 1) leave their row out: its x is 0.
///
/// Cost: a factorization takes the sum of squared column heights of the profile. Only Reserve allocates.
class ProfileFactor {
 public:
  /// Numbers of the profile per row that room is made for, on average.
  static constexpr Index kMostProfile = 256;
  /// A shift that holds a singular A_FF up and leaves little in w, in units of A_ii = 1.
  static constexpr double kShift = 1e-9;

  /// For islands of up to `max_rows` rows.
  void Reserve(Index max_rows);

  /// Where A~ has its numbers. False if that is more than there is room for.  O(n)
  bool FindProfile(const ScaledRows& rows);
  /// Of a factorization with all rows active, in processor cycles, roughly.
  double cost() const { return cost_; }

  /// A~ = G G^T, by the rows that bodies share. FindProfile comes before.
  void Assemble(const ScaledRows& rows);
  /// @param is_active  n, 1 for the rows of F
  /// @param shift      n, added to the diagonal, >= 0
  void Factorize(const unsigned char* is_active, const double* shift);
  /// x := (A~_FF + diag(shift))^-1 x. Entries of x outside F must be 0, and stay 0.
  /// @param x  n numbers, padded to whole vector registers
  void Solve(double* x) const;

 private:
  template <Index p>
  void AssembleOf(const ScaledRows& rows);
  bool is_in_factor(Index i) const { return active_first_[static_cast<std::size_t>(i)] < n_; }

  Index n_ = 0;
  double cost_ = 0;
  // By row: its first column, in whole registers where it begins in A_ and L_ (from column 0 on), the lowest row that
  // reaches its column.
  std::vector<std::int32_t> first_, last_below_;
  std::vector<std::int64_t> begin_;
  std::vector<std::int32_t> active_first_;  // first_ of active rows, n of others
  std::vector<std::int32_t> first_row_;     // by body
  Eigen::VectorXd A_, L_, column_, mask_;
  // Of Assemble, by body: 2 row + side of the rows so far.
  std::vector<std::int32_t> sides_, sides_begin_, sides_end_;
};

}  // namespace lcpbench
