#pragma once

#include <vector>

#include "solvers/lcp/problem.h"

/// Internal to solvers/.
namespace lcpbench {

/// P L U of a dense matrix by elimination with partial pivoting, within the profile that its entries have in the order
/// of its rows and columns.  O(m^3) at most; allocates where it has met no matrix as large
class ProfileLu {
 public:
  /// For matrices of up to so many rows.
  void Reserve(Index max_rows);
  /// The matrix of m rows without entries.
  void Start(Index m);
  /// Adds to an entry.
  void Add(Index row, Index column, double value) {
    entry_[static_cast<size_t>(column * m_ + row)] += value;
    if (last_row_[static_cast<size_t>(column)] < row) last_row_[static_cast<size_t>(column)] = row;
    if (last_column_[static_cast<size_t>(row)] < column) last_column_[static_cast<size_t>(row)] = column;
  }
  /// False where a pivot is 0 or not a number.
  bool Factorize();
  /// The matrix's inverse times y, in place.  O(m^2) at most
  void Solve(double* y) const;

 private:
  void FindReach();

  Index m_ = 0;
  // By columns; then L, whose columns are not exchanged with later pivots, and U, the inverse on its diagonal.
  std::vector<double> entry_;
  // The last row and column that column k and row k reach, at first of the matrix; the row that was exchanged with k.
  std::vector<Index> last_row_, last_column_, pivot_;
};

}  // namespace lcpbench
