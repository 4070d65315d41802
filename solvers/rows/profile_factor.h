#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "solvers/first_order/sweeps/scaled_rows.h"

namespace lcpbench {

/// L D L^T of A_FF + diag(shift), F the active rows of a symmetric A, which is stored by rows from its first nonzero to
/// the diagonal (its profile); the factor stays within it [Jennings 1966]; rows outside F are passed over. A pivot that
/// is rounding (below tableau::kLeastPivot of A_ii) leaves its row out: its x is 0. A is that of ScaledRows, or any
/// that a caller lays out and fills.
///
/// Cost: a factorization takes the sum of squared column heights of the profile. Only Reserve allocates.
class ProfileFactor {
 public:
  /// Numbers of the profile per row that room is made for, on average, unless asked for more.
  static constexpr Index kMostProfile = 256;
  /// A shift that holds a singular A_FF up and leaves little in w, in units of A_ii.
  static constexpr double kShift = 1e-9;

  /// For matrices of up to `max_rows` rows, with profiles of up to `profile` numbers, rows filled up to whole
  /// registers.
  void Reserve(Index max_rows, Index profile);
  void Reserve(Index max_rows) { Reserve(max_rows, kMostProfile * max_rows); }

  /// A has n rows, of which row i begins at column first(i) <= i. False if that is more than there is room for.  O(n)
  template <typename First>
  bool LayOut(Index n, const First& first) {
    n_ = n;
    for (Index i = 0; i < n; ++i) first_[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(first(i));
    return LayOutRows();
  }
  /// A = 0.
  void Clear();
  /// Row i by column, to be filled: from its first one to its diagonal.
  double* row(Index i) { return A_.data() + begin_[static_cast<std::size_t>(i)]; }

  /// A~ = G G^T, by the rows that bodies share. False as LayOut.
  bool FindProfile(const ScaledRows& rows);
  void Assemble(const ScaledRows& rows);
  /// Of a factorization with all rows active, in processor cycles, roughly.
  double cost() const { return cost_; }

  /// @param is_active  n, 1 for the rows of F
  /// @param shift      added to the diagonal, >= 0; with `more`, n numbers, unless it is nullptr
  /// @returns whether no row was left out
  bool Factorize(const unsigned char* is_active, double shift, const double* more);
  /// x := (A_FF + diag(shift))^-1 x. Entries of x outside F must be 0, and stay 0.
  /// @param x  n numbers, padded to whole vector registers
  void Solve(double* x) const;

 private:
  bool LayOutRows();
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
  // Of Assemble: by body the last side, 2 row + (0 or 1), so far that has it; by side the one before on its body.
  std::vector<std::int32_t> last_side_, side_before_;
};

}  // namespace lcpbench
