#pragma once

#include <vector>

#include "solvers/linear_algebra/active_block.h"

namespace lcpbench {

/// ActiveBlock on the dense A: L D L^T from scratch, left-looking by panels of eight columns. L D is stored by blocks
/// of 16 rows, columns of a block one after the other, so that the product of a block with the rows of a panel reads
/// memory in order and keeps its 16 x 8 sums in registers. F is filled up with rows of the unit matrix to whole blocks.
/// No library routine, because those allocate in a factorisation.
class DenseActiveBlock final : public ActiveBlock {
 public:
  void Analyze(const LcpProblem& problem) override;
  void Load(const LcpProblem& problem, const Eigen::VectorXd& scale) override;
  bool Factor(const std::vector<char>& active, double shift, const Deadline* deadline) override;
  void Solve(double* x) override;
  void Multiply(const double* x, double* y) const override;
  Index CountDependentRows() const override;
  double factor_time() const override { return FactorTime(n_); }
  /// The same without an analysis, which allocates three n x n arrays.
  static double FactorTime(Index n);

 private:
  static constexpr Index kRows = 16;
  static constexpr Index kPanel = 8;

  using Strip = Eigen::Map<Eigen::Array<double, kRows, 1>>;

  // Column k of the block of rows [kRows block, kRows (block + 1)).
  double* strip(Index block, Index k) { return factor_.data() + (block * padded_ + k) * kRows; }
  void Gather(double shift);
  void UpdatePanel(Index begin);
  void FactorPanel(Index begin);

  Index n_ = 0;
  Index padded_ = 0;         // |F| in whole blocks
  Eigen::MatrixXd A_;        // S A S
  std::vector<Index> rows_;  // F
  Eigen::VectorXd factor_;   // K_FF, then L D, diagonal and below
  Eigen::VectorXd inverse_;  // 1 / D_kk
  Eigen::VectorXd floor_;    // least pivot of each row
  Eigen::VectorXd panel_;    // rows of the panel of L, packed
  Eigen::VectorXd x_, sums_;
};

}  // namespace lcpbench
