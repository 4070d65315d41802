#pragma once

#include <LinearComplementarityProblem.h>
#include <NumericsMatrix.h>
#include <SparseBlockMatrix.h>

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// The matrix of a problem in Siconos's form, w = M z + q, 0 <= z, w, z'w = 0, and a place for q.
///
/// Bilateral rows: Siconos's LCP solvers know none. f_i = z_i - z_i' with both >= 0, and the row -w_i beside w_i: both
/// are >= 0 only where w_i = 0. Nothing is computed for that but signs, so that the split is exact; M becomes singular.
///
/// Either dense (column by column), or in sparse blocks: one for the rows between the same two bodies, as Siconos's own
/// simulation makes one for each of its interactions, up to `largest_block` rows; with their mirrored rows beside them.
/// Without factors every row is a block. O(n^2), or O(nnz of A), memory.
class SiconosProblem {
 public:
  static constexpr std::size_t kLargestBlock = 16;  ///< unless told otherwise
  enum class Storage { kDense, kBlocks };

  SiconosProblem(const LcpProblem& problem, Storage storage, std::size_t largest_block = kLargestBlock);
  ~SiconosProblem();
  SiconosProblem(const SiconosProblem&) = delete;
  SiconosProblem& operator=(const SiconosProblem&) = delete;

  LinearComplementarityProblem* get() { return &problem_; }
  /// q from b of a problem with the same matrix.
  void SetB(const Eigen::VectorXd& b);
  /// Rows, the mirrored ones included.
  Index size() const { return static_cast<Index>(variables_.size()); }
  /// Stored entries of M.
  std::size_t entries() const { return values_.size(); }

  Eigen::VectorXd VariablesOf(const Eigen::VectorXd& f) const;
  void SetForces(const Eigen::VectorXd& z, Eigen::VectorXd* f) const;

 private:
  struct Variable {
    Index row = 0;
    double sign = 1;
  };

  void OrderByRows(const LcpProblem& problem);
  void OrderByBlocks(const LcpProblem& problem, std::size_t largest_block);
  void FillDense(const LcpProblem& problem);
  void FillBlocks(const LcpProblem& problem);

  std::vector<Variable> variables_;
  std::vector<double> q_;
  std::vector<double> values_;
  // Blocks: where each ends, and the compressed rows of blocks.
  std::vector<unsigned int> ends_;
  std::vector<std::size_t> row_starts_;
  std::vector<std::size_t> columns_;
  std::vector<double*> blocks_;
  SparseBlockStructuredMatrix sparse_{};
  std::unique_ptr<NumericsMatrix, void (*)(NumericsMatrix*)> matrix_;
  LinearComplementarityProblem problem_{};
};

}  // namespace lcpbench
