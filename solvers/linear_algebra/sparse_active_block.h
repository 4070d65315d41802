#pragma once

#include <vector>

#include "solvers/linear_algebra/active_block.h"
#include "solvers/linear_algebra/kept_order.h"

namespace lcpbench {

/// ActiveBlock on the sparse A: L D L^T in an approximate minimum degree order, with one symbolic analysis for all F.
///
/// Rows are computed one after the other (up-looking [Davis 2006, sec. 4.7]) on the pattern of the factor of the whole
/// A: a row outside F is a row of zeros. Row r depends on its descendants in the elimination tree only, so a Factor
/// after a small change of F computes the changed rows and their ancestors anew and keeps the others. Columns of equal
/// structure are handled up to four together, which shares the indices and the accumulator.
///
/// In a sequence the analysis is kept for a next problem of the same pattern, the order for one that differs little
/// (KeptOrder).
class SparseActiveBlock final : public ActiveBlock {
 public:
  void Analyze(const LcpProblem& problem) override;
  void Load(const LcpProblem& problem, const Eigen::VectorXd& scale) override;
  bool Factor(const std::vector<char>& active, double shift, const Deadline* deadline) override;
  void Solve(double* x) override;
  void Multiply(const double* x, double* y) const override;
  double factor_time() const override;
  Index CountDependentRows() const override;

 private:
  bool HasPattern(const SparseMatrix& A) const;
  void OrderAnew(const SparseMatrix& A);
  void Permute(const SparseMatrix& A);
  void FindPatterns();
  void ComputeRow(int r);

  // Of the A analysed last: its pattern, by rows, and its order.
  std::vector<int> outer_, inner_;
  KeptOrder kept_;

  // A in elimination order: the diagonal, and the entries left of it by rows.
  int n_ = 0;
  std::vector<int> order_;                    // place in the elimination order -> row of the problem
  std::vector<int> start_, column_, source_;  // of row r: [start_[r], start_[r+1]); source_: entry of SparseA()
  std::vector<int> diagonal_source_;
  std::vector<double> values_, diagonal_;

  // L: by columns with ascending rows, and for each row the places of its entries.
  std::vector<int> parent_;
  std::vector<int> column_start_, rows_;
  std::vector<int> row_start_, row_columns_, row_places_;
  std::vector<int> chain_;  // how many columns from this one on have its structure, 1 to 4
  std::vector<double> lower_, pivots_;
  double factor_work_ = 0;  // multiply-adds

  // State.
  double shift_ = 0;  // 0: nothing factored yet
  std::vector<char> active_, dirty_;
  std::vector<double> y_;
  mutable std::vector<double> in_, out_;
};

}  // namespace lcpbench
