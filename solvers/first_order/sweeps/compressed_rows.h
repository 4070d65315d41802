#pragma once

#include <vector>

#include "solvers/lcp/problem.h"

/// Internal to solvers/first_order/sweeps/.
namespace lcpbench {

/// A sparse matrix by rows, made one entry after the other.
class CompressedRows {
 public:
  void Clear(Index entries) {
    start_.assign(1, 0);
    column_.clear();
    value_.clear();
    column_.reserve(static_cast<size_t>(entries));
    value_.reserve(static_cast<size_t>(entries));
  }
  void Push(Index column, double value) {
    column_.push_back(static_cast<int>(column));
    value_.push_back(value);
  }
  void EndRow() { start_.push_back(static_cast<Index>(value_.size())); }
  Index Rows() const { return static_cast<Index>(start_.size()) - 1; }
  Index Entries() const { return start_.back(); }

  /// Four sums: one alone would wait for its own addition at every entry.
  double Dot(Index row, const double* x) const {
    const double* value = value_.data();
    const int* column = column_.data();
    Index k = start_[static_cast<size_t>(row)];
    const Index end = start_[static_cast<size_t>(row) + 1];
    double s0 = 0;
    double s1 = 0;
    double s2 = 0;
    double s3 = 0;
    for (; k + 4 <= end; k += 4) {
      s0 += value[k] * x[column[k]];
      s1 += value[k + 1] * x[column[k + 1]];
      s2 += value[k + 2] * x[column[k + 2]];
      s3 += value[k + 3] * x[column[k + 3]];
    }
    for (; k < end; ++k) s0 += value[k] * x[column[k]];
    return (s0 + s1) + (s2 + s3);
  }
  void Add(Index row, double factor, double* x) const {
    const Index end = start_[static_cast<size_t>(row) + 1];
    for (Index k = start_[static_cast<size_t>(row)]; k < end; ++k) {
      x[column_[static_cast<size_t>(k)]] += value_[static_cast<size_t>(k)] * factor;
    }
  }

 private:
  std::vector<Index> start_;
  std::vector<int> column_;
  std::vector<double> value_;
};

}  // namespace lcpbench
