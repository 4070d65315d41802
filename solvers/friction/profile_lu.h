#pragma once

#include <Eigen/Core>
#include <vector>

#include "solvers/lcp/problem.h"

/// Internal to solvers/.
namespace lcpbench {

/// P L U of a dense matrix by elimination within the profile that its entries have in the order of its rows and
/// columns. Pivots are on the diagonal, but where that is small beside its column.  O(m^3) at most; allocates where it
/// has met no matrix as large
class ProfileLu {
 public:
  /// For matrices of up to so many rows.
  void Reserve(Index max_rows);
  /// The matrix of m rows without entries.
  void Start(Index m);
  /// Adds to an entry.
  void Add(Index row, Index column, double value) {
    entry_[column * stride_ + row] += value;
    Reach(column, row);
    if (last_column_[static_cast<size_t>(row)] < column) last_column_[static_cast<size_t>(row)] = column;
  }
  /// The m entries of a column, for sums without Add: Reach and ReachOfRow say how far they go.
  double* column(Index column) { return entry_.data() + column * stride_; }
  /// Column `column` has entries down to `row`.
  void Reach(Index column, Index row) {
    if (last_row_[static_cast<size_t>(column)] < row) last_row_[static_cast<size_t>(column)] = row;
  }
  /// Row `row` has entries up to `column`.
  void ReachOfRow(Index row, Index column) {
    if (last_column_[static_cast<size_t>(row)] < column) last_column_[static_cast<size_t>(row)] = column;
  }
  /// False where a pivot is 0 or not a number.
  bool Factorize();
  /// The matrix's inverse times y, m numbers, in place.  O(m^2) at most
  void Solve(double* y);

 private:
  void FindReach();

  Index m_ = 0, stride_ = 0;  // stride_: m in whole registers
  // By columns: the matrix, then U, the inverse on its diagonal, and zeros below; and L without its diagonal, zeros
  // above within its first register, whose columns are not exchanged with later pivots.
  Eigen::VectorXd entry_, lower_;
  Eigen::VectorXd y_;  // of Solve
  // The last row and column that column k and row k reach, at first of the matrix; the row that was exchanged with k.
  std::vector<Index> last_row_, last_column_, pivot_;
};

}  // namespace lcpbench
